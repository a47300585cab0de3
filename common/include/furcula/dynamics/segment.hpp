// A stretch of motion of one axis with every force held: what lies between two events.
#pragma once

#include "furcula/dynamics/event_time.hpp"
#include "furcula/dynamics/scalar.hpp"
#include "furcula/dynamics/second_order_flow.hpp"

namespace furcula::dynamics {

/// Motion from (position, velocity) under y'' + delta y' + kappa y = acceleration; y is the displacement since the start. SI
/// units; of a rotary axis rad in place of m.
template <class T>
struct Segment {
  T position,        ///< at the start, m
      velocity,      ///< at the start, m/s
      acceleration,  ///< at the start without damping, m/s^2
      kappa,         ///< stiffness over mass, 1/s^2
      delta;         ///< damping over mass, 1/s

  /// Plain numbers: float or double.
  using V = ValueOf<T>;

  /// Position after the time of a flow of over(), m.

  T position_after(const Flow<T>& f) const {
    return position + velocity * f.impulse + acceleration * f.impulse_integral;
  }
  /// Velocity after the time of a flow of over(), m/s.
  T velocity_after(const Flow<T>& f) const { return velocity * f.impulse_rate + acceleration * f.impulse; }
  /// Acceleration after the time of a flow of over(), m/s^2.
  T acceleration_after(const Flow<T>& f) const {
    return acceleration - delta * velocity_after(f) - kappa * (position_after(f) - position);
  }
  /// The exact flow over `t` seconds, for the functions above.
  Flow<T> over(const T& t) const { return flow(kappa, delta, t); }

  /// The same motion in plain numbers, to search in.
  Segment<V> plain() const {
    return {value_of(position), value_of(velocity), value_of(acceleration), value_of(kappa), value_of(delta)};
  }

  /// The time in [from, to] at which `a position + b velocity + c` crosses zero; it must do so. Carries the
  /// derivatives of T by the implicit function theorem (one Newton step in T).
  T crossing_time(const T& a, const T& b, const T& c, V from, V to) const {
    const Segment<V> p = plain();
    const V pa = value_of(a), pb = value_of(b), pc = value_of(c);
    const auto value = [&](V t) {
      const Flow<V> f = p.over(t);
      return pa * p.position_after(f) + pb * p.velocity_after(f) + pc;
    };
    const auto rate = [&](V t) {
      const Flow<V> f = p.over(t);
      return pa * p.velocity_after(f) + pb * p.acceleration_after(f);
    };
    const V time = event_time<V>(from, to, value, rate);
    const V slope = rate(time);
    if (slope == V(0)) return T(time);
    const Flow<T> f = over(T(time));
    return T(time) - (a * position_after(f) + b * velocity_after(f) + c) / slope;
  }

  /// The time at which the velocity, which changes sign before `to`, is zero.
  T turning_time(V to) const { return crossing_time(T(V(0)), T(V(1)), T(V(0)), V(0), to); }
};

}  // namespace furcula::dynamics
