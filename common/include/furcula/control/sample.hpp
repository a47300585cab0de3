// What the rig measures and what it is told: the controller's words to and from a board.
#pragma once

#include <cstdint>
#include <type_traits>

namespace furcula::control {

/// One reading of all sensors.
struct Sample {
  std::uint32_t height_count = 0;  ///< rail encoder, free-running, wraps
  std::uint32_t home_count = 0;    ///< what it read where the height was home_height_m
  float home_height_m = 0.0f;      ///< m; NaN as long as the encoder is not homed
  float leg_angle_rad = 0.0f;      ///< from the drive, from the vertical
  std::uint32_t age_us = 0;        ///< how long ago the sensors were read
  std::uint32_t contact = 0;       ///< raw switch: 0 open, 1 closed
};
static_assert(sizeof(Sample) == 24 && std::is_trivially_copyable_v<Sample>, "it travels as bytes");

/// What the rig is told. The value of a default Command is the safe state.
struct Command {
  float torque_nm = 0.0f;      ///< positive flexes the leg
  std::uint32_t solenoid = 0;  ///< 1 = energised = spring released; no block energises it yet
};
static_assert(sizeof(Command) == 8 && std::is_trivially_copyable_v<Command>, "it travels as bytes");

}  // namespace furcula::control
