// When a clutch's key is out of the teeth: a delay after its coil is switched on, until another delay after
// it is switched off.
#pragma once

#include <array>
#include <cstddef>

#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

/// The key is out of the teeth over the union of [switched on + release delay, switched off + catch delay). A pulse that
/// is too short does not pull it out, and a pause that is too short does not let it in.
template <class T>
class KeyTiming {
 public:
  KeyTiming() = default;
  /// Delays from the coil's switching on until the key is out, and from its switching off until it is in, s.
  KeyTiming(const T& release_delay_s, const T& catch_delay_s)
      : release_delay_(release_delay_s), catch_delay_(catch_delay_s) {}

  /// At rest in the teeth (or out of them) with the coil off (or on), no change pending.
  void reset(bool out = false) {
    on_ = out_ = out;
    count_ = 0;
  }

  /// From now on the coil is on, or off.
  void energise(bool on) {
    if (on == on_) return;
    on_ = on;
    const T& delay = on ? release_delay_ : catch_delay_;
    // What would come before the change that is on its way takes that back.
    if (count_ > 0 && !(value_of(due_[count_ - 1]) < value_of(delay)))
      --count_;
    else if (count_ < due_.size())
      due_[count_++] = delay;
  }

  bool out() const { return out_; }  ///< out of the teeth
  /// Whether the key goes out or in within `t` seconds. A change exactly at their end belongs to the next interval, so that
  /// the derivative by the delay is not lost in an interval of no length.
  bool changes_within(ValueOf<T> t) const { return count_ > 0 && value_of(due_[0]) < t; }
  /// Time until the next change, s; only where one is pending (changes_within()).
  const T& change_in() const { return due_[0]; }

  /// `t` seconds pass, in which nothing changes.
  void pass(const T& t) {
    for (std::size_t i = 0; i < count_; ++i) due_[i] = due_[i] - t;
  }
  /// The pending change happens now: the key goes out, or in.
  void change() {
    out_ = !out_;
    for (std::size_t i = 1; i < count_; ++i) due_[i - 1] = due_[i];
    --count_;
  }

 private:
  T release_delay_{}, catch_delay_{};
  bool on_ = false, out_ = false;
  std::array<T, 8> due_{};  ///< times until the pending changes, the next first, s
  std::size_t count_ = 0;
};

}  // namespace furcula::dynamics
