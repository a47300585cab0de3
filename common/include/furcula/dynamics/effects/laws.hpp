// The mechanism's laws that act on any axis: one function a law, in the words of the catalogue. Forces are
// positive in the direction of growing position, SI units; on a rotary axis read torque, rad/s and rad.
#pragma once

#include <cmath>

#include "furcula/dynamics/effects/effects.hpp"
#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

template <class T>
using MechanismEffects = EffectsOf<T, Stage::mechanism>;

/// Stribeck curve: the size of the friction at a speed >= 0.
template <class T>
T stribeck(const T& coulomb, const T& static_force, const T& stribeck_velocity, const T& speed) {
  using std::exp;
  const T ratio = speed / stribeck_velocity;
  return coulomb + (static_force - coulomb) * exp(-(ratio * ratio));
}

/// Everything that opposes the motion with a size that does not vanish with the speed: dry friction. `up` is
/// the direction of the motion (or of the motion that would begin), `speed` >= 0. The force is -size upwards,
/// +size downwards.
template <class T>
T dry_friction(const MechanismEffects<T>& e, bool up, const T& speed) {
  T size = T(ValueOf<T>(0));
  if (e.has(Effect::coulomb_friction)) size += e.value(Effect::coulomb_friction);
  if (e.has(Effect::stribeck_friction))
    size += stribeck(e.value(Effect::stribeck_friction, 0), e.value(Effect::stribeck_friction, 1),
                     e.value(Effect::stribeck_friction, 2), speed);
  if (e.has(Effect::asymmetric_friction)) size += e.value(Effect::asymmetric_friction, up ? 0 : 1);
  return size;
}

/// True if something can hold the axis at rest.
template <class T>
bool has_dry_friction(const MechanismEffects<T>& e) {
  return e.has(Effect::coulomb_friction) || e.has(Effect::stribeck_friction) ||
         e.has(Effect::asymmetric_friction) || e.has(Effect::binding_spot) ||
         e.has(Effect::spring_hysteresis);
}

/// Share of the way from `from` to `to` (in either direction) that lies within `width` about `centre`.
template <class T>
T share_within(const T& centre, const T& width, const T& from, const T& to) {
  using V = ValueOf<T>;
  const T half = V(0.5) * width;
  const bool rising = value_of(to) >= value_of(from);
  const T& low = rising ? from : to;
  const T& high = rising ? to : from;
  const T begin = centre - half, end = centre + half;
  const T length = high - low;
  if (value_of(length) < V(1e-9)) {
    const bool inside = value_of(low) >= value_of(begin) && value_of(low) <= value_of(end);
    return T(inside ? V(1) : V(0));
  }
  const T a = value_of(begin) > value_of(low) ? begin : low;
  const T b = value_of(end) < value_of(high) ? end : high;
  return value_of(b) > value_of(a) ? T((b - a) / length) : T(V(0));
}

/// The extra dry friction of a binding spot on the way from one position to another, >= 0.
template <class T>
T binding(const MechanismEffects<T>& e, const T& from, const T& to) {
  if (!e.has(Effect::binding_spot)) return T(ValueOf<T>(0));
  return e.value(Effect::binding_spot, 0) *
         share_within(e.value(Effect::binding_spot, 1), e.value(Effect::binding_spot, 2), from, to);
}

/// -c v |v|, force.
template <class T>
T quadratic_drag(const T& drag, const T& velocity) {
  return value_of(velocity) > 0 ? -(drag * velocity * velocity) : drag * velocity * velocity;
}

/// All that opposes the motion on the guide or axis, as a force: dry friction against the direction `up`,
/// with `extra` that depends on the place, and drag. At rest (`velocity` zero) it is what friction can hold
/// against a motion that would begin in that direction.
template <class T>
T resistance(const MechanismEffects<T>& e, bool up, const T& velocity, const T& extra) {
  const T size = dry_friction(e, up, up ? velocity : T(-velocity)) + extra;
  T force = up ? T(-size) : size;
  if (e.has(Effect::quadratic_drag)) force += quadratic_drag(e.value(Effect::quadratic_drag), velocity);
  return force;
}

/// The mean acceleration over a step, by the resistance at its predicted midpoint, or the word that friction
/// holds.
template <class T>
struct Resisted {
  T acceleration;  ///< without viscous damping, which the flow takes exactly
  bool held;
};
template <class T, class Step>  // of the step: T where an event moves its length, else plain
Resisted<T> resisted(const MechanismEffects<T>& e, bool up, bool at_rest, const T& velocity,
                     const T& acceleration, const T& delta, const T& inverse_mass, const T& extra,
                     const Step& step) {
  using V = ValueOf<T>;
  const T zero = T(V(0));
  const T at_start = resistance(e, up, at_rest ? zero : velocity, extra) * inverse_mass;
  if (at_rest &&
      (up ? value_of(acceleration) <= -value_of(at_start) : value_of(acceleration) >= -value_of(at_start)))
    return {zero, has_dry_friction(e)};
  const T middle = velocity + (acceleration + at_start - delta * velocity) * (V(0.5) * step);
  const bool turns = up ? value_of(middle) < V(0) : value_of(middle) > V(0);
  return {acceleration + resistance(e, up, turns ? zero : middle, extra) * inverse_mass, false};
}

}  // namespace furcula::dynamics
