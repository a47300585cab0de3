// Registers of an STM32F405/407 and how the drivers use them. Sections and tables are those of the reference
// manual RM0090, revision 19.
//
// A block of registers is a template over its word: on the chip `Hardware`, on the host a model of a register
// (tests/firmware/chip/model.hpp). A driver keeps a reference to its block and knows no address.
#pragma once

#include <cstdint>

namespace furcula::stm32f4 {

using Hardware = volatile std::uint32_t;

/// Where the blocks lie, 2.3 table 1, and 39.1 for the electronic signature.
namespace address {
inline constexpr std::uintptr_t kTim2 = 0x40000000, kTim3 = 0x40000400, kTim4 = 0x40000800,
                                kTim5 = 0x40000c00, kTim13 = 0x40001c00, kTim14 = 0x40002000,
                                kTim9 = 0x40014000;
inline constexpr std::uintptr_t kIwdg = 0x40003000;
inline constexpr std::uintptr_t kPower = 0x40007000;
inline constexpr std::uintptr_t kUsart1 = 0x40011000, kUsart2 = 0x40004400, kUsart3 = 0x40004800;
inline constexpr std::uintptr_t kCan1 = 0x40006400;
inline constexpr std::uintptr_t kGpioA = 0x40020000, kGpioStride = 0x400;
inline constexpr std::uintptr_t kRcc = 0x40023800, kFlash = 0x40023c00;
inline constexpr std::uintptr_t kRandom = 0x50060800;
inline constexpr std::uintptr_t kUniqueId = 0x1fff7a10;
inline constexpr std::uintptr_t kSysTick = 0xe000e010;  // PM0214 4.5
inline constexpr std::uintptr_t kAircr = 0xe000ed0c;    // PM0214 4.4
}  // namespace address

/// The block at an address of the chip.
template <template <class> class Block>
inline Block<Hardware>& block_at(std::uintptr_t address) {
  return *reinterpret_cast<Block<Hardware>*>(address);
}

template <class Word>
void set_bits(Word& reg, std::uint32_t bits) {
  reg = static_cast<std::uint32_t>(reg) | bits;
}
template <class Word>
void clear_bits(Word& reg, std::uint32_t bits) {
  reg = static_cast<std::uint32_t>(reg) & ~bits;
}
/// Writes the bits of `mask`, keeps the others.
template <class Word>
void put_bits(Word& reg, std::uint32_t mask, std::uint32_t bits) {
  reg = (static_cast<std::uint32_t>(reg) & ~mask) | bits;
}

/// Looks at a condition so often at most. @returns whether it came true.
template <class Condition>
bool wait_for(Condition condition, std::uint32_t polls) {
  for (std::uint32_t i = 0; i < polls; ++i)
    if (condition()) return true;
  return false;
}

/// A register by itself.
template <class Word>
struct SingleRegister {
  Word word;
};

/// General-purpose I/O, 8.4.
template <class Word>
struct GpioRegisters {
  Word moder, otyper, ospeedr, pupdr, idr, odr, bsrr, lckr, afr[2];
};

/// Reset and clock control, 7.3.
template <class Word>
struct RccRegisters {
  Word cr, pllcfgr, cfgr, cir, ahb1rstr, ahb2rstr, ahb3rstr, reserved_1c, apb1rstr, apb2rstr, reserved_28[2],
      ahb1enr, ahb2enr, ahb3enr, reserved_3c, apb1enr, apb2enr, reserved_48[2], ahb1lpenr, ahb2lpenr,
      ahb3lpenr, reserved_5c, apb1lpenr, apb2lpenr, reserved_68[2], bdcr, csr;
};

/// Interface of the flash memory, 3.9.
template <class Word>
struct FlashRegisters {
  Word acr, keyr, optkeyr, sr, cr, optcr;
};

/// Power control, 5.4.
template <class Word>
struct PowerRegisters {
  Word cr, csr;
};

/// General-purpose timers, 18.4 (TIM2 to TIM5) and 19.4, 19.5 (TIM9, TIM13, TIM14, which have fewer of them).
template <class Word>
struct TimerRegisters {
  Word cr1, cr2, smcr, dier, sr, egr, ccmr1, ccmr2, ccer, cnt, psc, arr, reserved_30, ccr[4];
};

/// Independent watchdog, 21.4.
template <class Word>
struct WatchdogRegisters {
  Word kr, pr, rlr, sr;
};

/// Serial interface, 30.6.
template <class Word>
struct UsartRegisters {
  Word sr, dr, brr, cr1, cr2, cr3, gtpr;
};

/// One of the three transmit mailboxes or of the two receive FIFOs of bxCAN, 32.9.3.
template <class Word>
struct CanMailbox {
  Word identifier, length, data_low, data_high;
};

/// bxCAN, 32.9.
template <class Word>
struct CanRegisters {
  Word mcr, msr, tsr, rfr[2], ier, esr, btr, reserved_20[88];
  CanMailbox<Word> transmit[3];
  CanMailbox<Word> receive[2];
  Word reserved_1d0[12], fmr, fm1r, reserved_208, fs1r, reserved_210, ffa1r, reserved_218, fa1r,
      reserved_220[8];
  Word filter[28][2];
};

/// Random number generator, 24.4.
template <class Word>
struct RandomRegisters {
  Word cr, sr, dr;
};

/// The processor's timer, PM0214 4.5.
template <class Word>
struct SysTickRegisters {
  Word csr, rvr, cvr, calib;
};

}  // namespace furcula::stm32f4
