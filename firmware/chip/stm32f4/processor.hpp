// The processor's own blocks, and what names this very chip.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/chip/stm32f4/registers.hpp"
#include "furcula/core/status.hpp"

namespace furcula::stm32f4 {

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

/// 32 bits of noise, 24.3.1: the second number, since the first is not to be used. Needs the 48 MHz of the
/// PLL; `disconnected` without it, and where the generator finds itself not random.
template <class Word>
Result<std::uint32_t> draw_random(RandomRegisters<Word>& random) {
  constexpr std::uint32_t kEnable = 1u << 2, kReady = 1u << 0, kErrors = 3u << 1, kPolls = 1000;
  random.cr = kEnable;
  std::uint32_t drawn = 0;
  for (int i = 0; i < 2; ++i) {
    const bool ready = wait_for([&] { return (random.sr & kReady) != 0; }, kPolls);
    if (!ready || (random.sr & kErrors) != 0) return Status::disconnected;
    drawn = random.dr;
  }
  random.cr = 0;
  return drawn;
}

}  // namespace furcula::stm32f4
