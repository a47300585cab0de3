// A motor's drive at the other end of a CAN bus, with the mini-cheetah's packing.
#pragma once

#include <cstdint>
#include <optional>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/motor_frames.hpp"

namespace furcula::sim_host {

/// Answers each frame with its angle. Gives the torque of the last command for kTimeoutTicks at most: a drive
/// must be configured so that it stops when its commands stop.
class CanDrive {
 public:
  static constexpr std::uint32_t kTimeoutTicks = 5;
  enum class State : std::uint8_t { sound, dead, error, off };

  /// What is wrong with a drive that works.
  struct InjectedErrors {
    double temperature_c = 40.0;
    double offset_nm = 0.0;  ///< added to what it is told, and shown by its current
  };

  CanDrive(bus::Motor motor, std::uint8_t node) : motor_(motor), node_(node) {}

  void set_motor(bus::Motor motor) { motor_ = motor; }
  void set_injected_errors(const InjectedErrors& injected_errors) { injected_errors_ = injected_errors; }

  /// `angle_rad` is that of its shaft now.
  void tick(std::uint32_t tick, State state, double angle_rad) {
    velocity_radps_ = 1e3 * (angle_rad - last_angle_rad_);
    if (tick_ == 0) velocity_radps_ = 0.0;
    last_angle_rad_ = angle_rad;
    state_ = state;
    tick_ = tick;
    if (state_ != State::sound || tick_ - heard_ > kTimeoutTicks) switch_off();
  }

  /// A frame for it, and what it answers. `angle_rad` is that of its shaft.
  std::optional<bus::Frame> receive(const bus::Frame& frame, double angle_rad) {
    if (state_ == State::dead) return std::nullopt;
    const float before_nm = torque_nm();
    if (bus::is(frame, bus::message::kMotorEnter, node_)) {
      on_ = state_ == State::sound;
    } else if (bus::is(frame, bus::message::kMotorExit, node_)) {
      switch_off();
    } else if (bus::is(frame, bus::message::kMotorCommand, node_)) {
      const bus::Signal torque =
          bus::with_range(bus::signal(bus::message::kMotorCommand, "Torque"), bus::info(motor_));
      if (on_) torque_nm_ = bus::get(frame, torque).value();
    } else {
      return std::nullopt;
    }
    heard_ = tick_;
    return reply(angle_rad, before_nm);
  }

  float torque_nm() const { return on_ ? torque_nm_ + static_cast<float>(injected_errors_.offset_nm) : 0.0f; }

 private:
  void switch_off() {
    on_ = false;
    torque_nm_ = 0.0f;
  }

  bus::Frame reply(double angle_rad, float torque_nm) const {
    bus::Frame frame = bus::empty_frame(bus::message::kMotorReply, node_);
    const auto put = [&](const bus::Signal& signal, double value) {
      static_cast<void>(
          bus::put(frame, bus::with_range(signal, bus::info(motor_)), static_cast<float>(value)));
    };
    using bus::message::kMotorReply;
    put(bus::signal(kMotorReply, "Position"), angle_rad);
    put(bus::signal(kMotorReply, "Velocity"), velocity_radps_);
    put(bus::signal(kMotorReply, "Torque"), static_cast<double>(torque_nm));
    put(bus::signal(kMotorReply, "Temperature"), injected_errors_.temperature_c);
    put(bus::signal(kMotorReply, "Error"), state_ == State::error ? kError : 0.0);
    return frame;
  }

  static constexpr double kError = 4.0;

  bus::Motor motor_;
  std::uint8_t node_;
  State state_ = State::sound;
  std::uint32_t tick_ = 0, heard_ = 0;
  bool on_ = false;
  float torque_nm_ = 0.0f;
  InjectedErrors injected_errors_;
  double last_angle_rad_ = 0.0, velocity_radps_ = 0.0;
};

}  // namespace furcula::sim_host
