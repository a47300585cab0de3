// What a board of an STM32F4 is to the firmware: its crystal, and what is on which pin. Each board has one.
#pragma once

#include <cstdint>

#include "firmware/app/can_link.hpp"
#include "firmware/chip/stm32f4/clock.hpp"
#include "firmware/chip/stm32f4/gpio.hpp"
#include "firmware/chip/stm32f4/registers.hpp"
#include "firmware/chip/stm32f4/usart.hpp"

namespace furcula::stm32f4 {

/// Channels 1 and 2 of a timer with an encoder's inputs A and B, each with a pull-up.
struct EncoderWiring {
  std::uintptr_t timer = 0;  ///< TIM2 (32 bits), TIM3 or TIM4 (16)
  AlternatePin a, b;
  bool reversed = false;
  constexpr unsigned bits() const { return timer == address::kTim2 ? 32 : 16; }
};

/// The gate of the solenoid's transistor, at a timer's channel. It must have a pull-down: in a reset the pin
/// is an input, and the spring is to be caught then.
struct CoilWiring {
  std::uintptr_t timer = 0;  ///< TIM9, TIM13 or TIM14
  unsigned channel = 1;
  AlternatePin pin;
  std::uint32_t frequency_hz = 20'000;  ///< above hearing
};

struct CanWiring {
  AlternatePin receive, transmit;
  std::uint32_t bits_per_s = 1'000'000;
};

/// To a transceiver of RS-485, whose driver is on while `drive` is high; or RS-232, where nobody looks at it.
struct SerialWiring {
  std::uintptr_t usart = 0;  ///< USART2 or USART3 (both on APB1)
  AlternatePin receive, transmit;
  Pin drive;
  std::uint8_t unit = 1;  ///< address of the server
  std::uint32_t baud = 115'200;
  Parity parity = Parity::even;  ///< Modbus over serial line V1.02, 2.5.1
};

struct Wiring {
  std::uint32_t crystal_hz = 0;
  EncoderWiring height, cable;
  Pin contact;  ///< a switch to ground, closed is low; the pin pulls up
  CoilWiring coil;
  CanWiring can;
  SerialWiring serial;
  Pin led;  ///< on (high) while the robot runs, blinks in a fault
  firmware::CanLinkConfig link;
};

/// The bit of a peripheral in its enable register, 7.3.10 to 7.3.14: they stand in the order of their blocks.
constexpr std::uint32_t enable_bit(std::uintptr_t block) {
  if (block == address::kRandom) return 1u << 6;  // but for the few of AHB2
  return 1u << ((block & 0xffffu) / 0x400u % 32u);
}
constexpr bool on_apb1(std::uintptr_t block) { return block >= 0x40000000 && block < 0x40010000; }
constexpr bool on_apb2(std::uintptr_t block) { return block >= 0x40010000 && block < 0x40020000; }
constexpr bool on_ahb2(std::uintptr_t block) { return block >= 0x50000000; }

/// Lets a peripheral's clock through; before anything else is done with it.
template <class Word>
void enable_block(RccRegisters<Word>& rcc, std::uintptr_t block) {
  Word& reg = on_apb1(block)   ? rcc.apb1enr
              : on_apb2(block) ? rcc.apb2enr
              : on_ahb2(block) ? rcc.ahb2enr
                               : rcc.ahb1enr;
  set_bits(reg, enable_bit(block));
  // A write to the block may only follow two of its clocks later (errata ES0182): reading does.
  static_cast<void>(static_cast<std::uint32_t>(reg));
}

/// Whether a board's table makes sense. TIM5 is the clock of microseconds.
constexpr bool is_sound(const Wiring& w) {
  const bool timers =
      w.height.timer != w.cable.timer && w.height.timer != address::kTim5 && w.cable.timer != address::kTim5;
  const bool serial = w.serial.usart == address::kUsart2 || w.serial.usart == address::kUsart3;
  return suits(w.crystal_hz) && timers && serial;
}

/// Defined by each board's folder, in wiring.cpp.
extern const Wiring kWiring;

}  // namespace furcula::stm32f4
