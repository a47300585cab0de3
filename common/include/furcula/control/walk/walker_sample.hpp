// What a walking robot's devices report to the board in a tick: the drives of its joints, the IMU, the feet, the pins of
// its clutches; and the board's commands to the drives.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "furcula/dynamics/biped/topology.hpp"

namespace furcula::control {

inline constexpr std::size_t kWalkerJoints = dynamics::biped::kJoints;      ///< of both legs
inline constexpr std::size_t kWalkerPins = 2 * dynamics::biped::kClutches;  ///< of both legs
/// Number that stands for no joint.
inline constexpr std::uint32_t kNoJoint = kWalkerJoints;

// Bits of WalkerSample::answered: the drives by their joints' numbers, then these.
inline constexpr std::uint32_t kImuDevice = kWalkerJoints,  ///< bit of the IMU in WalkerSample::answered
    kFeetDevice = kImuDevice + 1,                           ///< bit of the feet
    kPinsDevice = kFeetDevice + 1,                          ///< bit of the pins
    kWalkerDevices = kPinsDevice + 1;                       ///< number of devices
/// All bits of WalkerSample::answered.
inline constexpr std::uint32_t kAllDevices = (1u << kWalkerDevices) - 1u;

/// What a joint's drive answers.
struct JointReading {
  float angle_rad = 0.0f,  ///< of the joint
      rate_radps = 0.0f;   ///< of the joint
  float torque_nm = 0.0f;  ///< of the motor, as seen at the joint, from its current
};

/// What the devices measured in a tick.
struct WalkerSample {
  std::array<JointReading, kWalkerJoints> joints;  ///< the left leg's from the hip down, then the right's
  dynamics::tree::Vec3<float> gyro_radps{},        ///< of the IMU, in the pelvis frame's axes
      acc_mps2{};                 ///< of the IMU: specific force, at rest the opposite of gravity
  std::array<float, 2> foot_n{};  ///< normal force under each sole, left and right
  /// Position of each pin; 1: in the motor's rotator, 0: in neither, -1: in the spring's. Left hip pitch, left knee,
  /// right hip pitch, right knee.
  std::array<float, kWalkerPins> pins{};
  std::uint32_t answered = 0;            ///< a bit for each device that gave a fresh sample
  std::uint32_t reported_fault = 0;      ///< that a device or the board reports: a control::Fault, 0 none
  std::uint32_t reported_by = kNoJoint;  ///< joint whose drive reported it
};
static_assert(sizeof(WalkerSample) == 204 && std::is_trivially_copyable_v<WalkerSample>,
              "it travels as bytes");

/// Command to a joint's drive: torque = stiffness (target - angle) - damping rate.
struct JointCommand {
  float target_rad = 0.0f,      ///< target angle of the joint
      stiffness_nmprad = 0.0f,  ///< 0: the target does not act
      damping_nmsprad = 0.0f;   ///< on the joint's rate
};

/// Number of the joint that a pin joins to its motor, for WalkerSample::joints.
constexpr std::size_t joint_of_pin(std::size_t pin) {
  using namespace dynamics::biped;
  return pin / kClutches * kLegJoints + kClutchJoints[pin % kClutches];
}

}  // namespace furcula::control
