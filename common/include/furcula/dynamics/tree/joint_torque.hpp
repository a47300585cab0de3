// The torque that a joint gives its body: the drive's, less damping and spring.
#pragma once

#include <cstddef>

#include "furcula/dynamics/tree/model.hpp"

namespace furcula::dynamics::tree {

/// What acts against the motion of a joint, dry friction aside: damping qd + stiffness (q - rest).
template <class T>
[[gnu::always_inline]] inline T passive_torque(const JointLaw<T>& law, const T& q, const T& qd) {
  return law.damping_nmspr * qd + law.stiffness_nmprad * (q - law.rest_rad);
}

/// Of the rotor that counts as the joint's: none where an elastic drive parts them.
template <class T>
[[gnu::always_inline]] inline T joint_armature(const JointLaw<T>& law) {
  return law.elastic ? T(ValueOf<T>(0)) : law.armature_kgm2;
}

}  // namespace furcula::dynamics::tree
