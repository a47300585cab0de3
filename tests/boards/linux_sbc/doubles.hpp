// What stands in the place of bus and lines in tests: they keep what they were told and give what they are
// set to.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "boards/linux_sbc/board.hpp"

namespace furcula::test {

class QuietBus {
 public:
  std::span<const socketcan::Received> receive() {
    const std::span<const socketcan::Received> all(incoming.data(), count);
    count = 0;
    return all;
  }
  bool send(std::span<const bus::Frame> frames) {
    for (const bus::Frame& f : frames) sent[next++ % sent.size()] = f;
    return takes;
  }
  socketcan::CanState state() const { return watch.state(); }
  std::uint64_t times_off() const { return watch.times_off(); }
  const socketcan::CanCounters& counters() const { return counters_; }

  void arrive(const bus::Frame& frame, std::int64_t age_ns = 0) { incoming[count++] = {frame, age_ns}; }
  /// The newest.
  const bus::Frame& last() const { return sent[(next + sent.size() - 1) % sent.size()]; }

  std::array<socketcan::Received, 8> incoming{};
  std::size_t count = 0;
  std::array<bus::Frame, 64> sent{};
  std::size_t next = 0;
  bool takes = true;
  socketcan::LinkWatch watch;

 private:
  socketcan::CanCounters counters_;
};

class QuietLines {
 public:
  linux_sbc::SwitchReading read_switch() { return reading; }
  bool set_solenoid(bool on) {
    solenoid = on;
    on_ticks += on ? 1 : 0;
    return true;
  }

  linux_sbc::SwitchReading reading;
  bool solenoid = false;
  std::size_t on_ticks = 0;
};

/// Time that goes on by a tick when one is waited for: no load of the machine makes a sample old.
class QuietTicks {
 public:
  explicit QuietTicks(std::int64_t period_ns) : period_ns_(period_ns) {}
  void start() {}
  std::int64_t wait() {
    woke_ns_ += period_ns_;
    return 0;
  }
  static std::int64_t now_ns() { return 0; }
  std::int64_t woke_ns() const { return woke_ns_; }
  std::uint64_t overruns() const { return 0; }

 private:
  std::int64_t period_ns_, woke_ns_ = 1'000'000'000;
};

using QuietBoard = linux_sbc::LinuxBoard<QuietBus, QuietLines, QuietTicks>;
/// For tests with threads of their own, which go on in the meantime.
using QuietBoardInTime = linux_sbc::LinuxBoard<QuietBus, QuietLines>;
static_assert(firmware::Board<QuietBoard>);

}  // namespace furcula::test
