// The simulated walker's devices as its buses see them (docs/bus.md): a drive a joint, a node with IMU, feet and pins.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "furcula/bus/frame.hpp"
#include "furcula/bus/message.hpp"
#include "host/walk/walker_rig.hpp"

namespace furcula::walk {

/// Of the left leg, the right one, the body.
inline constexpr std::size_t kWalkerBodyBus = 2;

class WalkerDevices {
 public:
  /// Drives answer when they are asked, whatever `two_buses` says.
  explicit WalkerDevices(const WalkerRigConfig& config);

  /// A tick begins: what the body's node sends by itself.
  std::vector<bus::Frame> speak();
  /// A frame that the board sent. @returns what the drive that it is for replies.
  std::optional<bus::Frame> hear(std::size_t bus, const bus::Frame& frame);
  /// The tick ends, under what drives and pins were told.
  void advance();

  const WalkerRig& rig() const { return rig_; }
  const control::WalkerOutputs& told() const { return told_; }
  /// Whether the motor of joint `i` is on.
  bool on(std::size_t i) const { return drives_[i].on; }
  /// From now on the body's samples are so old when they are sent.
  void set_age(float age_s) { age_s_ = age_s; }

 private:
  struct Drive {
    bool on = false;
    control::JointCommand told;
    std::uint32_t silent_ticks = 0;  ///< since a frame for it; its watchdog switches it off
  };
  bus::Frame stamped(const bus::Message& message, std::uint8_t sequence) const;
  bus::Frame reply(std::size_t i) const;

  WalkerRig rig_;
  control::WalkerSample sample_;  ///< of this tick
  std::array<Drive, control::kWalkerJoints> drives_;
  control::WalkerOutputs told_;
  float age_s_ = 0.0f;
  std::uint8_t sequence_ = 0;
};

}  // namespace furcula::walk
