// Devices on the bus, see peers.hpp.
#include "host/rig/peers.hpp"

#include <cmath>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/stream.hpp"
#include "host/core/message.hpp"

namespace furcula::rig {
namespace {

using namespace bus::message;

void set(bus::Frame& frame, const bus::Signal& signal, float value) {
  static_cast<void>(bus::put(frame, signal, value));
}
void set_code(bus::Frame& frame, const bus::Signal& signal, std::uint32_t raw) {
  static_cast<void>(bus::put_raw(frame, signal, raw));
}

float motor_value(const bus::Frame& frame, std::size_t signal, bus::Motor motor) {
  return bus::get(frame, bus::with_range(bus::table::kMotorCommand[signal], bus::info(motor))).value();
}

}  // namespace

bool is_switch_off(const bus::Frame& frame) { return bus::is(frame, kMotorExit, kDriveNode); }

bool is_for_drive(const bus::Frame& frame) {
  return bus::is(frame, kMotorEnter, kDriveNode) || bus::is(frame, kMotorCommand, kDriveNode) ||
         is_switch_off(frame);
}

std::optional<bus::Frame> Drive::receive(const bus::Frame& frame, float angle_rad, float torque_nm) {
  if (bus::is(frame, kMotorEnter, kDriveNode)) {
    on_ = true;
    torque_nm_ = 0.0f;
  } else if (is_switch_off(frame)) {
    on_ = false;
    torque_nm_ = 0.0f;
  } else if (bus::is(frame, kMotorCommand, kDriveNode)) {
    torque_nm_ = motor_value(frame, 4, motor_);
    if (motor_value(frame, 2, motor_) != 0.0f || motor_value(frame, 3, motor_) != 0.0f)
      complaint_ = "the drive was told a stiffness or a damping; expected torques alone";
  } else {
    return std::nullopt;
  }
  bus::Frame reply = bus::empty_frame(kMotorReply, kDriveNode);
  reply.size = bus::info(motor_).reply_bytes;
  const float measured[] = {angle_rad, velocity_radps_, torque_nm};
  for (std::size_t i = 0; i < 3; ++i)
    set(reply, bus::with_range(bus::table::kMotorReply[i + 1], bus::info(motor_)), measured[i]);
  if (reply.size > 6) reply.data[6] = temperature_c_;
  return reply;
}

bus::Frame EncoderNode::sample(std::uint32_t count, std::uint32_t age_us, bool homed) {
  bus::Frame frame = bus::empty_frame(kEncoderSample, node_);
  static_cast<void>(
      bus::put_stamp(frame, {bus::kProtocolVersion, sequence_++, static_cast<float>(age_us) * 1e-6f}));
  set_code(frame, bus::signal(kEncoderSample, "Status"), homed ? 0 : 1);
  set_code(frame, bus::signal(kEncoderSample, "Count"), count);
  return frame;
}

bus::Frame SupplyNode::sample(float volts) {
  bus::Frame frame = bus::empty_frame(kSupply, kSupplyNode);
  static_cast<void>(bus::put_stamp(frame, {bus::kProtocolVersion, sequence_++, 0.0f}));
  set(frame, bus::signal(kSupply, "Voltage"), volts);
  return frame;
}

bus::Frame Host::command(Request request, float amplitude_nm, float period_s, bool release) {
  bus::Frame frame = bus::empty_frame(kCommand, kBoardNode);
  static_cast<void>(bus::put_stamp(frame, {bus::kProtocolVersion, sequence_++, 0.0f}));
  set_code(frame, bus::signal(kCommand, "Request"), static_cast<std::uint32_t>(request));
  set(frame, bus::signal(kCommand, "Torque_Amplitude"), amplitude_nm);
  set(frame, bus::signal(kCommand, "Torque_Period"), period_s);
  set_code(frame, bus::signal(kCommand, "Clutch"), release ? 1 : 0);
  return frame;
}

void BoardWords::receive(const bus::Frame& frame) {
  if (bus::is(frame, kHeartbeat, kBoardNode)) {
    heard = true;
    state = bus::get_raw(frame, bus::signal(kHeartbeat, "State")).value();
    fault = bus::get_raw(frame, bus::signal(kHeartbeat, "Fault")).value();
  } else if (bus::is(frame, kBodyState, kBoardNode)) {
    fault = bus::get_raw(frame, bus::signal(kBodyState, "Fault")).value();
  }
}

}  // namespace furcula::rig
