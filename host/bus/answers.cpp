// What is answered, see answers.hpp.
#include "host/bus/answers.hpp"

#include <algorithm>

namespace furcula::bus {

bool asks(const LogFrame& frame, const NodeMessage* message, const NodeMessage& of, const Message*& by) {
  if (frame.frame.remote) {
    by = nullptr;
    return !frame.error && !frame.frame.extended && frame.frame.id == of.id;
  }
  if (message == nullptr || message->node != of.node || message->message->sender == Sender::node)
    return false;
  by = message->message;
  return true;
}

void AnswerFinder::add(const LogFrame& frame, const NodeMessage* message) {
  if (const Message* by = nullptr; asks(frame, message, *of_, by)) {
    auto asking = std::find_if(asking_.begin(), asking_.end(), [&](const Asking& a) { return a.by == by; });
    if (asking == asking_.end()) asking = asking_.insert(asking_.end(), Asking{by});
    asking->asked_ns = frame.time_ns;
    ++asking->since;
    return;
  }
  if (message != of_) return;
  for (Asking& a : asking_) {
    // One frame asks for one answer. The nearer of both is the cause: what comes sooner behind an answer than before the next one
    // is made of it, by a controller that waits for it.
    const std::int64_t gap_ns = frame.time_ns - a.asked_ns;
    if (a.since == 1 && gap_ns >= 0 && gap_ns <= kLatestAnswerNs &&
        (frames_ == 0 || gap_ns < a.asked_ns - last_ns_)) {
      ++a.answers;
      a.sum_ns += gap_ns;
    }
    a.since = 0;
  }
  ++frames_;
  last_ns_ = frame.time_ns;
}

std::optional<Answer> AnswerFinder::found() const {
  std::optional<Answer> nearest;
  for (const Asking& a : asking_) {
    // Lost frames leave the others as they are: a twentieth, as of a log's rows (host/log/data_quality.hpp).
    if (a.answers == 0 || 20 * a.answers < 19 * frames_) continue;
    const std::int64_t gap_ns = a.sum_ns / static_cast<std::int64_t>(a.answers);
    if (!nearest || gap_ns < nearest->gap_ns) nearest = Answer{of_, a.by, gap_ns};
  }
  return nearest;
}

}  // namespace furcula::bus
