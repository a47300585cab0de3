// A robot's tree as MJCF, the file format of the simulator MuJoCo.
#pragma once

#include <string>
#include <vector>

#include "host/model/urdf.hpp"

namespace furcula::model {

/// Of a joint's drive: torque = kp (set point - q) - kd qd.
struct PositionGains {
  std::string joint;
  double kp_nmprad = 0.0, kd_nmsprad = 0.0;
};

/// The tree with its laws' armature, damping, springs and Coulomb friction (frictionloss), so that MuJoCo's
/// accelerations without contact are those of the tree's forward_dynamics. A body for each joint, named after
/// its link; links that are fixed to it are sites. Each joint has a motor of gear 1, or an actuator with these
/// gains. What MJCF cannot hold (static friction above that of motion, elastic drives) is left out and named in
/// a comment.
std::string format_mjcf(const RobotTree& robot, const std::vector<PositionGains>& gains = {});

}  // namespace furcula::model
