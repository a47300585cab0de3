// Whether what a node measures comes as the answer to a frame that it was sent: it was then measured when it was asked.
//
// Told by the order and the stamps of the frames alone. A frame that comes at times of its own was measured when it was sent.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "host/bus/candump.hpp"
#include "host/bus/nodes.hpp"

namespace furcula::bus {

/// The frames of a message answer those of another one.
struct Answer {
  const NodeMessage* of;
  const Message* asked_by;  ///< to the same node; nullptr: remote frames with the message's id
  std::int64_t gap_ns;      ///< mean, from a frame that asks to its answer
};

// An answer waits for the drive's control tick (10 kHz and more) and for frames that were there before: at 1 Mbit/s one of 8 bytes
// takes 0.13 ms at most, so that six drives have answered within this.
inline constexpr std::int64_t kLatestAnswerNs = 1'000'000;

/// The message that a frame asks `of` by, if it is one to its node. @returns whether it is.
bool asks(const LogFrame& frame, const NodeMessage* message, const NodeMessage& of, const Message*& by);

/// Takes all frames of a recording, and finds what a message answers.
class AnswerFinder {
 public:
  explicit AnswerFinder(const NodeMessage& of) : of_(&of) {}
  /// `message`: what the frame is; nullptr: none of the bus.
  void add(const LogFrame& frame, const NodeMessage* message);
  std::optional<Answer> found() const;
  const NodeMessage& of() const { return *of_; }

 private:
  struct Asking {
    const Message* by;
    std::int64_t asked_ns = 0, sum_ns = 0;
    std::uint64_t since = 0;  ///< frames that asked since the last answer
    std::uint64_t answers = 0;
  };
  const NodeMessage* of_;
  std::vector<Asking> asking_;
  std::uint64_t frames_ = 0;
  std::int64_t last_ns_ = 0;
};

}  // namespace furcula::bus
