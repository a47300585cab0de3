// Clocks and reset cause on a model of the clock control, against the manual's formulas.
#include "firmware/chip/stm32f4/clock.hpp"

#include <catch2/catch.hpp>
#include <memory>

#include "tests/firmware/chip/model.hpp"

namespace {

using namespace furcula;
using namespace furcula::stm32f4;
using test::Register;

/// Flags come some reads after what they tell of was switched on; the switch follows what it is told only if
/// that clock runs (7.3.1 to 7.3.3).
struct ClockModel {
  RccRegisters<Register> rcc;
  FlashRegisters<Register> flash;
  bool crystal = true, pll = true, wait_states = true, follows = true;
  bool too_fast = false;  ///< the core was given more than 30 MHz a wait state (3.5.1 table 10)

  explicit ClockModel(int polls) {
    rcc.cr.value = 0x83;  // after a reset: HSI on, ready, trimmed
    rcc.pllcfgr.value = 0x24003010;
    auto hse = std::make_shared<test::LateFlag>(polls), locked = std::make_shared<test::LateFlag>(polls);
    rcc.cr.on_read = [this, hse, locked](std::uint32_t value) {
      if ((value >> 16 & 1) != 0 && crystal && (*hse)()) value |= 1u << 17;
      if ((value >> 24 & 1) != 0 && pll && (*locked)()) value |= 1u << 25;
      return value;
    };
    // The ready flags are read-only.
    rcc.cr.on_write = [](std::uint32_t, std::uint32_t written) { return written & ~(1u << 17 | 1u << 25); };
    rcc.pllcfgr.on_write = [this](std::uint32_t, std::uint32_t written) {
      CHECK((rcc.cr.value >> 24 & 1) == 0);  // only while the PLL is off
      return written;
    };
    flash.acr.on_write = [this](std::uint32_t, std::uint32_t written) {
      return wait_states ? written : written & ~7u;
    };
    auto switched = std::make_shared<test::LateFlag>(polls);
    rcc.cfgr.on_read = [this, switched](std::uint32_t value) {
      value &= ~0xcu;
      if ((value & 3u) == 2 && follows && (*switched)()) value |= 2u << 2;
      return value;
    };
    rcc.cfgr.on_write = [this](std::uint32_t, std::uint32_t written) {
      if ((written & 3u) == 2 && (flash.acr & 7u) < 5) too_fast = true;
      return written;
    };
  }
};

/// The divider that 7.3.3 prints for a value of PPRE1 or PPRE2.
std::uint32_t apb_divider(std::uint32_t field) { return field < 4 ? 1 : 2u << (field - 4); }

}  // namespace

