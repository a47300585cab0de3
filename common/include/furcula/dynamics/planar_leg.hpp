// A planar leg: torso on a boom that keeps it upright, thigh, shank, point toe; motors and friction at hip and
// knee (001 section III). Its equations of motion in flight and on the pinned toe, forwards and backwards, and
// the touch-down's impact.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "furcula/dynamics/scalar.hpp"
#include "furcula/dynamics/sine_cosine.hpp"

namespace furcula::dynamics {

/// What works on the knee beside the motor.
enum class LegSpring : std::uint8_t {
  switched,  ///< in stance only, its rest angle that of the knee at touch-down (001 eq. 1)
  parallel,  ///< always, its rest angle fixed (001 eq. 14)
  none,      ///< no spring
};
/// Names in files, in the order of LegSpring.
inline constexpr std::array<std::string_view, 3> kLegSpringNames{"switched", "parallel", "none"};

/// What ends a stance. The ground never pulls, so that a force of zero ends it in any case.
enum class LegLiftOff : std::uint8_t {
  force,  ///< the ground's upward force falls to zero, the knee being flexed further than at touch-down
  knee,   ///< the knee, extending, comes back to its angle of touch-down (001 eq. 3, the second condition)
  unguarded,  ///< the force alone; the knee may extend beyond its angle of touch-down
};
/// Names in files, in the order of LegLiftOff.
inline constexpr std::array<std::string_view, 3> kLegLiftOffNames{"force", "knee", "unguarded"};

/// Inertias are about each link's centre of mass, with the rotor that turns with it.
template <class P>
struct PlanarLegParameters {
  P mass_kg{},               ///< of all; the torso has what thigh and shank do not
      thigh_mass_kg{},       ///< of the thigh
      shank_mass_kg{};       ///< of the shank
  P thigh_inertia_kgm2{},    ///< about its centre of mass
      shank_inertia_kgm2{};  ///< about its centre of mass
  P thigh_length_m{},        ///< hip to knee
      shank_length_m{};      ///< knee to toe
  P thigh_com_m{},           ///< centre of mass, from the hip
      shank_com_m{};         ///< centre of mass, from the knee
  P hip_damping_nmspr{},     ///< viscous friction of the hip
      knee_damping_nmspr{};  ///< viscous friction of the knee
  P stiffness_nmprad{};      ///< of the knee's spring
  P rest_angle_rad{};        ///< of the knee's spring, where it is `parallel`
  P gravity_mps2{};          ///< acceleration of gravity, positive downwards
};

/// In the plane: x forward, y up; m, m/s or N.
template <class T>
struct Vec2 {
  T x{},    ///< forward
      y{};  ///< up
};

/// Of hip and knee: rad, rad/s, rad/s^2 or N m. The thigh is measured from straight down, the knee from
/// straight; both grow counter-clockwise, so that a positive torque flexes the knee.
template <class T>
struct Joints2 {
  T hip{},     ///< of the hip
      knee{};  ///< of the knee
};

/// The equations
///   D q'' + C + G = (0, 0, u_hip - f1 hip', u_knee + s - f2 knee') + J^T F,   q = (x, y, hip, knee)
/// with (x, y) the hip's position (001 section III). T is the scalar of the state, P that of the parameters.
template <class T, class P = ValueOf<T>>
class LegEquations {
 public:
  /// Computes the constants of the equations from the parameters.
  explicit LegEquations(const PlanarLegParameters<P>& p)
      : p_(p),
        a_(p.thigh_mass_kg * p.thigh_com_m + p.shank_mass_kg * p.thigh_length_m),
        b_(p.shank_mass_kg * p.shank_com_m),
        c_(p.shank_mass_kg * p.thigh_length_m * p.shank_com_m),
        shank_(p.shank_inertia_kgm2 + p.shank_mass_kg * p.shank_com_m * p.shank_com_m),
        leg_(p.thigh_inertia_kgm2 + p.thigh_mass_kg * p.thigh_com_m * p.thigh_com_m + shank_ +
             p.shank_mass_kg * p.thigh_length_m * p.thigh_length_m),
        inverse_mass_(P(1) / p.mass_kg) {}

  /// The parameters.
  const PlanarLegParameters<P>& parameters() const { return p_; }

