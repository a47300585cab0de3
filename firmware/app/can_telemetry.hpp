// What the robot tells the bus of itself: its body, its leg, that it lives, who it is, and its log of faults.
#pragma once

#include <cstdint>

#include "firmware/app/board.hpp"
#include "firmware/app/can_frames.hpp"
#include "firmware/store/fault_log.hpp"
#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/node_words.hpp"
#include "furcula/bus/registers.hpp"
#include "furcula/bus/stream.hpp"

namespace furcula::firmware {

/// As in the heartbeat's signal State.
using bus::NodeState;

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
  explicit CanTelemetry(const CanTelemetryConfig& config) : config_(config), tick_(config.first_tick) {}

  /// Who it is, and its log of faults: from now on it tells these too. Keeps pointers.
  void introduce(const bus::Identity& identity, const FaultLog& faults) {
    identity_ = &identity;
    faults_ = &faults;
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
      bus::Frame beat = versioned(kHeartbeat);
      put_code(beat, bus::signal(kHeartbeat, "State"), static_cast<std::uint32_t>(state));
      put_code(beat, bus::table::sequence(), heartbeat_sequence_++);
      put_code(beat, bus::signal(kHeartbeat, "Fault"), static_cast<std::uint32_t>(out.fault));
      put_code(beat, bus::signal(kHeartbeat, "Uptime"), tick_);  // ms
      batch.add(beat);
    }
    if (identity_ != nullptr && config_.heartbeat_ticks != 0 &&
        tick_ % config_.heartbeat_ticks == config_.heartbeat_ticks / 6u)
      batch.add(next_particular());
    ++tick_;
    return batch;
  }

 private:
  /// One after the other: who it is, the parts of its number, the entries of its log.
  bus::Frame next_particular() {
    using namespace bus::message;
    const std::uint32_t which = particular_;
    particular_ = which == kUniqueIdParts + FaultLog::kEntries ? 0 : which + 1;
    if (which == 0) {
      bus::Frame frame = versioned(kIdentity);
      put_code(frame, bus::signal(kIdentity, "Reset_Cause"),
               static_cast<std::uint32_t>(identity_->reset_cause));
      put_code(frame, bus::signal(kIdentity, "Firmware_Version"), identity_->firmware_version);
      put_code(frame, bus::signal(kIdentity, "Build_Id"), identity_->build_id);
      return frame;
    }
    if (which <= kUniqueIdParts) {
      bus::Frame frame = versioned(kUniqueId);
      put_code(frame, bus::signal(kUniqueId, "Part"), which - 1);
      put_code(frame, bus::signal(kUniqueId, "Bits"), identity_->unique_id[which - 1]);
      return frame;
    }
    const std::uint32_t age = which - 1 - kUniqueIdParts;
    const bus::LoggedFault entry = age < faults_->count() ? faults_->entry(age) : bus::LoggedFault{};
    bus::Frame frame = versioned(kLoggedFault);
    put_code(frame, bus::signal(kLoggedFault, "Entry"), age);
    put_code(frame, bus::signal(kLoggedFault, "Fault"), entry.fault);
    put_code(frame, bus::signal(kLoggedFault, "Start"), entry.starts);
    put_code(frame, bus::signal(kLoggedFault, "Tick"), entry.tick);
    return frame;
  }
  bus::Frame versioned(const bus::Message& message) const {
    bus::Frame frame = bus::empty_frame(message, config_.node);
    put_code(frame, bus::table::version(), bus::kProtocolVersion);
    return frame;
  }

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

  static constexpr std::uint32_t kUniqueIdParts = 3;

  CanTelemetryConfig config_;
  const bus::Identity* identity_ = nullptr;
  const FaultLog* faults_ = nullptr;
  std::uint32_t particular_ = 0;
  std::uint32_t tick_;
  std::uint8_t body_sequence_ = 0, leg_sequence_ = 0, heartbeat_sequence_ = 0;
};

}  // namespace furcula::firmware
