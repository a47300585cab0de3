// Hands one value at a time from one thread to another, without a lock.
#pragma once

#include <atomic>
#include <cstdint>
#include <type_traits>

namespace furcula::linux_sbc {

/// One thread puts, and may take back what it put; one other takes. Neither ever waits. `T` is copied.
template <class T>
requires std::is_trivially_copyable_v<T>
class Slot {
 public:
  /// false: the last value was not taken yet; it stays.
  bool put(const T& value) {
    if (state_.load(std::memory_order_acquire) != State::empty) return false;
    value_ = value;
    state_.store(State::full, std::memory_order_release);
    return true;
  }

  /// For who put: true: the value is gone, and nobody ever takes it. false: it was taken.
  bool withdraw() {
    State expected = State::full;
    return state_.compare_exchange_strong(expected, State::empty, std::memory_order_acq_rel);
  }

  /// false: nothing is there; `value` stays as it was.
  bool take(T& value) {
    State expected = State::full;
    if (!state_.compare_exchange_strong(expected, State::being_taken, std::memory_order_acq_rel))
      return false;
    value = value_;
    state_.store(State::empty, std::memory_order_release);
    return true;
  }

 private:
  enum class State : std::uint8_t { empty, full, being_taken };
  T value_{};
  std::atomic<State> state_{State::empty};
};

}  // namespace furcula::linux_sbc
