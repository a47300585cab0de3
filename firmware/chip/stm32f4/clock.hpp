// The clocks: 168 MHz from the crystal, or the internal 16 MHz oscillator where the crystal does not start.
#pragma once

#include <cstdint>

#include "firmware/chip/stm32f4/registers.hpp"
#include "furcula/bus/node_words.hpp"
#include "furcula/core/status.hpp"

namespace furcula::stm32f4 {

inline constexpr std::uint32_t kHsiHz = 16'000'000;
inline constexpr std::uint32_t kCoreHz = 168'000'000;  ///< the most, datasheet DS8626 5.3.1

/// What runs how fast.
struct Clocks {
  std::uint32_t core_hz = kHsiHz;
  std::uint32_t apb1_hz = kHsiHz;
  std::uint32_t apb2_hz = kHsiHz;
  bool from_crystal = false;  ///< false: within 1 %, which is too far off for 1 Mbit/s on CAN

  /// A timer's clock is twice that of its bus where the bus is slower than the core, 7.2.
  constexpr std::uint32_t apb1_timer_hz() const { return apb1_hz == core_hz ? apb1_hz : 2 * apb1_hz; }
  constexpr std::uint32_t apb2_timer_hz() const { return apb2_hz == core_hz ? apb2_hz : 2 * apb2_hz; }
};

/// At 168 MHz: 42 MHz is the most for APB1, 84 MHz for APB2.
inline constexpr Clocks kFullSpeed{kCoreHz, kCoreHz / 4, kCoreHz / 2, true};

/// f(VCO in) = crystal / M, f(VCO) = f(VCO in) N, core = f(VCO) / P, USB = f(VCO) / Q. 7.3.2 recommends 2 MHz
/// at the VCO's input, against jitter.
struct PllFactors {
  std::uint32_t m = 0, n = 0, p = 2, q = 0;
  constexpr std::uint32_t pllcfgr() const {
    constexpr std::uint32_t kFromCrystal = 1u << 22;
    return m | n << 6 | (p / 2 - 1) << 16 | kFromCrystal | q << 24;
  }
};
constexpr PllFactors pll_factors(std::uint32_t crystal_hz) {
  constexpr std::uint32_t kVcoInHz = 2'000'000, kVcoHz = 2 * kCoreHz, kUsbHz = 48'000'000;
  return {crystal_hz / kVcoInHz, kVcoHz / kVcoInHz, 2, kVcoHz / kUsbHz};
}
/// Whether 168 MHz come out exactly, with factors that the registers take.
constexpr bool suits(std::uint32_t crystal_hz) {
  return crystal_hz >= 4'000'000 && crystal_hz <= 26'000'000 && crystal_hz % 2'000'000 == 0;
}

/// Starts the crystal and the PLL and switches to them. Bounded: a crystal that is not there costs some 10
/// ms. `disconnected`: the chip runs from its internal oscillator, and `clocks` says so.
template <class Word>
Status start_clocks(RccRegisters<Word>& rcc, FlashRegisters<Word>& flash, std::uint32_t crystal_hz,
                    Clocks& clocks) {
  constexpr std::uint32_t kHseOn = 1u << 16, kHseReady = 1u << 17, kSecurityOn = 1u << 19, kPllOn = 1u << 24,
                          kPllReady = 1u << 25;
  constexpr std::uint32_t kSwitch = 3u, kSwitchPll = 2u, kStatus = 3u << 2, kStatusPll = 2u << 2;
  constexpr std::uint32_t kApb1By4 = 5u << 10, kApb2By2 = 4u << 13, kPrescalers = 0xfcf0u;
  constexpr std::uint32_t kLatency = 7u, kFiveWaitStates = 5u, kPrefetch = 1u << 8, kCaches = 3u << 9;
  constexpr std::uint32_t kPolls = 20'000;  // some 10 ms at 16 MHz; a crystal takes 2 ms (DS8626 table 41)

  clocks = {};
  set_bits(rcc.cr, kHseOn);
  bool good = wait_for([&] { return (rcc.cr & kHseReady) != 0; }, kPolls);
  if (good) {
    rcc.pllcfgr = pll_factors(crystal_hz).pllcfgr();
    set_bits(rcc.cr, kPllOn);
    good = wait_for([&] { return (rcc.cr & kPllReady) != 0; }, kPolls);
  }
  if (good) {
    // Five wait states before the clock rises (3.5.1 table 10, at 2.7 to 3.6 V), and seen to be there.
    flash.acr = kFiveWaitStates | kPrefetch | kCaches;
    good = wait_for([&] { return (flash.acr & kLatency) == kFiveWaitStates; }, kPolls);
  }
  if (good) {
    put_bits(rcc.cfgr, kPrescalers, kApb1By4 | kApb2By2);
    put_bits(rcc.cfgr, kSwitch, kSwitchPll);
    good = wait_for([&] { return (rcc.cfgr & kStatus) == kStatusPll; }, kPolls);
  }
  if (!good) {
    clear_bits(rcc.cfgr, kSwitch | kPrescalers);
    clear_bits(rcc.cr, kPllOn | kHseOn);
    return Status::disconnected;
  }
  // From now on a crystal that stops is a non-maskable interrupt, 7.2.7.
  set_bits(rcc.cr, kSecurityOn);
  clocks = kFullSpeed;
  return Status::ok;
}

/// Why the chip started, 7.3.21; of several causes the one that tells most.
using bus::ResetCause;

/// Reads the flags and clears them for the next start.
template <class Word>
ResetCause take_reset_cause(RccRegisters<Word>& rcc) {
  constexpr std::uint32_t kRemove = 1u << 24, kBrownOut = 1u << 25, kPin = 1u << 26, kPower = 1u << 27,
                          kSoftware = 1u << 28, kWatchdogs = 3u << 29;
  const std::uint32_t flags = rcc.csr;
  set_bits(rcc.csr, kRemove);
  // Each cause but a power-up leaves the pin's flag too: the chip pulls its own pin down.
  if ((flags & kWatchdogs) != 0) return ResetCause::watchdog;
  if ((flags & kSoftware) != 0) return ResetCause::software;
  if ((flags & (kPower | kBrownOut)) != 0) return ResetCause::power;
  return (flags & kPin) != 0 ? ResetCause::pin : ResetCause::unknown;
}

}  // namespace furcula::stm32f4
