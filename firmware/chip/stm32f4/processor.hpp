// The processor's own blocks, and what names this very chip.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/chip/stm32f4/registers.hpp"

namespace furcula::stm32f4 {

/// Lets an interrupt through, PM0214 4.3.2; all have the same priority, so that none interrupts another.
template <class Word>
void enable_interrupt(Word* nvic_enable, Interrupt interrupt) {
  const auto number = static_cast<std::uint32_t>(interrupt);
  nvic_enable[number / 32] = 1u << (number % 32);  // ones set, zeros leave
}

/// Starts the chip anew, PM0214 4.4.5.
template <class Word>
void request_reset(Word& aircr) {
  constexpr std::uint32_t kKey = 0x05fa0000u, kSystemReset = 1u << 2;
  aircr = kKey | kSystemReset;
}

/// 96 bits that no other chip has, 39.1.
template <class Word>
std::array<std::uint32_t, 3> unique_id(const Word* signature) {
  return {signature[0], signature[1], signature[2]};
}

}  // namespace furcula::stm32f4
