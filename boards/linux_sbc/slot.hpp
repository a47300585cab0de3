// Hands one value at a time from one thread to another, without a lock.
#pragma once

#include <atomic>
#include <type_traits>

namespace furcula::linux_sbc {

/// One thread puts, one other takes; neither ever waits. `T` is copied.
template <class T>
requires std::is_trivially_copyable_v<T>
class Slot {
 public:
  /// false: the last value was not taken yet; it stays.
  bool put(const T& value) {
    if (full_.load(std::memory_order_acquire)) return false;
    value_ = value;
    full_.store(true, std::memory_order_release);
    return true;
  }

  /// false: nothing is there; `value` stays as it was.
  bool take(T& value) {
    if (!full_.load(std::memory_order_acquire)) return false;
    value = value_;
    full_.store(false, std::memory_order_release);
    return true;
  }

 private:
  T value_{};
  std::atomic<bool> full_{false};
};

}  // namespace furcula::linux_sbc
