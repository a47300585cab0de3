// What the store needs of a flash memory: two slots that are erased as a whole and programmed a word at a
// time.
#pragma once

#include <concepts>
#include <cstdint>

#include "furcula/core/status.hpp"

namespace furcula::firmware {

inline constexpr unsigned kSlots = 2;
inline constexpr std::uint32_t kErasedWord = 0xffffffffu;

/// Two slots, 0 and 1, that share no erase sector with each other or with code. All calls are bounded in
/// time; erase() and program() may block for as long as the memory takes (an STM32F4: seconds, and
/// microseconds).
template <class F>
concept SlotFlash = requires(F& flash, const F& seen, unsigned slot, std::uint32_t index,
                             std::uint32_t word) {
  /// Words of the smaller slot.
  { F::kSlotWords } -> std::convertible_to<std::uint32_t>;
  /// Every word of the slot becomes kErasedWord. Not ok: the memory refused or did not finish.
  { flash.erase(slot) } -> std::same_as<Status>;
  /// Bits go from 1 to 0 only. Not ok: the memory refused or did not finish.
  { flash.program(slot, index, word) } -> std::same_as<Status>;
  { seen.read(slot, index) } -> std::same_as<std::uint32_t>;
};

}  // namespace furcula::firmware
