// A stream of this project's own messages as its receiver sees it: which one is fresh, and what was lost.
#pragma once

#include <cstdint>

#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "furcula/core/status.hpp"

namespace furcula::bus {

/// The three signals that begin every own message but the heartbeat.
struct Stamp {
  std::uint8_t version = kProtocolVersion;  ///< of the protocol
  std::uint8_t sequence = 0;                ///< one more in each message of the stream; wraps at 256
  float age_s = 0.0f;  ///< of the content when it was sent; 0.0255: older than can be told
};

/// Greatest age that can be sent, s; it means "this old or older".
inline constexpr float kOldestAge = 0.0255f;

/// `invalid`: an age that is not a number, or a frame too short. An age below 0 is 0.
constexpr Status put_stamp(Frame& frame, const Stamp& stamp) {
  if (put(frame, table::age(), stamp.age_s) == Put::refused) return Status::invalid;
  if (put_raw(frame, table::version(), stamp.version) != Status::ok) return Status::invalid;
  return put_raw(frame, table::sequence(), stamp.sequence);
}

/// `invalid`: a frame too short.
constexpr Result<Stamp> get_stamp(const Frame& frame) {
  const Result<float> age_s = get(frame, table::age());
  if (!age_s.ok()) return age_s.status();
  return Stamp{static_cast<std::uint8_t>(get_raw(frame, table::version()).value()),
               static_cast<std::uint8_t>(get_raw(frame, table::sequence()).value()), age_s.value()};
}

/// What arrive() finds of a message.
enum class Arrival : std::uint8_t {
  fresh,          ///< use it
  after_gap,      ///< use it; messages before it were lost
  repeated,       ///< the last one again
  out_of_order,   ///< older than the last one
  stale,          ///< the next one, but its content is too old
  other_version,  ///< of another protocol version: nothing in it is known
};
/// Whether the message's content may be used.
constexpr bool usable(Arrival arrival) { return arrival == Arrival::fresh || arrival == Arrival::after_gap; }

/// Limits by which arrive() judges a message.
struct StreamLimits {
  float oldest_s = 0.005f;   ///< content older than this is stale; kOldestAge and more is so in any case
  float silence_s = 0.100f;  ///< after a silence this long the sender counts as started anew
};

/// State of the receiver of one stream.
struct Stream {
  bool begun = false;         ///< a message of this protocol version has arrived
  std::uint8_t sequence = 0;  ///< of the newest
  std::uint32_t lost = 0;     ///< messages that never came, or came out of order
};

/// Judges a message that arrived `since_last_s` after the one before it, whatever that one was; `transit_s`
/// is what the receiver adds to the age, as for the time that it lay in a queue.
constexpr Arrival arrive(Stream& stream, const StreamLimits& limits, const Stamp& stamp, float since_last_s,
                         float transit_s = 0.0f) {
  if (stamp.version != kProtocolVersion) return Arrival::other_version;
  const bool anew = !stream.begun || !(since_last_s < limits.silence_s);
  // Sequence numbers wrap: less than half of their range ahead is ahead.
  const auto ahead = static_cast<std::int8_t>(static_cast<std::uint8_t>(stamp.sequence - stream.sequence));
  if (!anew && ahead == 0) return Arrival::repeated;
  if (!anew && ahead < 0) return Arrival::out_of_order;
  const bool gap = !anew && ahead > 1;
  if (gap) stream.lost += static_cast<std::uint32_t>(ahead - 1);
  stream.begun = true;
  stream.sequence = stamp.sequence;
  const float age_s = stamp.age_s + transit_s;
  // Half a step below the oldest age that can be sent: that one means "older".
  if (!(age_s <= limits.oldest_s) || stamp.age_s > kOldestAge - 0.00005f) return Arrival::stale;
  return gap ? Arrival::after_gap : Arrival::fresh;
}

}  // namespace furcula::bus
