// Sources on a bus: when one was last heard, how a frame of its stream is judged and counted, an encoder's readings.
#pragma once

#include <cstdint>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/bus/stream.hpp"
#include "furcula/core/count.hpp"
#include "furcula/core/status.hpp"

namespace furcula::firmware {

/// Everything that a bus did to the robot, counted since the start.
struct CanStatistics {
  std::uint32_t received = 0;       ///< frames, ours or not
  std::uint32_t foreign = 0;        ///< of none of the robot's nodes
  std::uint32_t malformed = 0;      ///< a node's id with another length, or a value that the table has not
  std::uint32_t lost = 0;           ///< told by a gap in the sequence numbers
  std::uint32_t repeated = 0;       ///< a sequence number again; a second reply to one command
  std::uint32_t out_of_order = 0;   ///< a sequence number from before
  std::uint32_t stale = 0;          ///< the content was too old when it came
  std::uint32_t other_version = 0;  ///< of the protocol
  std::uint32_t unanswered = 0;     ///< commands that the drive did not reply to
  std::uint32_t drive_errors = 0;   ///< replies with an error
  std::uint32_t error_frames = 0;   ///< the CAN controller's
  std::uint32_t bus_off = 0;        ///< times that the CAN controller went off the bus
  std::uint32_t own_ids = 0;        ///< frames of others with ids that this node alone sends
  std::uint32_t stops_apart = 0;    ///< command frames that say stop and were no next one of a stream
};

/// Nothing heard for so long counts as never heard: the clock wraps.
inline constexpr std::uint32_t kForgottenUs = 1000000;

/// An instant on a clock that wraps.
struct LastHeard {
  bool heard = false;
  std::uint32_t at_us = 0;

  void note(std::uint32_t now_us) {
    heard = true;
    at_us = now_us;
  }
  /// kForgottenUs where it was never heard. To be asked once a second at least.
  std::uint32_t age_us(std::uint32_t now_us) {
    if (heard && now_us - at_us >= kForgottenUs) heard = false;
    return heard ? now_us - at_us : kForgottenUs;
  }
};

/// Judges a frame of a stream and counts it. @returns its stamp where it is to be used.
inline Result<bus::Stamp> judge(bus::Stream& stream, const bus::StreamLimits& limits, const bus::Frame& frame,
                                std::uint32_t since_last_us, CanStatistics& statistics) {
  const Result<bus::Stamp> stamp = bus::get_stamp(frame);
  if (!stamp.ok()) {
    ++statistics.malformed;
    return Status::invalid;
  }
  const std::uint32_t lost_before = stream.lost;
  const bus::Arrival arrival =
      bus::arrive(stream, limits, stamp.value(), static_cast<float>(since_last_us) * 1e-6f);
  statistics.lost += stream.lost - lost_before;
  switch (arrival) {
    case bus::Arrival::fresh:
    case bus::Arrival::after_gap:
      return stamp;
    case bus::Arrival::repeated:
      ++statistics.repeated;
      break;
    case bus::Arrival::out_of_order:
      ++statistics.out_of_order;
      break;
    case bus::Arrival::stale:
      ++statistics.stale;
      break;
    case bus::Arrival::other_version:
      ++statistics.other_version;
      break;
  }
  return Status::invalid;
}

/// An encoder at the other end of the bus.
class CanEncoder {
 public:
  void receive(const bus::Frame& frame, std::uint32_t now_us, CanStatistics& statistics);
  bool good() const { return status_ == 0; }
  bool homed() const { return status_ != 1; }
  std::uint32_t count() const { return count_; }
  /// Of the newest reading: as stated, and what has passed since.
  std::uint32_t age_us(std::uint32_t now_us) { return read_.age_us(now_us) + stated_us_; }
  /// Since its last frame, whatever was in it.
  std::uint32_t silence_us(std::uint32_t now_us) { return heard_.age_us(now_us); }
  /// Instead of asking for its ages, once a second at least.
  void let_pass(std::uint32_t now_us) {
    static_cast<void>(heard_.age_us(now_us));
    static_cast<void>(read_.age_us(now_us));
  }

 private:
  LastHeard heard_, read_;
  bus::Stream stream_;
  std::uint32_t count_ = 0, stated_us_ = 0;
  std::uint8_t status_ = 0;
};

inline void CanEncoder::receive(const bus::Frame& frame, std::uint32_t now_us, CanStatistics& statistics) {
  using bus::message::kEncoderSample;
  const std::uint32_t since_us = heard_.age_us(now_us);
  const Result<std::uint32_t> status = bus::get_raw(frame, bus::signal(kEncoderSample, "Status"));
  const Result<std::uint32_t> count = bus::get_raw(frame, bus::signal(kEncoderSample, "Count"));
  if (!status.ok() || !count.ok() || status.value() > 2) {
    ++statistics.malformed;
    return;
  }
  heard_.note(now_us);
  const Result<bus::Stamp> stamp = judge(stream_, bus::StreamLimits{}, frame, since_us, statistics);
  if (!stamp.ok()) return;
  status_ = static_cast<std::uint8_t>(status.value());
  if (status_ == 2) return;  // no signal: the last reading grows old
  read_.note(now_us);
  count_ = count.value();
  stated_us_ = nearest_count(stamp.value().age_s * 1e6f);
}

}  // namespace furcula::firmware
