// Addresses and offsets of the registers against the tables of the reference manual.
#include "firmware/chip/stm32f4/registers.hpp"

#include <catch2/catch.hpp>
#include <cstddef>

namespace {

using namespace furcula::stm32f4;
using Word = std::uint32_t;

// Offsets as RM0090 prints them beside each register
// (8.4.11, 7.3.24, 3.9.8, 18.4.21, 21.4.5, 30.6.8, 32.9.5).
static_assert(offsetof(GpioRegisters<Word>, pupdr) == 0x0c && offsetof(GpioRegisters<Word>, bsrr) == 0x18 &&
              offsetof(GpioRegisters<Word>, afr) == 0x20);
static_assert(offsetof(RccRegisters<Word>, cfgr) == 0x08 && offsetof(RccRegisters<Word>, ahb1enr) == 0x30 &&
              offsetof(RccRegisters<Word>, apb1enr) == 0x40 &&
              offsetof(RccRegisters<Word>, apb2enr) == 0x44 && offsetof(RccRegisters<Word>, bdcr) == 0x70 &&
              offsetof(RccRegisters<Word>, csr) == 0x74);
static_assert(offsetof(FlashRegisters<Word>, keyr) == 0x04 && offsetof(FlashRegisters<Word>, sr) == 0x0c &&
              offsetof(FlashRegisters<Word>, cr) == 0x10);
static_assert(offsetof(TimerRegisters<Word>, smcr) == 0x08 && offsetof(TimerRegisters<Word>, dier) == 0x0c &&
              offsetof(TimerRegisters<Word>, sr) == 0x10 && offsetof(TimerRegisters<Word>, egr) == 0x14 &&
              offsetof(TimerRegisters<Word>, ccmr1) == 0x18 && offsetof(TimerRegisters<Word>, ccer) == 0x20 &&
              offsetof(TimerRegisters<Word>, cnt) == 0x24 && offsetof(TimerRegisters<Word>, psc) == 0x28 &&
              offsetof(TimerRegisters<Word>, arr) == 0x2c && offsetof(TimerRegisters<Word>, ccr) == 0x34);
static_assert(offsetof(WatchdogRegisters<Word>, rlr) == 0x08 &&
              offsetof(WatchdogRegisters<Word>, sr) == 0x0c);
static_assert(offsetof(UsartRegisters<Word>, dr) == 0x04 && offsetof(UsartRegisters<Word>, brr) == 0x08 &&
              offsetof(UsartRegisters<Word>, cr1) == 0x0c && offsetof(UsartRegisters<Word>, cr3) == 0x14);
static_assert(offsetof(CanRegisters<Word>, tsr) == 0x08 && offsetof(CanRegisters<Word>, rfr) == 0x0c &&
              offsetof(CanRegisters<Word>, esr) == 0x18 && offsetof(CanRegisters<Word>, btr) == 0x1c &&
              offsetof(CanRegisters<Word>, transmit) == 0x180 &&
              offsetof(CanRegisters<Word>, receive) == 0x1b0 && offsetof(CanRegisters<Word>, fmr) == 0x200 &&
              offsetof(CanRegisters<Word>, fm1r) == 0x204 && offsetof(CanRegisters<Word>, fs1r) == 0x20c &&
              offsetof(CanRegisters<Word>, ffa1r) == 0x214 && offsetof(CanRegisters<Word>, fa1r) == 0x21c &&
              offsetof(CanRegisters<Word>, filter) == 0x240);

}  // namespace

TEST_CASE("the blocks lie where the memory map of the manual has them") {
  // RM0090 2.3 table 1, the first address of each range.
  CHECK(address::kTim2 == 0x4000'0000);
  CHECK(address::kTim3 == 0x4000'0400);
  CHECK(address::kTim4 == 0x4000'0800);
  CHECK(address::kTim5 == 0x4000'0c00);
  CHECK(address::kTim9 == 0x4001'4000);
  CHECK(address::kTim13 == 0x4000'1c00);
  CHECK(address::kIwdg == 0x4000'3000);
  CHECK(address::kUsart2 == 0x4000'4400);
  CHECK(address::kUsart3 == 0x4000'4800);
  CHECK(address::kCan1 == 0x4000'6400);
  CHECK(address::kGpioA + 4 * address::kGpioStride == 0x4002'1000);  // GPIOE
  CHECK(address::kRcc == 0x4002'3800);
  CHECK(address::kFlash == 0x4002'3c00);
  CHECK(address::kUniqueId == 0x1fff'7a10);
  CHECK(address::kRandom == 0x5006'0800);
  CHECK(address::kSysTick == 0xe000'e010);
}

TEST_CASE("a condition is looked at so often at most") {
  int looks = 0;
  CHECK_FALSE(wait_for([&] { return ++looks > 1000; }, 100));
  CHECK(looks == 100);
  CHECK(wait_for([&] { return true; }, 1));
  CHECK_FALSE(wait_for([&] { return true; }, 0));
}
