// The ranges that motor drives with the mini-cheetah's packing map their integers to: a table of motors.
//
// Source: CubeMars (T-Motor), "AK Series Actuator Driver Manual" V1.0.8, section 5.3 "MIT power mode
// communication protocol", the table of modules on pages 49 and 50; the mini-cheetah's own drive: B. Katz,
// HKC_MiniCheetah, CAN_com.cpp. Where other sources say otherwise: docs/board_link.md.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "furcula/bus/message.hpp"

namespace furcula::bus {

/// A drive whose ranges are known.
enum class Motor : std::uint8_t {
  mini_cheetah = 0,
  ak10_9 = 1,
  ak60_6 = 2,
  ak70_10 = 3,
  ak80_6 = 4,
  ak80_9 = 5,
  ak80_64 = 6,
  biped_joint =
      7,  ///< no product: a drive of the biped (docs/biped.md), whose gains and torque no AK drive's range holds
};

/// Position, velocity and torque go from minus to plus their maximum, the gains from 0.
struct MotorInfo {
  Motor motor;               ///< its number is the row's index
  std::string_view name;     ///< as in configuration files; the enumerator's
  float position_max_rad;    ///< the packed position covers -max to +max
  float velocity_max_radps;  ///< the packed velocity covers -max to +max
  float torque_max_nm;       ///< the packed torque covers -max to +max
  float stiffness_max_nmpr;  ///< kp
  float damping_max_nmspr;   ///< kd
  std::uint8_t reply_bytes;  ///< 6, or 8 with temperature and error code
};

/// The table of motors, in the order of their numbers.
inline constexpr std::array<MotorInfo, 8> kMotors{{
    {Motor::mini_cheetah, "mini_cheetah", 12.5f, 65.0f, 18.0f, 500.0f, 5.0f, 6},
    {Motor::ak10_9, "ak10_9", 12.5f, 50.0f, 65.0f, 500.0f, 5.0f, 8},
    {Motor::ak60_6, "ak60_6", 12.5f, 45.0f, 15.0f, 500.0f, 5.0f, 8},
    {Motor::ak70_10, "ak70_10", 12.5f, 50.0f, 25.0f, 500.0f, 5.0f, 8},
    {Motor::ak80_6, "ak80_6", 12.5f, 76.0f, 12.0f, 500.0f, 5.0f, 8},
    {Motor::ak80_9, "ak80_9", 12.5f, 50.0f, 18.0f, 500.0f, 5.0f, 8},
    {Motor::ak80_64, "ak80_64", 12.5f, 8.0f, 144.0f, 500.0f, 5.0f, 8},
    {Motor::biped_joint, "biped_joint", 3.2f, 20.0f, 220.0f, 4000.0f, 100.0f, 8},
}};

/// The motor's row of the table.
constexpr const MotorInfo& info(Motor motor) { return kMotors[static_cast<std::size_t>(motor)]; }

static_assert(
    [] {
      for (std::size_t i = 0; i < kMotors.size(); ++i)
        if (static_cast<std::size_t>(kMotors[i].motor) != i) return false;
      return true;
    }(),
    "the motors stand in the order of their numbers");

/// The signal with the scale that the motor gives it; as it is where it does not depend on the motor.
constexpr Signal with_range(Signal signal, const MotorInfo& motor) {
  const auto symmetric = [&](float maximum) {
    signal.span = 2.0f * maximum;
    signal.offset = -maximum;
  };
  switch (signal.ranged) {
    case Ranged::no:
      return signal;
    case Ranged::position:
      symmetric(motor.position_max_rad);
      break;
    case Ranged::velocity:
      symmetric(motor.velocity_max_radps);
      break;
    case Ranged::torque:
      symmetric(motor.torque_max_nm);
      break;
    case Ranged::stiffness:
      signal.span = motor.stiffness_max_nmpr;
      break;
    case Ranged::damping:
      signal.span = motor.damping_max_nmspr;
      break;
  }
  signal.counts = static_cast<float>((1u << signal.width) - 1u);
  return signal;
}

}  // namespace furcula::bus