  /// What all of the equations need of the joints' angles.
  struct Pose {
    T sin_hip,           ///< of the hip's angle
        cos_hip,         ///< of the hip's angle
        sin_knee,        ///< of the knee's angle
        cos_knee,        ///< of the knee's angle
        sin_shank,       ///< of hip + knee
        cos_shank;       ///< of hip + knee
    Joints2<T> along_x,  ///< D, row x, columns hip and knee
        along_y;         ///< D, row y, columns hip and knee
    T d_hip,             ///< D, hip and hip
        d_both,          ///< D, hip and knee
        d_knee;          ///< D, knee and knee
    Joints2<T> toe_x,    ///< Jacobian of the toe, row x, m/rad
        toe_y;           ///< Jacobian of the toe, row y, m/rad
  };

  /// The pose of the joints' angles, rad.
  Pose pose(const Joints2<T>& angle) const {
    const SineCosine<T> hip = sine_cosine(angle.hip), knee = sine_cosine(angle.knee);
    Pose o;
    o.sin_hip = hip.sine;
    o.cos_hip = hip.cosine;
    o.sin_knee = knee.sine;
    o.cos_knee = knee.cosine;
    o.sin_shank = o.sin_hip * o.cos_knee + o.cos_hip * o.sin_knee;
    o.cos_shank = o.cos_hip * o.cos_knee - o.sin_hip * o.sin_knee;
    o.along_x.knee = b_ * o.cos_shank;
    o.along_y.knee = b_ * o.sin_shank;
    o.along_x.hip = a_ * o.cos_hip + o.along_x.knee;
    o.along_y.hip = a_ * o.sin_hip + o.along_y.knee;
    o.d_hip = (P(2) * c_) * o.cos_knee + leg_;
    o.d_both = c_ * o.cos_knee + shank_;
    o.d_knee = T(shank_);
    o.toe_x.knee = p_.shank_length_m * o.cos_shank;
    o.toe_y.knee = p_.shank_length_m * o.sin_shank;
    o.toe_x.hip = p_.thigh_length_m * o.cos_hip + o.toe_x.knee;
    o.toe_y.hip = p_.thigh_length_m * o.sin_hip + o.toe_y.knee;
    return o;
  }

  /// Position of the toe from the hip, m. The Jacobian's rows are the turned links: J = (-y, x) of what hangs on each joint.
  Vec2<T> toe(const Pose& o) const { return {o.toe_y.hip, -o.toe_x.hip}; }
  /// Position of the knee from the hip, m.
  Vec2<T> knee(const Pose& o) const {
    return {p_.thigh_length_m * o.sin_hip, -p_.thigh_length_m * o.cos_hip};
  }
  /// Position of the centre of all mass from the hip, m.
  Vec2<T> centre(const Pose& o) const {
    return {inverse_mass_ * o.along_y.hip, -inverse_mass_ * o.along_x.hip};
  }
  /// Velocity of the centre of all mass relative to the hip's, m/s.
  Vec2<T> centre_velocity(const Pose& o, const Joints2<T>& rate) const {
    return {inverse_mass_ * dot(o.along_x, rate), inverse_mass_ * dot(o.along_y, rate)};
  }
  /// Velocity of the toe relative to the hip's, m/s.
  Vec2<T> toe_velocity(const Pose& o, const Joints2<T>& rate) const {
    return {dot(o.toe_x, rate), dot(o.toe_y, rate)};
  }

  /// The spring's torque on the knee, N m, for the angle at which it begins.
  T spring_torque(const T& knee, const T& rest) const {
    const T stretch = knee - rest;
    return value_of(stretch) > ValueOf<T>(0) ? T(-p_.stiffness_nmprad * stretch) : T(ValueOf<T>(0));
  }

  /// Result of inverse dynamics.
  struct Needed {
    Joints2<T> torque;         ///< of motor and spring, N m
    Vec2<T> hip_acceleration;  ///< that results, m/s^2
    Vec2<T> ground_force;      ///< on the toe, N; zero in flight
  };
  /// Inverse dynamics with the toe pinned: what an acceleration of the joints, rad/s^2, needs.
  Needed needed_in_stance(const Pose& o, const Joints2<T>& rate, const Joints2<T>& acceleration) const {
    const Turning t = turning(o, rate);
    Needed n;
    n.hip_acceleration.x = -(dot(o.toe_x, acceleration) + t.toe.x);
    n.hip_acceleration.y = -(dot(o.toe_y, acceleration) + t.toe.y);
    n.ground_force.x = p_.mass_kg * n.hip_acceleration.x + dot(o.along_x, acceleration) + t.body.x;
    n.ground_force.y =
        p_.mass_kg * (n.hip_acceleration.y + p_.gravity_mps2) + dot(o.along_y, acceleration) + t.body.y;
    n.torque = joint_rows(o, t, rate, acceleration, n.hip_acceleration);
    n.torque.hip = n.torque.hip - (o.toe_x.hip * n.ground_force.x + o.toe_y.hip * n.ground_force.y);
    n.torque.knee = n.torque.knee - (o.toe_x.knee * n.ground_force.x + o.toe_y.knee * n.ground_force.y);
    return n;
  }
  /// Inverse dynamics in flight.
  Needed needed_in_flight(const Pose& o, const Joints2<T>& rate, const Joints2<T>& acceleration) const {
    const Turning t = turning(o, rate);
    Needed n;
    n.hip_acceleration.x = -inverse_mass_ * (dot(o.along_x, acceleration) + t.body.x);
    n.hip_acceleration.y = -inverse_mass_ * (dot(o.along_y, acceleration) + t.body.y) - p_.gravity_mps2;
    n.torque = joint_rows(o, t, rate, acceleration, n.hip_acceleration);
    return n;
  }

