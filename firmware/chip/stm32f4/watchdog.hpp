// The independent watchdog: resets the chip if nobody kicks it, whatever the clocks and the program do.
#pragma once

#include <cstdint>

#include "firmware/chip/stm32f4/registers.hpp"
#include "furcula/core/status.hpp"

namespace furcula::stm32f4 {

/// Its oscillator runs at 32 kHz, between these (datasheet DS8626 table 43).
inline constexpr std::uint32_t kLsiSlowestHz = 17'000, kLsiFastestHz = 47'000;

/// Prescaler 4 << `divider`, and counts from `reload` to 0.
struct WatchdogTiming {
  std::uint32_t divider = 0, reload = 0;
  constexpr std::uint32_t at_hz_us(std::uint32_t lsi_hz) const {
    return static_cast<std::uint32_t>((std::uint64_t{4u << divider} * (reload + 1) * 1'000'000u) / lsi_hz);
  }
};

/// Bites no earlier than after `shortest_ms`, even with the fastest oscillator; at most 20 s.
constexpr WatchdogTiming watchdog_timing(std::uint32_t shortest_ms) {
  for (std::uint32_t divider = 0; divider <= 6; ++divider) {
    const std::uint32_t period = 1000u * (4u << divider);
    const std::uint32_t counts = (shortest_ms * kLsiFastestHz + period - 1) / period;
    if (counts <= 4096) return {divider, counts == 0 ? 0 : counts - 1};
  }
  return {6, 4095};
}

template <class Word>
class Watchdog {
 public:
  static constexpr std::uint32_t kPolls = 100'000;  // an update takes 5 cycles of the oscillator

  explicit Watchdog(WatchdogRegisters<Word>& registers) : registers_(registers) {}

  /// From now on kick() must be called; there is no way back but a reset.
  Status start(const WatchdogTiming& timing) {
    registers_.kr = 0xccccu;
    return set(timing);
  }

  /// Changes the time, as before an erase of the flash memory that stops the processor; and kicks.
  /// `disconnected`: the registers did not take it over in time.
  Status set(const WatchdogTiming& timing) {
    registers_.kr = 0x5555u;
    registers_.pr = timing.divider;
    registers_.rlr = timing.reload;
    const bool taken = wait_for([&] { return registers_.sr == 0; }, kPolls);
    kick();
    return taken ? Status::ok : Status::disconnected;
  }

  void kick() { registers_.kr = 0xaaaau; }

 private:
  WatchdogRegisters<Word>& registers_;
};

}  // namespace furcula::stm32f4
