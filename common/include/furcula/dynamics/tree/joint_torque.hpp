// The torque that a joint gives its body: the drive's, less damping, spring and drag.
#pragma once

#include <cstddef>

#include "furcula/dynamics/tree/model.hpp"

namespace furcula::dynamics::tree {

/// What acts against the motion of a joint, dry friction aside: damping qd + stiffness (q - rest) + drag qd |qd|,
/// N m.
template <class T>
[[gnu::always_inline]] inline T passive_torque(const JointLaw<T>& law, const T& q, const T& qd) {
  using V = ValueOf<T>;
  const T out = law.damping_nmspr * qd + law.stiffness_nmprad * (q - law.rest_rad);
  if (value_of(law.drag_nms2prad2) == V(0)) return out;
  const T drag = law.drag_nms2prad2 * qd * qd;
  return value_of(qd) < V(0) ? T(out - drag) : T(out + drag);
}

/// Of the rotor that counts as the joint's: none where an elastic drive parts them.
template <class T>
[[gnu::always_inline]] inline T joint_armature(const JointLaw<T>& law) {
  return law.elastic ? T(ValueOf<T>(0)) : law.armature_kgm2;
}

}  // namespace furcula::dynamics::tree
