// A planar leg's joints alone. In flight the centre of mass falls freely, and with the toe pinned the angles determine the hip: what
// remains of LegEquations (dynamics/planar_leg.hpp) are two links, whose inertia depends on the knee's cosine only.
//
// With the angles of thigh and shank from straight down, a and f = hip + knee, and the joints' torques less their friction:
//   S f'' + B cos(knee) a'' + B sin(knee) a'^2 - g s sin f = t_knee
//   A a'' + B cos(knee) f'' - B sin(knee) f'^2 - g r sin a = t_hip - t_knee
// In flight the inertias are those about the centre of mass, and gravity has no torque.
#pragma once

#include <type_traits>

#include "furcula/dynamics/planar_leg.hpp"

namespace furcula::dynamics {

/// P is the scalar of the parameters; that of the state is chosen by each call.
template <class P>
class LegJoints {
 public:
  /// Computes the constants of the equations from the parameters.
  explicit LegJoints(const PlanarLegParameters<P>& p)
      : hip_damping_(p.hip_damping_nmspr), knee_damping_(p.knee_damping_nmspr) {
    const P &m = p.mass_kg, &m1 = p.thigh_mass_kg, &m2 = p.shank_mass_kg;
    const P &l1 = p.thigh_length_m, &l2 = p.shank_length_m;
    const P torso = m - m1 - m2, above = m - m2;
    const P thigh = l1 - p.thigh_com_m, shank = l2 - p.shank_com_m;  // from the link's lower end
    shank_first_ = m2 * shank + above * l2;
    thigh_first_ = m1 * thigh + torso * l1;
    stance_ = {p.shank_inertia_kgm2 + m2 * shank * shank + above * l2 * l2,
               p.thigh_inertia_kgm2 + m1 * thigh * thigh + torso * l1 * l1, l2 * thigh_first_,
               p.gravity_mps2 * shank_first_, p.gravity_mps2 * thigh_first_};
    const P a = m1 * p.thigh_com_m + m2 * l1, b = m2 * p.shank_com_m;
    flight_ = {p.shank_inertia_kgm2 + m2 * p.shank_com_m * p.shank_com_m - b * b / m,
               p.thigh_inertia_kgm2 + m1 * p.thigh_com_m * p.thigh_com_m + m2 * l1 * l1 - a * a / m,
               m2 * l1 * p.shank_com_m - a * b / m, P(0), P(0)};
    weight_n_ = m * p.gravity_mps2;
    thigh_centre_ = a / m;
    shank_centre_ = b / m;
    thigh_toe_ = thigh_first_ / m;
    shank_toe_ = shank_first_ / m;
  }

  /// Sines and cosines of the angles of thigh and shank from straight down and of the knee.
  template <class T>
  struct Pose {
    T sin_thigh,    ///< of the hip's angle
        cos_thigh,  ///< of the hip's angle
        sin_knee,   ///< of the knee's angle
        cos_knee,   ///< of the knee's angle
        sin_shank,  ///< of hip + knee
        cos_shank;  ///< of hip + knee
  };
  /// Sines and cosines of the joints' angles, rad.
  template <class T>
  FURCULA_INLINE Pose<T> pose(const Joints2<T>& angle) const {
    Pose<T> o;
    if constexpr (std::is_same_v<T, double>) {
      // Both in one SIMD batch: the same bits, half the time.
      using Pair = SimdBatch<double, 2>;
      Pair both(angle.hip);
      both.set(1, angle.knee);
      const SineCosine<Pair> of = sine_cosine(both);
      o.sin_thigh = of.sine[0];
      o.cos_thigh = of.cosine[0];
      o.sin_knee = of.sine[1];
      o.cos_knee = of.cosine[1];
    } else {
      const SineCosine<T> hip = sine_cosine(angle.hip), knee = sine_cosine(angle.knee);
      o.sin_thigh = hip.sine;
      o.cos_thigh = hip.cosine;
      o.sin_knee = knee.sine;
      o.cos_knee = knee.cosine;
    }
    o.sin_shank = o.sin_thigh * o.cos_knee + o.cos_thigh * o.sin_knee;
    o.cos_shank = o.cos_thigh * o.cos_knee - o.sin_thigh * o.sin_knee;
    return o;
  }

