// What any robot's node tells the bus: that it lives, who it is, and its log of faults.
#pragma once

#include <cstdint>

#include "firmware/app/can_frames.hpp"
#include "firmware/store/fault_log.hpp"
#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/node_words.hpp"
#include "furcula/bus/registers.hpp"
#include "furcula/bus/stream.hpp"
#include "furcula/control/fault.hpp"

namespace furcula::firmware {

/// As in the heartbeat's signal State.
using bus::NodeState;

inline void put_code(bus::Frame& frame, const bus::Signal& signal, std::uint32_t raw) {
  static_cast<void>(bus::put_raw(frame, signal, raw));
}
/// One that is not a number is left 0.
inline void put_value(bus::Frame& frame, const bus::Signal& signal, float value) {
  static_cast<void>(bus::put(frame, signal, value));
}
inline bus::Frame versioned(const bus::Message& message, std::uint8_t node) {
  bus::Frame frame = bus::empty_frame(message, node);
  put_code(frame, bus::table::version(), bus::kProtocolVersion);
  return frame;
}
/// `sequence` goes on by one.
inline bus::Frame stamped(const bus::Message& message, std::uint8_t node, std::uint8_t& sequence,
                          float age_s) {
  bus::Frame frame = bus::empty_frame(message, node);
  static_cast<void>(bus::put_stamp(frame, {bus::kProtocolVersion, sequence++, age_s}));
  return frame;
}

class CanPresence {
 public:
  /// `heartbeat_ticks` 0: it says nothing.
  CanPresence(std::uint8_t node, std::uint32_t heartbeat_ticks)
      : node_(node), heartbeat_ticks_(heartbeat_ticks) {}

  /// Who it is, and its log of faults: from now on it tells these too. Keeps pointers.
  void introduce(const bus::Identity& identity, const FaultLog& faults) {
    identity_ = &identity;
    faults_ = &faults;
  }

  /// Adds what there is to say on this tick; mostly nothing.
  void tick(FrameBatch& batch, std::uint32_t tick, NodeState state, control::Fault fault) {
    using namespace bus::message;
    if (heartbeat_ticks_ == 0) return;
    if (tick % heartbeat_ticks_ == 2u * heartbeat_ticks_ / 3u) {
      bus::Frame beat = versioned(kHeartbeat, node_);
      put_code(beat, bus::signal(kHeartbeat, "State"), static_cast<std::uint32_t>(state));
      put_code(beat, bus::table::sequence(), sequence_++);
      put_code(beat, bus::signal(kHeartbeat, "Fault"), static_cast<std::uint32_t>(fault));
      put_code(beat, bus::signal(kHeartbeat, "Uptime"), tick);  // ms
      batch.add(beat);
    }
    if (identity_ != nullptr && tick % heartbeat_ticks_ == heartbeat_ticks_ / 6u)
      batch.add(next_particular());
  }

 private:
  /// One after the other: who it is, the parts of its number, the entries of its log.
  bus::Frame next_particular() {
    using namespace bus::message;
    const std::uint32_t which = particular_;
    particular_ = which == kUniqueIdParts + FaultLog::kEntries ? 0 : which + 1;
    if (which == 0) {
      bus::Frame frame = versioned(kIdentity, node_);
      put_code(frame, bus::signal(kIdentity, "Reset_Cause"),
               static_cast<std::uint32_t>(identity_->reset_cause));
      put_code(frame, bus::signal(kIdentity, "Firmware_Version"), identity_->firmware_version);
      put_code(frame, bus::signal(kIdentity, "Build_Id"), identity_->build_id);
      return frame;
    }
    if (which <= kUniqueIdParts) {
      bus::Frame frame = versioned(kUniqueId, node_);
      put_code(frame, bus::signal(kUniqueId, "Part"), which - 1);
      put_code(frame, bus::signal(kUniqueId, "Bits"), identity_->unique_id[which - 1]);
      return frame;
    }
    const std::uint32_t age = which - 1 - kUniqueIdParts;
    const bus::LoggedFault entry = age < faults_->count() ? faults_->entry(age) : bus::LoggedFault{};
    bus::Frame frame = versioned(kLoggedFault, node_);
    put_code(frame, bus::signal(kLoggedFault, "Entry"), age);
    put_code(frame, bus::signal(kLoggedFault, "Fault"), entry.fault);
    put_code(frame, bus::signal(kLoggedFault, "Start"), entry.starts);
    put_code(frame, bus::signal(kLoggedFault, "Tick"), entry.tick);
    return frame;
  }

  static constexpr std::uint32_t kUniqueIdParts = 3;

  std::uint8_t node_;
  std::uint32_t heartbeat_ticks_;
  const bus::Identity* identity_ = nullptr;
  const FaultLog* faults_ = nullptr;
  std::uint32_t particular_ = 0;
  std::uint8_t sequence_ = 0;
};

}  // namespace furcula::firmware
