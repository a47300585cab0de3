// The last faults, kept over a reset in memory that start-up does not touch.
#pragma once

#include <array>
#include <cstdint>

#include "furcula/core/crc32.hpp"

namespace furcula::firmware {

struct FaultEntry {
  std::uint32_t tick = 0;    ///< since that start, ms
  std::uint16_t fault = 0;   ///< number in the table of faults (control/fault.hpp)
  std::uint16_t starts = 0;  ///< starts since the log was cleared, 1 is the first: which run it was
};

/// Lies in the section .noinit: after a power-up it is noise, after a reset what it was. begin() tells.
class FaultLog {
 public:
  static constexpr std::uint32_t kEntries = 8;

  /// At each start. A log that is not whole, as after a power-up, is cleared. @returns whether it was kept.
  bool begin() {
    const bool kept = crc_ == checksum() && count_ <= kEntries && next_ < kEntries;
    if (!kept) {
      entries_ = {};
      next_ = count_ = 0;
      starts_ = 0;
    }
    last_fault_ = 0;
    if (starts_ != 0xffffu) ++starts_;
    crc_ = checksum();
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
    crc_ = checksum();
  }

  std::uint32_t count() const { return count_; }
  std::uint32_t starts() const { return starts_; }
  /// `age` 0 is the newest; below count().
  const FaultEntry& entry(std::uint32_t age) const {
    return entries_[(next_ + 2 * kEntries - 1 - age) % kEntries];
  }

 private:
  std::uint32_t checksum() const {
    Crc32 crc;
    for (const FaultEntry& e : entries_) {
      crc.add_word(e.tick);
      crc.add_word(static_cast<std::uint32_t>(e.fault) << 16 | e.starts);
    }
    crc.add_word(next_);
    crc.add_word(count_);
    crc.add_word(starts_);
    return crc.value();
  }

  // No initial values: an object in .noinit is not initialised, and one that is constructed is cleared by
  // begin().
  std::array<FaultEntry, kEntries> entries_;
  std::uint32_t next_, count_, starts_, crc_;
  std::uint8_t last_fault_;
};

}  // namespace furcula::firmware
