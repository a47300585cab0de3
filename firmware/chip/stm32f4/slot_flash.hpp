// Two sectors of the chip's flash memory as the store's two slots.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/chip/stm32f4/registers.hpp"
#include "firmware/chip/stm32f4/supply.hpp"
#include "firmware/store/flash.hpp"
#include "furcula/core/status.hpp"

namespace furcula::stm32f4 {

/// A sector: its number (3.4 table 5) and where it begins.
template <class Word>
struct FlashSector {
  std::uint32_t number = 0;
  Word* words = nullptr;
};

/// Programs 32 bits at a time (a supply of 2.7 to 3.6 V, 3.6.2). The processor stands still while the memory
/// is busy, because it runs from the same one: an erase of a 128 KiB sector takes 1 s, and 2 s at most. With a supply
/// that is too low, or with none who watches it meanwhile, nothing is begun; an erase after which it is too low has
/// failed.
template <class Word>
class SlotFlash {
 public:
  static constexpr std::uint32_t kSlotWords = 1024;
  static constexpr std::uint32_t kPolls = 20'000'000;  // seconds of looking

  SlotFlash(FlashRegisters<Word>& registers, const Supply<Word>& supply,
            const std::array<FlashSector<Word>, firmware::kSlots>& sectors)
      : registers_(registers), supply_(supply), sectors_(sectors) {}

  Status erase(unsigned slot) {
    constexpr std::uint32_t kErase = 1u << 1, kStart = 1u << 16, kDataCache = 1u << 10,
                            kDataCacheReset = 1u << 12;
    if (!supply_.is_high() || !supply_.resets_when_low() || !unlock()) return Status::disconnected;
    const std::uint32_t command = kErase | sectors_[slot].number << 3 | kWords;
    registers_.cr = command;
    registers_.cr = command | kStart;
    const Status finished = finish();
    const Status status = supply_.is_high() ? finished : Status::disconnected;
    // What the data cache knows of the sector is not so any more; it is emptied while it is off (3.9.1).
    clear_bits(registers_.acr, kDataCache);
    set_bits(registers_.acr, kDataCacheReset);
    clear_bits(registers_.acr, kDataCacheReset);
    set_bits(registers_.acr, kDataCache);
    return status;
  }

  Status program(unsigned slot, std::uint32_t index, std::uint32_t word) {
    constexpr std::uint32_t kProgram = 1u << 0;
    if (!supply_.is_high() || !unlock()) return Status::disconnected;
    registers_.cr = kProgram | kWords;
    sectors_[slot].words[index] = word;
    return finish();
  }

  std::uint32_t read(unsigned slot, std::uint32_t index) const { return sectors_[slot].words[index]; }

 private:
  static constexpr std::uint32_t kWords = 2u << 8;                          // CR: PSIZE
  static constexpr std::uint32_t kLock = 1u << 31;                          // CR
  static constexpr std::uint32_t kBusy = 1u << 16, kErrors = 0xf2u;         // SR
  static constexpr std::uint32_t kKey1 = 0x45670123u, kKey2 = 0xcdef89abu;  // 3.6.1

  bool is_done() const { return (registers_.sr & kBusy) == 0; }

  bool unlock() {
    if (!wait_for([&] { return is_done(); }, kPolls)) return false;
    if ((registers_.cr & kLock) != 0) {
      registers_.keyr = kKey1;
      registers_.keyr = kKey2;
    }
    registers_.sr = kErrors;  // a flag left over stops the next operation; written 1 it is cleared
    return (registers_.cr & kLock) == 0;
  }

  Status finish() {
    const bool done = wait_for([&] { return is_done(); }, kPolls);
    const bool good = done && (registers_.sr & kErrors) == 0;
    registers_.cr = kLock;
    return good ? Status::ok : Status::disconnected;
  }

  FlashRegisters<Word>& registers_;
  const Supply<Word>& supply_;
  std::array<FlashSector<Word>, firmware::kSlots> sectors_;
};

}  // namespace furcula::stm32f4
