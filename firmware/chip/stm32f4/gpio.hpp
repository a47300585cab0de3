// Pins: input, output, or given to a peripheral.
#pragma once

#include <cstdint>

#include "firmware/chip/stm32f4/registers.hpp"

namespace furcula::stm32f4 {

struct Pin {
  char port = 'A';
  std::uint8_t number = 0;
};
constexpr std::uint32_t port_index(Pin pin) { return static_cast<std::uint32_t>(pin.port - 'A'); }

/// A pin and the number of the peripheral's function on it (datasheet DS8626 table 9).
struct AlternatePin {
  Pin pin;
  std::uint8_t function = 0;
};

enum class Pull : std::uint8_t { none = 0, up = 1, down = 2 };

/// `gpio` is the block of the pin's port. The fields are 8.4.1 to 8.4.10.
template <class Word>
void make_input(GpioRegisters<Word>& gpio, std::uint8_t number, Pull pull) {
  put_bits(gpio.pupdr, 3u << (2 * number), static_cast<std::uint32_t>(pull) << (2 * number));
  put_bits(gpio.moder, 3u << (2 * number), 0u);
}

/// Low or high through the set/reset register: one write, whatever else uses the port.
template <class Word>
void write_pin(GpioRegisters<Word>& gpio, std::uint8_t number, bool high) {
  gpio.bsrr = 1u << (high ? number : number + 16u);
}

template <class Word>
bool read_pin(const GpioRegisters<Word>& gpio, std::uint8_t number) {
  return (gpio.idr >> number & 1u) != 0;
}

/// Push-pull; at its level before it becomes an output.
template <class Word>
void make_output(GpioRegisters<Word>& gpio, std::uint8_t number, bool high) {
  write_pin(gpio, number, high);
  clear_bits(gpio.otyper, 1u << number);
  put_bits(gpio.pupdr, 3u << (2 * number), 0u);
  put_bits(gpio.moder, 3u << (2 * number), 1u << (2 * number));
}

/// Push-pull, at the second of four speeds (25 MHz): enough for what is used here, and gentle edges.
template <class Word>
void make_alternate(GpioRegisters<Word>& gpio, std::uint8_t number, std::uint8_t function, Pull pull) {
  put_bits(gpio.afr[number / 8], 0xfu << (4 * (number % 8u)),
           static_cast<std::uint32_t>(function) << (4 * (number % 8u)));
  clear_bits(gpio.otyper, 1u << number);
  put_bits(gpio.ospeedr, 3u << (2 * number), 1u << (2 * number));
  put_bits(gpio.pupdr, 3u << (2 * number), static_cast<std::uint32_t>(pull) << (2 * number));
  put_bits(gpio.moder, 3u << (2 * number), 2u << (2 * number));
}

}  // namespace furcula::stm32f4
