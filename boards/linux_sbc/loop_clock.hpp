// The clock of the loop's thread, of any robot: its ticks, how late they began and how long they took.
#pragma once

#include <atomic>
#include <cstdint>

#include "boards/linux_sbc/figures.hpp"

namespace furcula::linux_sbc {

/// `Ticks` is core::Timer, or what a test puts in its place.
template <class Ticks>
class LoopClock {
 public:
  LoopClock(const std::atomic<bool>& stop, LoopFigures& figures) : stop_(stop), figures_(figures) {}

  /// Until the next tick is due.
  void wait() {
    if (!started_) {
      timer_.start();
      started_ = true;
    } else {
      figures_.work.add(Ticks::now_ns() - timer_.woke_ns());
    }
    figures_.lateness.add(timer_.wait());
    figures_.overruns.store(timer_.overruns(), std::memory_order_relaxed);
    now_us_ = static_cast<std::uint32_t>(timer_.woke_ns() / 1000);
  }
  bool goes_on() const { return !stop_.load(std::memory_order_relaxed); }
  std::uint32_t now_us() const { return now_us_; }
  /// The service manager's watchdog follows this count (daemon.cpp); drives have their own, which act when frames stop.
  void kick_watchdog() { figures_.ticks.fetch_add(1, std::memory_order_relaxed); }

 private:
  static constexpr std::int64_t kPeriodNs = 1'000'000;

  const std::atomic<bool>& stop_;
  LoopFigures& figures_;
  Ticks timer_{kPeriodNs};
  bool started_ = false;
  std::uint32_t now_us_ = 0;
};

}  // namespace furcula::linux_sbc
