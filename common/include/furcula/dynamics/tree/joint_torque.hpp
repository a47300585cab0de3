// The torque of a joint on its body besides the drive's: damping, springs and drag; and its armature.
#pragma once

#include <cmath>
#include <cstddef>
#include <type_traits>

#include "furcula/dynamics/tree/model.hpp"

namespace furcula::dynamics::tree {

/// Torque of the unilateral spring (of a two-sided one at any angle), N m: a positive value acts in the negative direction.
template <class T>
[[gnu::always_inline]] inline T one_way_torque(const JointLaw<T>& law, const T& q) {
  using V = ValueOf<T>;
  const T stretch = q - law.one_way_rest_rad;
  return law.two_sided || value_of(stretch) > V(0) ? T(law.one_way_nmprad * stretch) : T(V(0));
}

/// Torque against the drive without dry friction: damping qd + stiffness (q - rest) + unilateral spring + drag qd |qd|, N m.
template <class T>
[[gnu::always_inline]] inline T passive_torque(const JointLaw<T>& law, const T& q, const T& qd) {
  T spring = law.stiffness_nmprad * (q - law.rest_rad);
  if (value_of(law.one_way_nmprad) > ValueOf<T>(0)) spring += one_way_torque(law, q);
  if constexpr (std::is_arithmetic_v<T>) {  // quicker than to ask whether there is drag
    return (law.damping_nmspr + law.drag_nms2prad2 * std::abs(qd)) * qd + spring;
  } else {
    if (!(value_of(law.drag_nms2prad2) > ValueOf<T>(0))) return law.damping_nmspr * qd + spring;
    const T size = value_of(qd) < ValueOf<T>(0) ? T(-qd) : qd;
    return (law.damping_nmspr + law.drag_nms2prad2 * size) * qd + spring;
  }
}

/// Rotor inertia that is rigidly coupled to the joint, kg m^2: zero for an elastic drive.
template <class T>
[[gnu::always_inline]] inline T joint_armature(const JointLaw<T>& law) {
  return law.elastic ? T(ValueOf<T>(0)) : law.armature_kgm2;
}

}  // namespace furcula::dynamics::tree
