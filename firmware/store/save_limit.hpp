// How often a memory that wears may be written to. A program that saves for ever must not wear it out.
#pragma once

#include <cstdint>

namespace furcula::firmware {

/// An STM32F405's sector bears 10,000 erases (datasheet DS8626, table 40) and each save erases one of two in turn;
/// less a fifth for saves that did not come to their end, which leave no record that counts them.
inline constexpr std::uint32_t kSavesMost = 16'000;
/// Saves at any time, and one more for each ten minutes: all of kSavesMost then last for more than three months.
inline constexpr std::uint32_t kSavesInARow = 10;
inline constexpr std::uint32_t kTicksForASave = 600'000;

class SaveLimit {
 public:
  /// Once a tick of 1 ms.
  void tick() {
    if (left_ == kSavesInARow) return;
    if (++ticks_ < kTicksForASave) return;
    ticks_ = 0;
    ++left_;
  }
  /// false: it is too early.
  bool take() {
    if (left_ == 0) return false;
    --left_;
    return true;
  }

 private:
  std::uint32_t left_ = kSavesInARow, ticks_ = 0;
};

}  // namespace furcula::firmware