  /// Result of forward dynamics.
  struct Motion {
    Joints2<T> acceleration;   ///< of the joints, rad/s^2
    Vec2<T> hip_acceleration;  ///< m/s^2
    Vec2<T> ground_force;      ///< on the toe, N; zero in flight
  };
  /// Forward dynamics with the toe pinned, under these torques of motor and spring, N m.
  Motion in_stance(const Pose& o, const Joints2<T>& rate, const Joints2<T>& torque) const {
    return forwards(needed_in_stance(o, rate, {}), standing_inertia(o), torque, [&](const Joints2<T>& a) {
      const Needed n = needed_in_stance(o, rate, a);
      return Motion{a, n.hip_acceleration, n.ground_force};
    });
  }
  /// Forward dynamics in flight.
  Motion in_flight(const Pose& o, const Joints2<T>& rate, const Joints2<T>& torque) const {
    return forwards(needed_in_flight(o, rate, {}), flying_inertia(o), torque, [&](const Joints2<T>& a) {
      const Needed n = needed_in_flight(o, rate, a);
      return Motion{a, n.hip_acceleration, {}};
    });
  }

  /// Inertia matrix of the joints, symmetric, kg m^2.
  struct Inertia {
    T hip,     ///< hip and hip
        both,  ///< hip and knee
        knee;  ///< knee and knee
  };
  /// Inertia of the joints with the toe pinned.
  Inertia standing_inertia(const Pose& o) const {
    const P& m = p_.mass_kg;
    const auto part = [&](const T& d, const T& xi, const T& yi, const T& ai, const T& bi, const T& xj,
                          const T& yj, const T& aj, const T& bj) {
      return d - (xi * aj + xj * ai + yi * bj + yj * bi) + m * (xi * xj + yi * yj);
    };
    const auto &x = o.toe_x, &y = o.toe_y, &u = o.along_x, &v = o.along_y;
    return {part(o.d_hip, x.hip, y.hip, u.hip, v.hip, x.hip, y.hip, u.hip, v.hip),
            part(o.d_both, x.hip, y.hip, u.hip, v.hip, x.knee, y.knee, u.knee, v.knee),
            part(o.d_knee, x.knee, y.knee, u.knee, v.knee, x.knee, y.knee, u.knee, v.knee)};
  }
  /// Inertia of the joints in flight.
  Inertia flying_inertia(const Pose& o) const {
    const auto &u = o.along_x, &v = o.along_y;
    return {o.d_hip - inverse_mass_ * (u.hip * u.hip + v.hip * v.hip),
            o.d_both - inverse_mass_ * (u.hip * u.knee + v.hip * v.knee),
            o.d_knee - inverse_mass_ * (u.knee * u.knee + v.knee * v.knee)};
  }

