// Instructions of the emulated Cortex-M4F between two points.
#pragma once

#include <cstdint>

namespace furcula::pil {

/// TIM2 counts nanoseconds of virtual time, and with `-icount shift=0` an instruction takes one: the counter
/// counts instructions. (The real timer's clock is another; this is the emulator's.)
class InstructionCounter {
 public:
  InstructionCounter() {
    reg(kCr1) = 1;
    const std::uint32_t first = read();
    overhead_ = read() - first;
  }
  std::uint32_t read() const { return reg(kCnt); }
  /// Between two reads, less what one read takes.
  std::uint32_t between(std::uint32_t first, std::uint32_t second) const {
    return second - first - overhead_;
  }

 private:
  static constexpr std::uintptr_t kCr1 = 0x40000000, kCnt = 0x40000024;
  static volatile std::uint32_t& reg(std::uintptr_t address) {
    return *reinterpret_cast<volatile std::uint32_t*>(address);
  }
  std::uint32_t overhead_ = 0;
};

}  // namespace furcula::pil