  /// Accelerations of the joints, rad/s^2, under these torques of motor and spring, N m: with the toe pinned (kStands) or in
  /// flight.
  template <bool kStands, class T>
  FURCULA_INLINE Joints2<T> acceleration(const Pose<T>& o, const Joints2<T>& rate,
                                         const Joints2<T>& torque) const {
    const Links& l = kStands ? stance_ : flight_;
    const T shank_rate = rate.hip + rate.knee;
    const T cosine = l.both * o.cos_knee, sine = l.both * o.sin_knee;
    const T knee = torque.knee - knee_damping_ * rate.knee;
    T on_shank = knee - sine * (rate.hip * rate.hip);
    T on_thigh = torque.hip - hip_damping_ * rate.hip - knee + sine * (shank_rate * shank_rate);
    if constexpr (kStands) {
      on_shank = on_shank + l.shank_weight * o.sin_shank;
      on_thigh = on_thigh + l.thigh_weight * o.sin_thigh;
    }
    const T inverse = ValueOf<T>(1) / (l.shank * l.thigh - cosine * cosine);
    const T thigh = inverse * (l.shank * on_thigh - cosine * on_shank);
    return {thigh, T(inverse * (l.thigh * on_shank - cosine * on_thigh) - thigh)};
  }
  /// Inverse dynamics: the torques of motor and spring that an acceleration needs, N m.
  template <bool kStands, class T>
  FURCULA_INLINE Joints2<T> torque(const Pose<T>& o, const Joints2<T>& rate,
                                   const Joints2<T>& acceleration) const {
    const Links& l = kStands ? stance_ : flight_;
    const T shank_rate = rate.hip + rate.knee, shank = acceleration.hip + acceleration.knee;
    const T cosine = l.both * o.cos_knee, sine = l.both * o.sin_knee;
    T knee = l.shank * shank + cosine * acceleration.hip + sine * (rate.hip * rate.hip);
    T thigh = l.thigh * acceleration.hip + cosine * shank - sine * (shank_rate * shank_rate);
    if constexpr (kStands) {
      knee = knee - l.shank_weight * o.sin_shank;
      thigh = thigh - l.thigh_weight * o.sin_thigh;
    }
    return {T(thigh + knee + hip_damping_ * rate.hip), T(knee + knee_damping_ * rate.knee)};
  }

  /// Force of the ground on the pinned toe, N; x forward, y up.
  template <class T>
  Vec2<T> ground_force(const Pose<T>& o, const Joints2<T>& rate, const Joints2<T>& acceleration) const {
    const T shank_rate = rate.hip + rate.knee, shank = acceleration.hip + acceleration.knee;
    const T f2 = shank_rate * shank_rate, a2 = rate.hip * rate.hip;
    return {shank_first_ * (o.sin_shank * f2 - o.cos_shank * shank) +
                thigh_first_ * (o.sin_thigh * a2 - o.cos_thigh * acceleration.hip),
            weight_n_ - shank_first_ * (o.cos_shank * f2 + o.sin_shank * shank) -
                thigh_first_ * (o.cos_thigh * a2 + o.sin_thigh * acceleration.hip)};
  }

  /// Position of the toe relative to the centre of all mass, m.
  template <class T>
  Vec2<T> toe(const Pose<T>& o) const {
    return {thigh_toe_ * o.sin_thigh + shank_toe_ * o.sin_shank,
            -(thigh_toe_ * o.cos_thigh + shank_toe_ * o.cos_shank)};
  }
  /// Velocity of the toe relative to the centre of all mass, m/s.
  template <class T>
  Vec2<T> toe_velocity(const Pose<T>& o, const Joints2<T>& rate) const {
    const T shank_rate = rate.hip + rate.knee;
    return {thigh_toe_ * o.cos_thigh * rate.hip + shank_toe_ * o.cos_shank * shank_rate,
            thigh_toe_ * o.sin_thigh * rate.hip + shank_toe_ * o.sin_shank * shank_rate};
  }
  /// Position of the hip relative to the centre of all mass, m.
  template <class T>
  Vec2<T> hip(const Pose<T>& o) const {
    return {-(thigh_centre_ * o.sin_thigh + shank_centre_ * o.sin_shank),
            thigh_centre_ * o.cos_thigh + shank_centre_ * o.cos_shank};
  }
  /// Velocity of the hip relative to the centre of all mass, m/s.
  template <class T>
  Vec2<T> hip_velocity(const Pose<T>& o, const Joints2<T>& rate) const {
    const T shank_rate = rate.hip + rate.knee;
    return {-(thigh_centre_ * o.cos_thigh * rate.hip + shank_centre_ * o.cos_shank * shank_rate),
            -(thigh_centre_ * o.sin_thigh * rate.hip + shank_centre_ * o.sin_shank * shank_rate)};
  }

 private:
  struct Links {
    P shank{}, thigh{}, both{};        ///< S, A, B; kg m^2
    P shank_weight{}, thigh_weight{};  ///< g s, g r; N m
  };
  P hip_damping_, knee_damping_;
  Links stance_, flight_;
  P shank_first_, thigh_first_, weight_n_;
  P thigh_centre_, shank_centre_, thigh_toe_, shank_toe_;  ///< m
};

}  // namespace furcula::dynamics
