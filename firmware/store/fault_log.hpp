// The last faults, kept over a reset in memory that start-up does not touch.
#pragma once

#include <array>
#include <cstdint>

#include "furcula/bus/logged_fault.hpp"

namespace furcula::firmware {

/// Lies in the section .noinit: after a power-up it is noise, after a reset what it was. begin() tells.
class FaultLog {
 public:
  static constexpr std::uint32_t kEntries = bus::kLoggedFaults;

  /// At each start. A log that is not whole, as after a power-up, is cleared. @returns whether it was kept.
  bool begin() {
    const bool kept = checksum_ == checksum() && count_ <= kEntries && next_ < kEntries;
    if (!kept) {
      entries_ = {};
      next_ = count_ = 0;
      starts_ = 0;
    }
    last_fault_ = 0;
    if (starts_ != 0xffffu) ++starts_;
    checksum_ = checksum();
    return kept;
  }

  /// Once a tick: notes a fault when it comes. 0 is no fault.
  void note(std::uint32_t tick, std::uint8_t fault) {
    if (fault == last_fault_) return;
    last_fault_ = fault;
    if (fault == 0) return;
    entries_[next_] = {tick, fault, static_cast<std::uint16_t>(starts_)};
    next_ = next_ + 1 == kEntries ? 0 : next_ + 1;
    if (count_ < kEntries) ++count_;
    checksum_ = checksum();
  }

  /// Whether the run before this one ended in that fault, and no tick had noted it: an exception's handler.
  bool last_run_ended_by(std::uint8_t fault) const {
    return count_ != 0 && entry(0).fault == fault && entry(0).tick == bus::kNoTick &&
           entry(0).starts + 1u == starts_;
  }

  std::uint32_t count() const { return count_; }
  std::uint32_t starts() const { return starts_; }
  /// `age` 0 is the newest; below count().
  const bus::LoggedFault& entry(std::uint32_t age) const {
    return entries_[(next_ + 2 * kEntries - 1 - age) % kEntries];
  }

 private:
  /// FNV-1a of the words: no change of one word leaves it as it was, and it is made within a tick.
  std::uint32_t checksum() const {
    std::uint32_t hash = 0x811c9dc5u;
    const auto add = [&hash](std::uint32_t word) { hash = (hash ^ word) * 0x01000193u; };
    for (const bus::LoggedFault& e : entries_) {
      add(e.tick);
      add(static_cast<std::uint32_t>(e.fault) << 16 | e.starts);
    }
    add(next_);
    add(count_);
    add(starts_);
    return hash;
  }

  // No initial values: an object in .noinit is not initialised, and one that is constructed is cleared by
  // begin().
  std::array<bus::LoggedFault, kEntries> entries_;
  std::uint32_t next_, count_, starts_, checksum_;
  std::uint8_t last_fault_;
};

}  // namespace furcula::firmware
