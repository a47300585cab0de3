// Robots that differ from the model: what a robust search tries each walk on.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/walk/rollout.hpp"

namespace furcula::walk {

/// One robot of an ensemble, in a lane of its own.
struct Member {
  dynamics::biped::Description robot;
  std::array<double, dynamics::biped::kJoints> encoder_offset_rad{};
  dynamics::tree::Vec3<double> imu_turn_rad{};  ///< of the IMU against the pelvis, small
  double foot_reads_n = 0.0;                    ///< more than is there
  double push_mps =
      0.0;  ///< standard deviation of what a push changes the pelvis' velocity by, in x and y; one push a second
  std::uint64_t seed = 0;  ///< of the pushes
};

/// kEnsemble robots. The first is the model itself, undisturbed. The others are drawn: `scale` times the ranges of document 000, Tables I and II, uniformly;
/// and beyond them dry friction of the gears of +-3 N m, stiffness and damping of the ground by a factor of up to 2, pushes of 0.03 m/s.
/// A mass is at least a fifth of the model's.
std::vector<Member> ensemble_of(const dynamics::biped::Description& robot, const EnsembleOptions& options);

}  // namespace furcula::walk
