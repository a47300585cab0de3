// A model of a flash memory with two slots and of a power cut at any of its steps.
#pragma once

#include <array>
#include <cstdint>
#include <random>

#include "firmware/store/flash.hpp"

namespace furcula::test {

struct PowerCut {};

/// Bits go from 1 to 0 only. An erase takes kEraseSteps steps, and cut at one of them leaves garbage: words
/// erased, words as they were, words with any bits set. A word cut while it is programmed has only some of
/// its bits cleared; it takes four steps, one for each byte, as a memory that programs bytes would.
template <std::uint32_t Words>
class FlashModel {
 public:
  static constexpr std::uint32_t kSlotWords = Words;
  static constexpr int kEraseSteps = 8;

  explicit FlashModel(std::uint32_t seed) : random_(seed) {
    for (auto& slot : slots_) slot.fill(firmware::kErasedWord);
  }

  /// The power goes at the step of this number from now, 1 is the next; 0: it stays.
  void cut_at(std::uint32_t step) { steps_left_ = step; }
  std::uint32_t steps() const { return steps_; }

  Status erase(unsigned slot) {
    if (refuses_) return Status::disconnected;
    for (int step = 0; step < kEraseSteps; ++step) {
      if (is_cut()) {
        for (std::uint32_t& word : slots_[slot]) {
          const auto kind = random_() % 4;
          if (kind == 0) word |= drawn();
          if (kind == 1) word |= drawn() & drawn() & drawn();
          if (kind == 2) word = firmware::kErasedWord;
        }
        throw PowerCut{};
      }
    }
    slots_[slot].fill(firmware::kErasedWord);
    ++erases_[slot];
    return Status::ok;
  }

  Status program(unsigned slot, std::uint32_t index, std::uint32_t word) {
    if (refuses_) return Status::disconnected;
    std::uint32_t& cell = slots_[slot].at(index);
    for (unsigned byte = 0; byte < 4; ++byte) {
      const std::uint32_t mask = 0xffu << (8 * byte);
      if (is_cut()) {
        cell &= word | ~mask | drawn();
        throw PowerCut{};
      }
      cell &= word | ~mask;
    }
    return Status::ok;
  }

  std::uint32_t read(unsigned slot, std::uint32_t index) const { return slots_[slot].at(index); }

  void refuse(bool refuses) { refuses_ = refuses; }
  /// That came to their end.
  std::uint32_t erases(unsigned slot) const { return erases_.at(slot); }
  std::uint32_t& word(unsigned slot, std::uint32_t index) { return slots_[slot].at(index); }

 private:
  std::uint32_t drawn() { return static_cast<std::uint32_t>(random_()); }
  bool is_cut() {
    ++steps_;
    return steps_left_ != 0 && --steps_left_ == 0;
  }

  std::array<std::array<std::uint32_t, Words>, firmware::kSlots> slots_;
  std::mt19937 random_;
  std::uint32_t steps_left_ = 0, steps_ = 0;
  bool refuses_ = false;
  std::array<std::uint32_t, firmware::kSlots> erases_{};
};

}  // namespace furcula::test
