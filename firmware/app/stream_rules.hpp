// When a stream of commands may start a robot and when it no longer keeps it running, for any robot: an edge, a let-go, a silence.
#pragma once

#include <cstdint>

#include "furcula/bus/node_words.hpp"

namespace furcula::firmware {

// In ticks, that is, ms.
inline constexpr std::uint32_t kStreamTicks = 100;     ///< a silent stream of commands stops what it started
inline constexpr std::uint32_t kLetGoTicks = 100;      ///< without a hop: a stream may start the robot again
inline constexpr std::uint32_t kStopHoldsTicks = 100;  ///< after a stop beside the stream nothing starts

/// A stream's request and what it wants the torque and the clutch to be (bus/messages.hpp, Command).
struct StreamCommand {
  bus::Request request = bus::Request::none;
  float torque_amplitude_nm = 0.0f;
  float torque_period_s = 0.3f;
  bool release_in_flight = false;
  bool follows = true;  ///< no command of the stream was lost before it
};

class StreamRules {
 public:
  /// Of one command.
  struct Edge {
    bool changed = false;  ///< it asks for something else than the one before it
    bool starts = false;   ///< a hop that may start the robot
  };

  /// Once a tick.
  void tick() {
    if (age_ticks_ != 0xffffffffu) ++age_ticks_;
    if (hop_age_ticks_ <= kLetGoTicks) ++hop_age_ticks_;
    if (stop_holds_ticks_ != 0) --stop_holds_ticks_;
  }

  /// One command of a stream, fresh as bus/stream.hpp judges it. Its request counts where it changes; `hop` starts if nobody
  /// has said hop for kLetGoTicks and the command before it, of which none is missing, said something else: two streams that
  /// are mixed start nothing.
  Edge hear(bus::Request request, bool follows) {
    Edge edge;
    edge.changed = !silent() && request != request_;
    edge.starts = edge.changed && follows && hop_age_ticks_ > kLetGoTicks;
    request_ = request;
    age_ticks_ = 0;
    if (request == bus::Request::hop) hop_age_ticks_ = 0;
    return edge;
  }

  /// Somebody said stop. At least to the end of this tick: a hop that came together with a stop starts nothing. `holds`: nor
  /// does one for kStopHoldsTicks.
  void hold(bool holds) {
    const std::uint32_t ticks = holds ? kStopHoldsTicks + 1 : 1;
    if (ticks > stop_holds_ticks_) stop_holds_ticks_ = ticks;
  }
  bool held() const { return stop_holds_ticks_ != 0; }
  /// Somebody said hop, in a command that counts or in one that does not.
  void note_hop_said() { hop_age_ticks_ = 0; }
  bool silent() const { return age_ticks_ > kStreamTicks; }

 private:
  bus::Request request_ = bus::Request::none;
  std::uint32_t age_ticks_ = 0xffffffffu;
  std::uint32_t hop_age_ticks_ = kLetGoTicks + 1, stop_holds_ticks_ = 0;
};

}  // namespace furcula::firmware
