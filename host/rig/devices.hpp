// The rig's devices at their end of the bus, and what may be wrong with them and with the frames on the way.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

#include "boards/sim_host/board.hpp"
#include "boards/sim_host/can_bus.hpp"
#include "host/rig/peers.hpp"

namespace furcula::rig {

/// Drive, encoder nodes and that of the supply. Frames that are lost, late, repeated or reordered are so between the board and
/// them, either way; the host's are not. What a CAN controller would tell of it the board gets as the
/// kernel's error frames.
class Devices {
 public:
  /// A drive that hears nothing for longer switches off: its own watchdog.
  static constexpr std::uint32_t kTimeoutTicks = 5;

  /// How the board gets a frame, and an error frame (a sum of classes of linux/can/error.h).
  using Send = std::function<void(const bus::Frame&)>;
  using SendError = std::function<void(std::uint32_t)>;

  Devices(Send send, SendError send_error, bool has_cable)
      : send_(std::move(send)), send_error_(std::move(send_error)), has_cable_(has_cable) {}

  /// A tick of the rig begins: the encoders send. `faults`: whether those that the board's rig has count.
  void begin_tick(const sim_host::SimBoard& rig, bool faults);
  /// A frame of the board. @returns whether it is one for the drive, which may not hear it.
  bool hear(const bus::Frame& frame);

  const Drive& drive() const { return drive_; }
  /// What the drive gives.
  float torque_nm() const { return drive_.on() ? drive_.torque_nm() + offset_nm_ : 0.0f; }
  /// What its current says that it gives, from now on.
  void show_torque(float torque_nm) { shown_torque_nm_ = torque_nm; }

 private:
  void look_at_bus(const sim_host::SimBoard& rig, bool faults);
  /// What has come over the bus by now.
  void deliver();

  Send send_;
  SendError send_error_;
  bool has_cable_;
  Drive drive_, second_drive_;  ///< the second has the node id of the first, where that is broken
  EncoderNode height_{kHeightNode}, cable_{kCableNode};
  SupplyNode supply_;
  sim_host::CanWay to_board_, to_drive_, replies_;
  sim_host::CanWay::Faults bus_;
  bool off_ = false, drive_sound_ = true, drive_dead_ = false, drive_error_ = false, doubled_ = false;
  static constexpr float kSecondShaftRad = 1.0f;  ///< where another robot's leg stands
  std::uint32_t tick_ = 0, heard_ = 0, errors_ = 0;
  float leg_angle_rad_ = 0.0f, offset_nm_ = 0.0f, shown_torque_nm_ = 0.0f;
};

}  // namespace furcula::rig
