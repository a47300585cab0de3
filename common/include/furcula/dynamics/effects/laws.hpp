// Force models of the mechanism stage for any axis, one function each, named as in the catalogue. Forces are positive in
// the direction of increasing position, SI units; for a rotary axis read torque, rad/s and rad.
#pragma once

#include <cmath>

#include "furcula/dynamics/effects/effects.hpp"
#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// The effects of the mechanism stage.
template <class T>
using MechanismEffects = EffectsOf<T, Stage::mechanism>;

/// Stribeck curve: the magnitude of friction at a speed >= 0.
template <class T>
T stribeck(const T& coulomb, const T& static_force, const T& stribeck_velocity, const T& speed) {
  using std::exp;
  const T ratio = speed / stribeck_velocity;
  return coulomb + (static_force - coulomb) * exp(-(ratio * ratio));
}

/// Magnitude of dry friction at a speed >= 0, from the effects that are on, without binding spot and spring hysteresis. `up`:
/// the motion, or the motion that would begin, is in the positive direction. The force is minus the magnitude where `up`,
/// else plus the magnitude.
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

/// Whether any effect can hold the axis at rest.
template <class T>
bool has_dry_friction(const MechanismEffects<T>& e) {
  return e.has(Effect::coulomb_friction) || e.has(Effect::stribeck_friction) ||
         e.has(Effect::asymmetric_friction) || e.has(Effect::binding_spot) ||
         e.has(Effect::spring_hysteresis);
}

/// Fraction, 0 to 1, of the path from `from` to `to` (in either direction) that lies within `width` about `centre`.
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

/// Added dry friction of a binding spot, averaged over the path from one position to another, >= 0.
template <class T>
T binding(const MechanismEffects<T>& e, const T& from, const T& to) {
  if (!e.has(Effect::binding_spot)) return T(ValueOf<T>(0));
  return e.value(Effect::binding_spot, 0) *
         share_within(e.value(Effect::binding_spot, 1), e.value(Effect::binding_spot, 2), from, to);
}

/// Force of quadratic drag: -c v |v|.
template <class T>
T quadratic_drag(const T& drag, const T& velocity) {
  return value_of(velocity) > 0 ? -(drag * velocity * velocity) : drag * velocity * velocity;
}

/// Force against the motion: dry friction in the direction `up`, plus its position-dependent part `extra` (>= 0), and
/// quadratic drag. At rest (`velocity` zero): the limit of static friction against a motion that would begin in that
/// direction.
template <class T>
T resistance(const MechanismEffects<T>& e, bool up, const T& velocity, const T& extra) {
  const T size = dry_friction(e, up, up ? velocity : T(-velocity)) + extra;
  T force = up ? T(-size) : size;
  if (e.has(Effect::quadratic_drag)) force += quadratic_drag(e.value(Effect::quadratic_drag), velocity);
  return force;
}

/// Result of resisted().
template <class T>
struct Resisted {
  T acceleration;  ///< mean over the step, without viscous damping, which the flow includes exactly
  bool held;       ///< friction holds the axis at rest
};
/// Mean acceleration over a step with the resistance at its predicted midpoint. `acceleration` is that without resistance and
/// viscous damping, `delta` damping over mass, 1/s; `at_rest`: the axis starts at rest, to move in direction `up` if at all.
/// `Step` is T where the step's length depends on an event, else a plain number.
template <class T, class Step>
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
