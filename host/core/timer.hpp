// The loop's clock: sleeps until the next tick of an absolute grid, and counts the ticks that it missed.
#pragma once

#include <cerrno>
#include <cstdint>
#include <ctime>

namespace furcula::core {

inline std::int64_t monotonic_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{1'000'000'000} * now.tv_sec + now.tv_nsec;
}

class Timer {
 public:
  explicit Timer(std::int64_t period_ns) : period_ns_(period_ns) {}

  /// The grid begins now.
  void start() { due_ns_ = monotonic_ns(); }

  /// Sleeps until the next tick that is still to come. @returns how late it woke, ns: from the tick that was
  /// due, so that a loop that missed ticks returns what it lost too.
  std::int64_t wait() {
    due_ns_ += period_ns_;
    const timespec due{static_cast<std::time_t>(due_ns_ / 1'000'000'000),
                       static_cast<long>(due_ns_ % 1'000'000'000)};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr) == EINTR) {
    }
    woke_ns_ = monotonic_ns();
    const std::int64_t late_ns = woke_ns_ - due_ns_;
    // Ticks that are past are left out: a burst of them would make up nothing.
    if (late_ns >= period_ns_) {
      const std::int64_t missed = late_ns / period_ns_;
      overruns_ += static_cast<std::uint64_t>(missed);
      due_ns_ += missed * period_ns_;
    }
    return late_ns;
  }

  static std::int64_t now_ns() { return monotonic_ns(); }
  std::int64_t woke_ns() const { return woke_ns_; }
  /// Ticks that never were, because the loop was still busy or was not woken.
  std::uint64_t overruns() const { return overruns_; }

 private:
  std::int64_t period_ns_;
  std::int64_t due_ns_ = 0, woke_ns_ = 0;
  std::uint64_t overruns_ = 0;
};

}  // namespace furcula::core
