// What a walking robot's sensors get wrong, drawn from a seed: joints' encoders and the IMU (docs/biped.md; sizes are chosen).
#pragma once

#include <array>
#include <cstdint>

#include "host/walk/batched_rollout.hpp"

namespace furcula::walk {

/// Standard deviations; constant ones are drawn once a robot.
struct SensorErrors {
  double encoder_offset_rad = 5e-3, encoder_rad = 2e-4, encoder_radps = 5e-3;
  double mounting_rad = 5e-3;  ///< of the IMU, about each axis
  double gyro_bias_radps = 2e-3, gyro_radps = 3e-3, acc_mps2 = 0.05;
};

/// One robot's sensors, for BatchedRollout<double>::senses.
class Sensors {
 public:
  Sensors(const SensorErrors& errors, std::uint64_t seed);
  void operator()(control::WalkSample<double>& sample, control::Imu<double>& imu);
  /// Of joint `i`'s encoder, constant.
  double offset_rad(std::size_t i) const { return offset_rad_[i]; }

 private:
  SensorErrors e_;
  std::uint64_t seed_, tick_ = 0;
  std::array<double, dynamics::biped::kJoints> offset_rad_{};
  dynamics::tree::Mat3<double> mounting_{};  ///< the robot's axes to the IMU's
  dynamics::tree::Vec3<double> bias_radps_{};
};

}  // namespace furcula::walk
