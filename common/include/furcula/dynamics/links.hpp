// The non-linear leg's equations of motion, q = [theta, z] (docs/physics.md, the non-linear hopper): inertia,
// gravity, the toe's Jacobian, and the plastic impacts of toe and stop.
#pragma once

#include <cmath>

#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// The lumped inertia of the four links (002 eq. 3.14, docs/physics.md).
template <class T>
struct Links {
  /// The value type of T: float or double.
  using V = ValueOf<T>;
  T a{},              ///< kg m^2: sum of I + m_L (r_L^2 + L^2) + m_U r_U^2
      b{},            ///< kg m: sum of m_L r_L
      e{},            ///< kg m: sum of m_L (r_L + L) + m_U r_U
      link_length{},  ///< L, of each of the four links, m
      mass{};         ///< of everything that moves, kg

  /// M of M q'' + B + G = [torque, 0] + J^T F_c, symmetric.
  struct Inertia {
    T angle,       ///< M11, of the leg angle, kg m^2
        coupling,  ///< M12, between angle and height, kg m
        height;    ///< M22, of the height: the mass, kg
  };

  /// What all of the equations need of a leg angle theta.
  struct Pose {
    T sine,           ///< of theta
        cosine;       ///< of theta
    T length;         ///< hip to toe, m
    T lever;          ///< -d length / d theta = 2 L sin theta, m/rad: the toe's Jacobian is [lever, 1]
    Inertia inertia;  ///< at this angle
  };

  /// The pose of a leg angle, rad.
  Pose pose(const T& angle) const {
    using std::cos;
    using std::sin;
    return pose(T(sin(angle)), T(cos(angle)));
  }

  /// The pose of an angle that differs from that of a pose by `by` rad. Below kNear it uses the first terms of the series of
  /// sine and cosine, which are exact to the rounding of a double.
  [[gnu::always_inline]] Pose turned(const Pose& from, const T& by) const {
    constexpr V kNear = V(0.05);
    if (!(value_of(by) < kNear && value_of(by) > -kNear)) return turned_far(from, by);
    const T x = by * by;
    const T sine = by * (V(1) - x * (V(1.0 / 6) - x * (V(1.0 / 120) - x * V(1.0 / 5040))));
    const T cosine = V(1) - x * (V(0.5) - x * (V(1.0 / 24) - x * (V(1.0 / 720) - x * V(1.0 / 40320))));
    return turned(from, sine, cosine);
  }

  /// B1 without damping: torque on the angle that the motion at `rate` (rad/s) needs, N m.
  T turning_torque(const Pose& p, const T& rate) const {
    return V(4) * link_length * b * p.sine * p.cosine * rate * rate;
  }
  /// B2 without damping: force on the height that the motion at `rate` (rad/s) needs, N.
  T turning_force(const Pose& p, const T& rate) const { return e * p.cosine * rate * rate; }

  /// G1 without the spring, over the acceleration of gravity, kg m (for the height it is the mass).
  T hanging(const Pose& p) const { return e * p.sine; }

  /// Inertia of the motion with the toe on the ground, z' = -lever theta', for the angle theta, kg m^2.
  T standing_inertia(const Pose& p) const {
    return p.inertia.angle - V(2) * p.lever * p.inertia.coupling + p.lever * p.lever * p.inertia.height;
  }

  /// Rate of the angle, rad/s, after the toe has come to rest on the ground: the plastic impact
  /// q'+ = q'- - M^-1 J^T (J M^-1 J^T)^-1 J q'- along the motion that the ground leaves.
  T rate_after_touchdown(const Pose& p, const T& rate, const T& velocity) const {
    return (p.inertia.angle * rate + p.inertia.coupling * (velocity - p.lever * rate) -
            p.lever * p.inertia.height * velocity) /
           standing_inertia(p);
  }

  /// Velocity of the body, m/s, after the stop has brought the angle to rest while the toe is free: it takes
  /// over the links' momentum.
  T velocity_after_stop(const Pose& p, const T& rate, const T& velocity) const {
    return velocity + p.inertia.coupling * rate / p.inertia.height;
  }

  /// Kinetic energy at an angle's rate (rad/s) and a velocity of the body (m/s), J.
  T kinetic_energy(const Pose& p, const T& rate, const T& velocity) const {
    return V(0.5) * (p.inertia.angle * rate * rate + p.inertia.height * velocity * velocity) +
           p.inertia.coupling * rate * velocity;
  }

 private:
  [[gnu::noinline]] Pose turned_far(const Pose& from, const T& by) const {
    using std::cos;
    using std::sin;
    return turned(from, T(sin(by)), T(cos(by)));
  }
  [[gnu::always_inline]] Pose turned(const Pose& from, const T& sine, const T& cosine) const {
    return pose(T(from.sine * cosine + from.cosine * sine), T(from.cosine * cosine - from.sine * sine));
  }
  Pose pose(const T& sine, const T& cosine) const {
    Pose p;
    p.sine = sine;
    p.cosine = cosine;
    p.length = V(2) * link_length * p.cosine;
    p.lever = V(2) * link_length * p.sine;
    // cos 2 theta = 1 - 2 sin^2 theta
    p.inertia = {a - V(2) * link_length * b * (V(1) - V(2) * p.sine * p.sine), e * p.sine, mass};
    return p;
  }
};

}  // namespace furcula::dynamics
