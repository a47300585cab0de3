// The biped's twelve drives on their buses: an id a joint. Each is told and answers with the frames of the mini-cheetah's protocol, in the
// range of the motor biped_joint.
//
// One bus of 1 Mbit/s does not hold them at 1 kHz, nor do two: docs/bus.md has the loads. A bus a leg holds them at 500 Hz: three drives of a
// leg in each even tick of 1 ms, the other three in each odd one. IMU, feet and pins are on the board itself, or on a third bus, the body's.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "furcula/bus/load.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/motors.hpp"

namespace furcula::bus {

/// Address of one joint's drive.
struct WalkerDrive {
  std::string_view joint;  ///< name as in the controller, for example left_knee
  std::uint8_t bus;        ///< 0: the left leg's, 1: the right one's
  std::uint8_t
      node;  ///< no two joints have the same, on either bus: a plug in the wrong socket is silent, not another joint
};

/// Type of all twelve drives.
inline constexpr Motor kWalkerMotor = Motor::biped_joint;
/// Buses with drives: one a leg.
inline constexpr std::size_t kWalkerBuses = 2;
/// Rate at which each drive is commanded and replies.
inline constexpr std::uint32_t kWalkerDrive_hz = 500;

/// In the order of the controller's joints (control/walk/walker_sample.hpp).
inline constexpr std::array<WalkerDrive, 12> kWalkerDrives{{
    {"left_hip_yaw", 0, 1},
    {"left_hip_roll", 0, 2},
    {"left_hip_pitch", 0, 3},
    {"left_knee", 0, 4},
    {"left_ankle_pitch", 0, 5},
    {"left_ankle_roll", 0, 6},
    {"right_hip_yaw", 1, 7},
    {"right_hip_roll", 1, 8},
    {"right_hip_pitch", 1, 9},
    {"right_knee", 1, 10},
    {"right_ankle_pitch", 1, 11},
    {"right_ankle_roll", 1, 12},
}};

/// Whether a drive's turn is in this tick: each is told and asked every second one.
constexpr bool has_turn(std::size_t joint, std::uint32_t tick) { return (joint + tick) % 2 == 0; }

/// Share of a bus with `drives` of them, each told and answering `hz` times a second, at worst.
constexpr double walker_load(std::uint32_t drives, std::uint32_t hz) {
  const std::array<Traffic, 2> all{
      {{&message::kMotorCommand, drives * hz}, {&message::kMotorReply, drives * hz}}};
  return worst_load(all);
}

/// What the body's bus carries where IMU, feet and pins are on one, times a second: the host's commands and the board's own messages are included.
inline constexpr std::array<Traffic, 9> kWalkerBodyTraffic{{{&message::kGyro, 1000},
                                                            {&message::kAcceleration, 1000},
                                                            {&message::kFeet, 1000},
                                                            {&message::kPins, 1000},
                                                            {&message::kPinTargets, 100},
                                                            {&message::kWalkState, 100},
                                                            {&message::kCommand, 100},
                                                            {&message::kHeartbeat, 10},
                                                            {&message::kIdentity, 10}}};

}  // namespace furcula::bus
