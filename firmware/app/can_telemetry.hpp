// What the robot tells the bus of itself: its body, its leg and that it lives.
#pragma once

#include <cstdint>

#include "firmware/app/board.hpp"
#include "firmware/app/can_frames.hpp"
#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/node_words.hpp"
#include "furcula/bus/stream.hpp"

namespace furcula::firmware {

/// As in the heartbeat's signal State.
using bus::NodeState;

struct CanTelemetryConfig {
  std::uint8_t node = 1;
  std::uint32_t period_ticks = 100;  ///< of Body_State and Leg_State
  std::uint32_t heartbeat_ticks =
      100;  ///< bus/stream.hpp holds a node silent for as long for one that is lost
};

/// Every now and then some frames.
class CanTelemetry {
 public:
  explicit CanTelemetry(const CanTelemetryConfig& config) : config_(config) {}

  /// To be called once a tick; mostly there is nothing to send. `sample` is that of the tick. A value that is
  /// not a number is left 0, and stands in for no measurement: the fault beside it tells.
  FrameBatch tick(const Telemetry& telemetry, const control::Sample& sample, NodeState state) {
    using namespace bus::message;
    FrameBatch batch;
    const control::Outputs& out = telemetry.outputs;
    const float age_s = static_cast<float>(sample.age_us) * 1e-6f;
    // Body, leg and heartbeat on different ticks, so that the bus has room for them.
    if (config_.period_ticks != 0 && tick_ % config_.period_ticks == 0) {
      bus::Frame body = stamped(kBodyState, body_sequence_, age_s);
      put_code(body, bus::signal(kBodyState, "Phase"), static_cast<std::uint32_t>(out.phase.phase));
      put_code(body, bus::signal(kBodyState, "Fault"), static_cast<std::uint32_t>(out.fault));
      put_value(body, bus::signal(kBodyState, "Height"), out.height.height_m);
      put_value(body, bus::signal(kBodyState, "Velocity"), out.height.velocity_mps);
      batch.add(body);
    }
    if (config_.period_ticks != 0 && tick_ % config_.period_ticks == config_.period_ticks / 3) {
      bus::Frame leg = stamped(kLegState, leg_sequence_, age_s);
      put_code(leg, bus::signal(kLegState, "Contact"), sample.contact != 0 ? 1 : 0);
      put_code(leg, bus::signal(kLegState, "Solenoid"), out.command.coil_duty > 0.0f ? 1 : 0);
      put_value(leg, bus::signal(kLegState, "Leg_Angle"), sample.leg_angle_rad);
      put_value(leg, bus::signal(kLegState, "Torque"), out.command.torque_nm);
      batch.add(leg);
    }
    if (config_.heartbeat_ticks != 0 &&
        tick_ % config_.heartbeat_ticks == 2u * config_.heartbeat_ticks / 3u) {
      bus::Frame beat = bus::empty_frame(kHeartbeat, config_.node);
      put_code(beat, bus::table::version(), bus::kProtocolVersion);
      put_code(beat, bus::signal(kHeartbeat, "State"), static_cast<std::uint32_t>(state));
      put_code(beat, bus::table::sequence(), heartbeat_sequence_++);
      put_code(beat, bus::signal(kHeartbeat, "Fault"), static_cast<std::uint32_t>(out.fault));
      put_code(beat, bus::signal(kHeartbeat, "Uptime"), tick_);  // ms
      batch.add(beat);
    }
    ++tick_;
    return batch;
  }

 private:
  static void put_code(bus::Frame& frame, const bus::Signal& signal, std::uint32_t raw) {
    static_cast<void>(bus::put_raw(frame, signal, raw));
  }
  static void put_value(bus::Frame& frame, const bus::Signal& signal, float value) {
    static_cast<void>(bus::put(frame, signal, value));
  }
  bus::Frame stamped(const bus::Message& message, std::uint8_t& sequence, float age_s) const {
    bus::Frame frame = bus::empty_frame(message, config_.node);
    static_cast<void>(bus::put_stamp(frame, {bus::kProtocolVersion, sequence++, age_s}));
    return frame;
  }

  CanTelemetryConfig config_;
  std::uint32_t tick_ = 0;
  std::uint8_t body_sequence_ = 0, leg_sequence_ = 0, heartbeat_sequence_ = 0;
};

}  // namespace furcula::firmware
