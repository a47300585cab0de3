// What a walking robot's devices tell the board in a tick: the drives of its joints, the IMU, the feet, the pins of its clutches; and
// what the board tells the drives.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "furcula/dynamics/biped/topology.hpp"

namespace furcula::control {

inline constexpr std::size_t kWalkerJoints = dynamics::biped::kJoints;
inline constexpr std::size_t kWalkerPins = 2 * dynamics::biped::kClutches;
/// No joint is meant.
inline constexpr std::uint32_t kNoJoint = kWalkerJoints;

/// Who answers, by its bit in WalkerSample::answered: the drives by their joints' numbers, then these.
inline constexpr std::uint32_t kImuDevice = kWalkerJoints, kFeetDevice = kImuDevice + 1,
                               kPinsDevice = kFeetDevice + 1, kWalkerDevices = kPinsDevice + 1;
inline constexpr std::uint32_t kAllDevices = (1u << kWalkerDevices) - 1u;

/// What a joint's drive answers.
struct JointReading {
  float angle_rad = 0.0f, rate_radps = 0.0f;
  float torque_nm = 0.0f;  ///< of the motor, as seen at the joint, from its current
};

struct WalkerSample {
  std::array<JointReading, kWalkerJoints> joints;  ///< the left leg's from the hip down, then the right's
  dynamics::tree::Vec3<float> gyro_radps{}, acc_mps2{};
  std::array<float, 2> foot_n{};  ///< under the soles, left and right
  /// 1: in the motor's rotator, 0: in neither, -1: in the spring's. Left hip pitch, left knee, right hip pitch, right knee.
  std::array<float, kWalkerPins> pins{};
  std::uint32_t answered = 0;            ///< a bit for each device that gave a fresh sample
  std::uint32_t reported_fault = 0;      ///< that a device or the board reports: a control::Fault, 0 none
  std::uint32_t reported_by = kNoJoint;  ///< whose drive reported it
};
static_assert(sizeof(WalkerSample) == 204 && std::is_trivially_copyable_v<WalkerSample>,
              "it travels as bytes");

/// To a joint's drive: torque = stiffness (target - angle) - damping rate.
struct JointCommand {
  float target_rad = 0.0f, stiffness_nmprad = 0.0f, damping_nmsprad = 0.0f;
};

/// The joint behind a pin.
constexpr std::size_t joint_of_pin(std::size_t pin) {
  using namespace dynamics::biped;
  return pin / kClutches * kLegJoints + kClutchJoints[pin % kClutches];
}

}  // namespace furcula::control
