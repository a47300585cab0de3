// A rotary joint on a torsion spring: on the rig of the joint under gravity.
#include "host/machines/rules.hpp"

const furcula::machines::Rules& furcula::dynamics::machines::TorsionPendulum::rules() {
  return RotaryJoint::rules();
}
