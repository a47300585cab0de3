// A serial port for Modbus RTU, looked at instead of waited for.
#pragma once

#include <cstdint>

#include "firmware/chip/stm32f4/registers.hpp"
#include "furcula/core/status.hpp"

namespace furcula::stm32f4 {

enum class Parity : std::uint8_t { none, even };

/// BRR, 30.3.4: clock / baud in sixteenths, with 16 samples a bit; to the nearest.
constexpr std::uint32_t usart_divider(std::uint32_t clock_hz, std::uint32_t baud) {
  return (clock_hz + baud / 2) / baud;
}

/// Bytes lost and spoilt since the start.
struct UsartErrors {
  std::uint32_t parity = 0, framing = 0, noise = 0, overrun = 0;
};

template <class Word>
class Usart {
 public:
  explicit Usart(UsartRegisters<Word>& usart) : usart_(usart) {}

  /// 8 data bits; with even parity the ninth, which the peripheral makes and checks.
  void start(std::uint32_t clock_hz, std::uint32_t baud, Parity parity) {
    constexpr std::uint32_t kReceive = 1u << 2, kTransmit = 1u << 3, kParity = 1u << 10, kNineBits = 1u << 12,
                            kEnable = 1u << 13;
    usart_.cr1 = 0;
    usart_.cr2 = 0;
    usart_.cr3 = 0;
    usart_.brr = usart_divider(clock_hz, baud);
    usart_.cr1 = kEnable | kReceive | kTransmit | (parity == Parity::even ? kParity | kNineBits : 0u);
  }

  /// A byte that came whole. `disconnected`: none came. `invalid`: one came spoilt, or was lost; what it
  /// belonged to is worthless. Does not wait.
  Result<std::uint8_t> receive() {
    const std::uint32_t status = usart_.sr;
    if ((status & (kReceived | kOverrun)) == 0) return Status::disconnected;
    const std::uint32_t data = usart_.dr;  // reading SR and then DR clears the flags, 30.6.1
    errors_.parity += status & kParityError;
    errors_.framing += status >> 1 & 1u;
    errors_.noise += status >> 2 & 1u;
    errors_.overrun += status >> 3 & 1u;
    if ((status & (kParityError | kFraming | kNoise | kOverrun)) != 0) return Status::invalid;
    return static_cast<std::uint8_t>(data);
  }

  /// Hands a byte over. `disconnected`: the last one has not left yet. Does not wait.
  Status send(std::uint8_t byte) {
    if ((usart_.sr & kEmpty) == 0) return Status::disconnected;
    usart_.dr = byte;
    return Status::ok;
  }

  /// Whether the last stop bit is out, so that a driver of RS-485 may let the line go.
  bool all_sent() const { return (usart_.sr & kComplete) != 0; }

  const UsartErrors& errors() const { return errors_; }

 private:
  static constexpr std::uint32_t kParityError = 1u << 0, kFraming = 1u << 1, kNoise = 1u << 2,
                                 kOverrun = 1u << 3, kReceived = 1u << 5, kComplete = 1u << 6,
                                 kEmpty = 1u << 7;
  UsartRegisters<Word>& usart_;
  UsartErrors errors_;
};

}  // namespace furcula::stm32f4
