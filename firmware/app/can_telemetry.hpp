// What the robot tells the bus of itself: its body, its leg, that it lives, who it is, and its log of faults.
#pragma once

#include <cstdint>

#include "firmware/app/board.hpp"
#include "firmware/app/can_frames.hpp"
#include "firmware/app/can_presence.hpp"
#include "firmware/store/fault_log.hpp"
#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/node_words.hpp"
#include "furcula/bus/registers.hpp"
#include "furcula/bus/stream.hpp"

namespace furcula::firmware {

struct CanTelemetryConfig {
  std::uint8_t node = 1;
  std::uint32_t period_ticks = 100;  ///< of Body_State and Leg_State
  std::uint32_t heartbeat_ticks =
      100;                       ///< bus/stream.hpp holds a node silent for as long for one that is lost
  std::uint32_t first_tick = 0;  ///< its number; they wrap after 49.7 days, and some frames then come earlier
};

/// Every now and then some frames.
class CanTelemetry {
 public:
  explicit CanTelemetry(const CanTelemetryConfig& config)
      : config_(config), presence_(config.node, config.heartbeat_ticks), tick_(config.first_tick) {}

  /// Who it is, and its log of faults: from now on it tells these too. Keeps pointers.
  void introduce(const bus::Identity& identity, const FaultLog& faults) {
    presence_.introduce(identity, faults);
  }

  /// To be called once a tick; mostly there is nothing to send. `sample` is that of the tick. A value that is
  /// not a number is left 0, and stands in for no measurement: the fault beside it tells.
  FrameBatch tick(const Telemetry& telemetry, const control::Sample& sample, NodeState state) {
    using namespace bus::message;
    FrameBatch batch;
    const control::Outputs& out = telemetry.outputs;
    const float age_s = static_cast<float>(sample.age_us) * 1e-6f;
    // Body, leg and heartbeat on different ticks, so that the bus has room for them.
    if (config_.period_ticks != 0 && tick_ % config_.period_ticks == 0) {
      bus::Frame body = stamped(kBodyState, config_.node, body_sequence_, age_s);
      put_code(body, bus::signal(kBodyState, "Phase"), static_cast<std::uint32_t>(out.phase.phase));
      put_code(body, bus::signal(kBodyState, "Fault"), static_cast<std::uint32_t>(out.fault));
      put_value(body, bus::signal(kBodyState, "Height"), out.height.height_m);
      put_value(body, bus::signal(kBodyState, "Velocity"), out.height.velocity_mps);
      batch.add(body);
    }
    if (config_.period_ticks != 0 && tick_ % config_.period_ticks == config_.period_ticks / 3) {
      bus::Frame leg = stamped(kLegState, config_.node, leg_sequence_, age_s);
      put_code(leg, bus::signal(kLegState, "Contact"), sample.contact != 0 ? 1 : 0);
      put_code(leg, bus::signal(kLegState, "Solenoid"), out.command.coil_duty > 0.0f ? 1 : 0);
      put_value(leg, bus::signal(kLegState, "Leg_Angle"), sample.leg_angle_rad);
      put_value(leg, bus::signal(kLegState, "Torque"), out.command.torque_nm);
      batch.add(leg);
    }
    presence_.tick(batch, tick_, state, out.fault);
    ++tick_;
    return batch;
  }

 private:
  CanTelemetryConfig config_;
  CanPresence presence_;
  std::uint32_t tick_;
  std::uint8_t body_sequence_ = 0, leg_sequence_ = 0;
};

}  // namespace furcula::firmware
