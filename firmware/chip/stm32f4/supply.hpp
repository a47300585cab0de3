// The chip's supply voltage, as far as it can be told: whether an erase of the flash memory may begin.
#pragma once

#include <cstdint>

#include "firmware/chip/stm32f4/registers.hpp"

namespace furcula::stm32f4 {

/// Words of 32 bits are erased and programmed at 2.7 to 3.6 V (3.6.2 table 8). The detector compares the supply with
/// a threshold; the brown-out reset, an option of the chip that is off as it is sold, holds the processor while it
/// is too low. An erase takes a second or two in which nobody can look.
template <class Word>
class Supply {
 public:
  Supply(PowerRegisters<Word>& power, const FlashRegisters<Word>& flash) : power_(power), flash_(flash) {}

  /// The detector at its highest threshold, 2.9 V (5.4.1, PLS). The power block must have its clock.
  void start() {
    constexpr std::uint32_t kEnable = 1u << 4, kThreshold = 7u << 5;
    put_bits(power_.cr, kThreshold, kThreshold);
    set_bits(power_.cr, kEnable);
  }

  /// Above the detector's threshold now (5.4.2, PVDO).
  bool is_high() const { return (power_.csr & 1u << 2) == 0; }

  /// The option at its highest level (3.9.10, BOR_LEV: 0 is level 3, 2.7 to 3.6 V; 3 is off).
  bool resets_when_low() const { return (flash_.optcr & 3u << 2) == 0; }

 private:
  PowerRegisters<Word>& power_;
  const FlashRegisters<Word>& flash_;
};

}  // namespace furcula::stm32f4