  /// State after a touch-down.
  struct Impact {
    Joints2<T> rate;       ///< of the joints, rad/s
    Vec2<T> hip_velocity;  ///< m/s
    Vec2<T> impulse;       ///< of the ground, N s
  };
  /// Plastic touch-down: the toe stops at once; the joints' torques have no impulse.
  Impact impact(const Pose& o, const Vec2<T>& hip_velocity, const Joints2<T>& rate) const {
    const Joints2<T> pinned = pinned_momentum(o, hip_velocity, rate);
    Impact after;
    after.rate = solve(standing_inertia(o), pinned);
    after.hip_velocity = pinned_hip_velocity(o, after.rate);
    const Joints2<T> jump{after.rate.hip - rate.hip, after.rate.knee - rate.knee};
    after.impulse.x = p_.mass_kg * (after.hip_velocity.x - hip_velocity.x) + dot(o.along_x, jump);
    after.impulse.y = p_.mass_kg * (after.hip_velocity.y - hip_velocity.y) + dot(o.along_y, jump);
    return after;
  }
  /// What the impact keeps: the momentum of the motions that the pin allows, N m s.
  Joints2<T> pinned_momentum(const Pose& o, const Vec2<T>& hip_velocity, const Joints2<T>& rate) const {
    const T px = p_.mass_kg * hip_velocity.x + dot(o.along_x, rate);
    const T py = p_.mass_kg * hip_velocity.y + dot(o.along_y, rate);
    return {o.along_x.hip * hip_velocity.x + o.along_y.hip * hip_velocity.y + o.d_hip * rate.hip +
                o.d_both * rate.knee - (o.toe_x.hip * px + o.toe_y.hip * py),
            o.along_x.knee * hip_velocity.x + o.along_y.knee * hip_velocity.y + o.d_both * rate.hip +
                o.d_knee * rate.knee - (o.toe_x.knee * px + o.toe_y.knee * py)};
  }
  /// Velocity of the hip with the toe pinned, m/s.
  Vec2<T> pinned_hip_velocity(const Pose& o, const Joints2<T>& rate) const {
    return {-dot(o.toe_x, rate), -dot(o.toe_y, rate)};
  }

  /// Kinetic energy, J.
  T kinetic_energy(const Pose& o, const Vec2<T>& hip_velocity, const Joints2<T>& rate) const {
    return P(0.5) * (p_.mass_kg * (hip_velocity.x * hip_velocity.x + hip_velocity.y * hip_velocity.y) +
                     o.d_hip * rate.hip * rate.hip + P(2) * o.d_both * rate.hip * rate.knee +
                     o.d_knee * rate.knee * rate.knee) +
           hip_velocity.x * dot(o.along_x, rate) + hip_velocity.y * dot(o.along_y, rate);
  }
  /// Potential energy of gravity, J; zero with hip and all mass at a height of zero.
  T height_energy(const Pose& o, const T& hip_height_m) const {
    return p_.gravity_mps2 * (p_.mass_kg * hip_height_m - o.along_x.hip);
  }

  /// Sum of the products of both components.
  static T dot(const Joints2<T>& u, const Joints2<T>& v) { return u.hip * v.hip + u.knee * v.knee; }

 private:
  /// What turning alone asks of the body (rows x and y of C), of hip and knee, and of the pinned toe (J' q').
  struct Turning {
    Vec2<T> body, toe;
    T hip, knee;
  };
  Turning turning(const Pose& o, const Joints2<T>& rate) const {
    const T shank = rate.hip + rate.knee;
    const T hip2 = rate.hip * rate.hip, shank2 = shank * shank;
    const T sh = o.sin_hip * hip2, ch = o.cos_hip * hip2, ss = o.sin_shank * shank2,
            cs = o.cos_shank * shank2;
    Turning t;
    t.body = {-(a_ * sh + b_ * ss), a_ * ch + b_ * cs};
    t.toe = {-(p_.thigh_length_m * sh + p_.shank_length_m * ss),
             p_.thigh_length_m * ch + p_.shank_length_m * cs};
    const T knee = c_ * o.sin_knee;
    t.hip = knee * (hip2 - shank2);
    t.knee = knee * hip2;
    return t;
  }
  /// Rows hip and knee of D q'' + C + G with the friction, which motor and spring have to give.
  Joints2<T> joint_rows(const Pose& o, const Turning& t, const Joints2<T>& rate, const Joints2<T>& a,
                        const Vec2<T>& hip) const {
    const T up = hip.y + p_.gravity_mps2;
    return {o.along_x.hip * hip.x + o.along_y.hip * up + o.d_hip * a.hip + o.d_both * a.knee + t.hip +
                p_.hip_damping_nmspr * rate.hip,
            o.along_x.knee * hip.x + o.along_y.knee * up + o.d_both * a.hip + o.d_knee * a.knee + t.knee +
                p_.knee_damping_nmspr * rate.knee};
  }
  static Joints2<T> solve(const Inertia& i, const Joints2<T>& of) {
    const T inverse = ValueOf<T>(1) / (i.hip * i.knee - i.both * i.both);
    return {inverse * (i.knee * of.hip - i.both * of.knee), inverse * (i.hip * of.knee - i.both * of.hip)};
  }
  template <class F>
  static Motion forwards(const Needed& at_rest, const Inertia& inertia, const Joints2<T>& torque,
                         const F& f) {
    return f(solve(inertia, {torque.hip - at_rest.torque.hip, torque.knee - at_rest.torque.knee}));
  }

  PlanarLegParameters<P> p_;
  P a_, b_, c_, shank_, leg_, inverse_mass_;
};

}  // namespace furcula::dynamics
