// How a walk begins: the robot in its posture, at rest.
#pragma once

#include <cmath>

#include "furcula/control/walk/walk.hpp"
#include "furcula/dynamics/biped/kinematics.hpp"
#include "host/walk/rollout.hpp"

namespace furcula::walk {

/// Its soles level on the ground. A passive hip begins at its spring's rest. `parameters` are the robot's.
inline dynamics::biped::State<double> posture(const dynamics::biped::Description& robot,
                                              const dynamics::biped::Parameters<double>& parameters,
                                              WalkMode mode, const Parameters& walk) {
  using namespace dynamics::biped;
  State<double> s;
  double pitch = 0.0;
  for (const std::size_t side : {kLeft, kRight}) {
    auto leg = control::leg_angles(walk, {}, side);
    if (mode == WalkMode::semi_passive) leg[kHipPitch] = robot.clutches[side][kHipClutch].spring_rest_rad;
    for (std::size_t j = 0; j < kLegJoints; ++j) set_joint<double>(s.q_rad, side * kLegJoints + j, leg[j]);
    pitch = -(leg[kHipPitch] + leg[kKnee] + leg[kAnklePitch]);
  }
  s.attitude = {std::cos(0.5 * pitch), 0.0, std::sin(0.5 * pitch), 0.0};
  Kinematics<double> k;
  kinematics<DesignTopology>(parameters, s, k);
  s.position_m.z = -(k.legs[0].foot_position_m.z[kLeft] + robot.vertices_m[kLeft][0].z);
  return s;
}

}  // namespace furcula::walk
