// The lines of the contact switch and of the solenoid. The only thing that libgpiod is used for: gpio_v1.cpp
// on its version 1, gpio_v2.cpp on its version 2; CMake chooses.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

namespace furcula::linux_sbc {

/// A line or chip that is not there, or is another's; the message says which and what to look at.
struct GpioError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct GpioLine {
  std::string chip;  ///< "gpiochip0", "/dev/gpiochip0", a label or a number
  std::string line;  ///< a name, or the number on the chip
  bool active_low = false;
};

/// What came of reading the switch.
struct SwitchReading {
  bool closed = false;
  std::uint32_t edges = 0;         ///< since the last reading
  std::int64_t last_edge_ns = -1;  ///< CLOCK_MONOTONIC, stamped by the kernel; -1: no edge since the start
  bool ok = true;                  ///< false: the line cannot be read any more
};

/// The switch as an input with edges on both sides, the solenoid as an output that is off at first. Reading
/// and setting never block and take no memory.
class Gpio {
 public:
  /// @throws GpioError.
  Gpio(const GpioLine& contact, const GpioLine* solenoid);
  ~Gpio();
  Gpio(const Gpio&) = delete;
  Gpio& operator=(const Gpio&) = delete;

  SwitchReading read_switch();
  /// false: the line did not take it. Without a solenoid nothing happens.
  bool set_solenoid(bool on);

 private:
  struct Lines;
  std::unique_ptr<Lines> lines_;
  SwitchReading reading_;
  bool solenoid_on_ = false;
};

}  // namespace furcula::linux_sbc
