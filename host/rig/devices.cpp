// Devices at the rig's end of the bus, see devices.hpp.
#include "host/rig/devices.hpp"

#include <linux/can/error.h>

#include <cmath>

namespace furcula::rig {

using sim_host::RigFault;

void Devices::begin_tick(const sim_host::SimBoard& rig, bool faults) {
  ++tick_;
  const control::Sample& s = rig.sample();
  const auto broken = [&](RigFault fault) { return faults && rig.active(fault); };
  const float turned_rad = tick_ == 1 ? 0.0f : s.leg_angle_rad - leg_angle_rad_;
  leg_angle_rad_ = s.leg_angle_rad;
  drive_.show(1e3f * turned_rad,
              static_cast<std::uint8_t>(broken(RigFault::drive_hot) ? sim_host::kHotMotorC : 25.0));
  drive_.set_motor(broken(RigFault::drive_of_other_motor) ? bus::Motor::ak80_6 : kMotor);
  offset_nm_ = broken(RigFault::torque_offset) ? static_cast<float>(sim_host::kTorqueOffsetNm) : 0.0f;
  doubled_ = broken(RigFault::drive_doubled);
  look_at_bus(rig, faults);
  drive_dead_ = broken(RigFault::drive_silent);
  drive_error_ = broken(RigFault::drive_error);
  drive_sound_ = !drive_dead_ && !drive_error_ && !broken(RigFault::drive_off);
  if (!drive_sound_ || tick_ - heard_ > kTimeoutTicks) drive_.switch_off();
  if (!broken(RigFault::peer_lost)) {
    to_board_.send(height_.sample(s.height_count, s.age_us, std::isfinite(s.home_height_m)), tick_, bus_);
    if (has_cable_) to_board_.send(cable_.sample(s.cable_count, s.age_us, true), tick_, bus_);
    const double volts = broken(RigFault::supply_high) ? sim_host::kSupplyHighV : sim_host::kSupplyV;
    to_board_.send(supply_.sample(static_cast<float>(volts)), tick_, bus_);
  }
  deliver();
}

bool Devices::hear(const bus::Frame& frame) {
  if (!is_for_drive(frame)) return false;
  to_drive_.send(frame, tick_, bus_);
  deliver();
  return true;
}

void Devices::look_at_bus(const sim_host::SimBoard& rig, bool faults) {
  const auto broken = [&](RigFault fault) { return faults && rig.active(fault); };
  const bool corrupted = broken(RigFault::frame_corrupted);
  // A CAN controller's error counter: 8 for each frame that failed, off at 256 (ISO 11898-1).
  errors_ = corrupted ? errors_ + 8 : 0;
  if (corrupted) send_error_(CAN_ERR_PROT | CAN_ERR_BUSERROR);
  const bool off = broken(RigFault::bus_off) || errors_ >= 256;
  if (off && !off_) send_error_(CAN_ERR_BUSOFF);
  if (!off && off_) send_error_(CAN_ERR_RESTARTED);
  off_ = off;
  bus_.lost = off || corrupted || broken(RigFault::frame_lost);
  bus_.late = broken(RigFault::frame_late);
  bus_.repeated = broken(RigFault::frame_repeated);
  bus_.reordered = broken(RigFault::frame_reordered);
}

void Devices::deliver() {
  for (const bus::Frame& frame : to_board_.receive(tick_)) send_(frame);
  for (const bus::Frame& frame : to_drive_.receive(tick_)) {
    heard_ = tick_;
    if (drive_dead_) continue;
    auto reply = drive_.receive(frame, leg_angle_rad_, shown_torque_nm_);
    if (!drive_sound_) drive_.switch_off();
    if (!reply) continue;
    if (drive_error_) reply->data[7] = 4;
    replies_.send(*reply, tick_, bus_);
    if (doubled_) replies_.send(*second_drive_.receive(frame, kSecondShaftRad, 0.0f), tick_, bus_);
  }
  for (const bus::Frame& frame : replies_.receive(tick_)) send_(frame);
}

}  // namespace furcula::rig
