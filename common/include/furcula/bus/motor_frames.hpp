// The mini-cheetah's command and reply as structures, in the range of the motor.
#pragma once

#include <cstdint>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/motors.hpp"
#include "furcula/core/status.hpp"

namespace furcula::bus {

/// Set points of the drive's impedance control: the drive adds `torque_nm` to stiffness times position error
/// and damping times velocity error.
struct MotorCommand {
  float position_rad = 0.0f;    ///< target, in the drive's direction and from the drive's zero
  float velocity_radps = 0.0f;  ///< target, in the drive's direction
  float stiffness_nmpr = 0.0f;  ///< gain of the position error (kp), N m/rad
  float damping_nmspr = 0.0f;   ///< gain of the velocity error (kd), N m s/rad
  float torque_nm = 0.0f;       ///< feed-forward, in the drive's direction
};

/// What the drive measures and sends after each command.
struct MotorReply {
  float position_rad = 0.0f;     ///< in the drive's direction and from the drive's zero
  float velocity_radps = 0.0f;   ///< in the drive's direction
  float torque_nm = 0.0f;        ///< in the drive's direction, as the drive estimates it
  bool long_reply = false;       ///< the two that follow were there
  std::uint8_t temperature = 0;  ///< as the drive sends it
  std::uint8_t error = 0;        ///< 0: none
};

/// The frame, each value clamped to the motor's range as the drive would. `invalid`: a value that is not a
/// number.
constexpr Result<Frame> pack(const MotorCommand& command, Motor motor, std::uint8_t node) {
  const float values[] = {command.position_rad, command.velocity_radps, command.stiffness_nmpr,
                          command.damping_nmspr, command.torque_nm};
  Frame frame = empty_frame(message::kMotorCommand, node);
  for (std::size_t i = 0; i < table::kMotorCommand.size(); ++i)
    if (put(frame, with_range(table::kMotorCommand[i], info(motor)), values[i]) == Put::refused)
      return Status::invalid;
  return frame;
}

/// `invalid`: not a reply of that motor.
constexpr Result<MotorReply> unpack_reply(const Frame& frame, Motor motor, std::uint8_t node) {
  if (!is(frame, message::kMotorReply, node)) return Status::invalid;
  const auto value = [&](std::size_t i) {
    return get(frame, with_range(table::kMotorReply[i], info(motor))).value();
  };
  MotorReply reply{value(1), value(2), value(3)};
  reply.long_reply = frame.size == message::kMotorReply.size;
  if (reply.long_reply) {
    reply.temperature = frame.data[6];
    reply.error = frame.data[7];
  }
  return reply;
}

}  // namespace furcula::bus
