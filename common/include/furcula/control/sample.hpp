// Measurements of the robot and commands to it: what a controller exchanges with a board.
#pragma once

#include <cstdint>
#include <type_traits>

namespace furcula::control {

/// One reading of all sensors.
struct Sample {
  std::uint32_t height_count = 0;  ///< rail encoder, free-running, wraps
  std::uint32_t home_count = 0;    ///< what it read when the height was home_height_m
  float home_height_m = 0.0f;      ///< m; NaN as long as the encoder is not homed
  float leg_angle_rad = 0.0f;      ///< from the drive, from the vertical
  std::uint32_t age_us = 0;        ///< how long ago the sensors were read
  std::uint32_t contact = 0;       ///< raw switch: 0 open, 1 closed
  std::uint32_t cable_count = 0;  ///< encoder on the clutch's pulley, free-running, wraps; 0 without a clutch
  std::uint32_t cable_home_count = 0;  ///< what it read with the cable at rest
  std::uint32_t reported_fault = 0;  ///< that a device or the board itself reports: a control::Fault, 0 none
};
static_assert(sizeof(Sample) == 36 && std::is_trivially_copyable_v<Sample>, "it travels as bytes");

/// Command to the robot. The value of a default Command is the safe state.
struct Command {
  float torque_nm = 0.0f;  ///< positive flexes the leg
  float coil_duty = 0.0f;  ///< share of the supply across the solenoid's coil, 0 to 1; 0 = spring caught
};
static_assert(sizeof(Command) == 8 && std::is_trivially_copyable_v<Command>, "it travels as bytes");

}  // namespace furcula::control
