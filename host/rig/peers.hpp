// The robot's devices as the bus sees them: a drive with the mini-cheetah's packing, and two encoder nodes.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "furcula/bus/frame.hpp"
#include "furcula/bus/motors.hpp"
#include "furcula/control/sample.hpp"

namespace furcula::rig {

inline constexpr bus::Motor kMotor = bus::Motor::ak80_9;
inline constexpr std::uint8_t kDriveNode = 1, kHeightNode = 1, kCableNode = 2, kSupplyNode = 3,
                              kBoardNode = 1;

/// Whether the drive answers such a frame.
bool is_for_drive(const bus::Frame& frame);
/// Whether it tells the drive to switch off.
bool is_switch_off(const bus::Frame& frame);

class Drive {
 public:
  /// A frame of the bus. @returns the reply, where the frame is one that this drive answers. `angle_rad` and
  /// `torque_nm` are what it measures.
  std::optional<bus::Frame> receive(const bus::Frame& frame, float angle_rad, float torque_nm);

  /// What its replies say besides; and of which motor it is.
  void show(float velocity_radps, std::uint8_t temperature_c) {
    velocity_radps_ = velocity_radps;
    temperature_c_ = temperature_c;
  }
  void set_motor(bus::Motor motor) { motor_ = motor; }

  bool on() const { return on_; }
  void switch_off() { on_ = false; }
  /// 0 while it is off.
  float torque_nm() const { return on_ ? torque_nm_ : 0.0f; }
  /// Empty, or what about its commands is not as agreed.
  const std::string& complaint() const { return complaint_; }

 private:
  bus::Motor motor_ = kMotor;
  bool on_ = false;
  float torque_nm_ = 0.0f, velocity_radps_ = 0.0f;
  std::uint8_t temperature_c_ = 25;
  std::string complaint_;
};

class EncoderNode {
 public:
  explicit EncoderNode(std::uint8_t node) : node_(node) {}

  /// The next reading. `homed` false: it says that it is not.
  bus::Frame sample(std::uint32_t count, std::uint32_t age_us, bool homed);

 private:
  std::uint8_t node_;
  std::uint8_t sequence_ = 0;
};

/// Measures the drive's supply.
class SupplyNode {
 public:
  bus::Frame sample(float volts);

 private:
  std::uint8_t sequence_ = 0;
};

/// The host that tells the robot to stop or to hop.
class Host {
 public:
  enum class Request : std::uint8_t { stop = 1, hop = 2 };
  bus::Frame command(Request request, float amplitude_nm, float period_s, bool release);

 private:
  std::uint8_t sequence_ = 0;
};

/// What the board tells of itself.
struct BoardWords {
  bool heard = false;
  std::uint32_t state = 0;  ///< of its heartbeat
  std::uint32_t fault = 0;
  void receive(const bus::Frame& frame);
};

}  // namespace furcula::rig