TEST_CASE("168 MHz come from the crystals of both boards, by the manual's formulas") {
  for (const std::uint32_t crystal_hz : {8'000'000u, 12'000'000u, 16'000'000u, 26'000'000u}) {
    ClockModel chip(3);
    Clocks clocks;
    REQUIRE(suits(crystal_hz));
    REQUIRE(start_clocks(chip.rcc, chip.flash, crystal_hz, clocks) == Status::ok);
    // 7.3.2, from the bits as they were written.
    const std::uint32_t pll = chip.rcc.pllcfgr.value;
    const double m = pll & 0x3f, n = pll >> 6 & 0x1ff, p = 2.0 * ((pll >> 16 & 3) + 1), q = pll >> 24 & 0xf;
    const double vco_in_hz = crystal_hz / m, vco_hz = vco_in_hz * n;
    CHECK((pll >> 22 & 1) == 1);  // from the crystal
    CHECK((m >= 2 && m <= 63 && n >= 50 && n <= 432 && q >= 2));
    CHECK((vco_in_hz >= 1e6 && vco_in_hz <= 2e6));
    CHECK((vco_hz >= 100e6 && vco_hz <= 432e6));
    CHECK(vco_hz / p == 168e6);
    CHECK(vco_hz / q == 48e6);
    const std::uint32_t cfgr = chip.rcc.cfgr.value;
    CHECK((cfgr >> 4 & 0xf) == 0);  // AHB undivided
    CHECK(clocks.core_hz == 168'000'000);
    CHECK(clocks.apb1_hz == 168'000'000 / apb_divider(cfgr >> 10 & 7));
    CHECK(clocks.apb2_hz == 168'000'000 / apb_divider(cfgr >> 13 & 7));
    CHECK((clocks.apb1_hz <= 42'000'000 && clocks.apb2_hz <= 84'000'000));  // DS8626 table 14
    CHECK(clocks.apb1_timer_hz() == 84'000'000);
    CHECK(clocks.apb2_timer_hz() == 168'000'000);
    CHECK(clocks.from_crystal);
    CHECK(chip.flash.acr.value == (5u | 1u << 8 | 1u << 9 | 1u << 10));
    CHECK_FALSE(chip.too_fast);
    CHECK((chip.rcc.cr.value >> 19 & 1) == 1);  // the crystal is watched
  }
  ClockModel chip(1);
  Clocks clocks;
  REQUIRE(start_clocks(chip.rcc, chip.flash, 8'000'000, clocks) == Status::ok);
  CHECK(chip.rcc.pllcfgr.value == 0x0740'2a04);  // M 4, N 168, P 2, Q 7
  CHECK_FALSE(suits(25'000'000));
  CHECK_FALSE(suits(2'000'000));
}

TEST_CASE("whatever of crystal, PLL, wait states and switch does not come, the chip stays on its 16 MHz") {
  for (int broken = 0; broken < 4; ++broken) {
    ClockModel chip(2);
    chip.crystal = broken != 0;
    chip.pll = broken != 1;
    chip.wait_states = broken != 2;
    chip.follows = broken != 3;
    Clocks clocks = kFullSpeed;
    CHECK(start_clocks(chip.rcc, chip.flash, 8'000'000, clocks) == Status::disconnected);
    CHECK_FALSE(clocks.from_crystal);
    CHECK(clocks.core_hz == 16'000'000);
    CHECK(clocks.apb1_timer_hz() == 16'000'000);
    CHECK((chip.rcc.cfgr.value & 0xfcf3u) == 0);
    CHECK(chip.rcc.cr.value == 0x83);  // crystal, PLL and its watch are off, the internal oscillator is on
    CHECK_FALSE(chip.too_fast);
  }
}

TEST_CASE("a crystal that takes its 2 ms is waited for") {
  ClockModel chip(15'000);
  Clocks clocks;
  CHECK(start_clocks(chip.rcc, chip.flash, 8'000'000, clocks) == Status::ok);
}

TEST_CASE("the reset's cause is read once and cleared for the next start") {
  // 7.3.21; each reset but a power-up pulls the pin (its bit 26) as well.
  const struct {
    std::uint32_t csr;
    ResetCause cause;
  } cases[] = {{0x0e00'0000u, ResetCause::power},    {0x0400'0000u, ResetCause::pin},
               {0x1400'0000u, ResetCause::software}, {0x2400'0000u, ResetCause::watchdog},
               {0x4400'0000u, ResetCause::watchdog}, {0x0600'0000u, ResetCause::power},
               {0x0000'0000u, ResetCause::unknown}};
  for (const auto& c : cases) {
    RccRegisters<Register> rcc;
    rcc.csr.value = c.csr | 1u;  // and the watchdog's oscillator on
    rcc.csr.on_write = [](std::uint32_t old, std::uint32_t written) {
      return (written >> 24 & 1) != 0 ? (old & 0x00ff'ffffu) | (written & 1u) : old;
    };
    CHECK(take_reset_cause(rcc) == c.cause);
    CHECK(rcc.csr.value == 1u);
    CHECK(take_reset_cause(rcc) == ResetCause::unknown);
  }
}
