// What timers are used for: the microsecond clock, the millisecond's tick, encoders, and the coil's duty.
#pragma once

#include <cstdint>

#include "firmware/chip/stm32f4/registers.hpp"
#include "furcula/core/count.hpp"

namespace furcula::stm32f4 {

namespace timer_bits {
inline constexpr std::uint32_t kEnable = 1u << 0, kPreload = 1u << 7;  // CR1
inline constexpr std::uint32_t kUpdate = 1u << 0;                      // SR, EGR
}  // namespace timer_bits

/// A 32-bit timer (TIM2 or TIM5) as a free-running clock of microseconds, 18.3.2.
template <class Word>
class MicrosecondClock {
 public:
  explicit MicrosecondClock(TimerRegisters<Word>& timer) : timer_(timer) {}

  /// `timer_mhz`: the timer's clock, up to 65536 MHz.
  void start(std::uint32_t timer_mhz) {
    timer_.cr1 = 0;
    timer_.psc = timer_mhz - 1;
    timer_.arr = 0xffffffffu;
    timer_.egr = timer_bits::kUpdate;  // takes the prescaler over at once
    timer_.sr = 0;
    timer_.cr1 = timer_bits::kEnable;
  }
  std::uint32_t now_us() const { return timer_.cnt; }

 private:
  TimerRegisters<Word>& timer_;
};

/// A timer's clock in MHz, measured over a millisecond of the processor's own timer, to the nearest. On a
/// chip it is what the tree of clocks says, or `expected_mhz` was wrong; in QEMU, whose timers have clocks of
/// their own, it makes the clock of microseconds agree with the tick. `expected_mhz` where the processor's
/// timer does not run.
template <class Word>
std::uint32_t measure_mhz(SysTickRegisters<Word>& processor, TimerRegisters<Word>& timer,
                          std::uint32_t core_hz, std::uint32_t expected_mhz) {
  constexpr std::uint32_t kEnable = 1u << 0, kCoreClock = 1u << 2, kCounted = 1u << 16, kPolls = 1'000'000;
  timer.cr1 = 0;
  timer.psc = 0;
  timer.arr = 0xffffffffu;
  timer.egr = timer_bits::kUpdate;
  timer.cr1 = timer_bits::kEnable;
  processor.rvr = core_hz / 1000 - 1;
  processor.cvr = 0;
  processor.csr = kEnable | kCoreClock;
  std::uint32_t counts[2] = {};
  bool counted = true;
  // The flag is cleared by reading it; so the first time only begins the millisecond.
  for (std::uint32_t& count : counts) {
    counted = counted && wait_for([&] { return (processor.csr & kCounted) != 0; }, kPolls);
    count = timer.cnt;
  }
  processor.csr = 0;
  const std::uint32_t mhz = (counts[1] - counts[0] + 500) / 1000;
  return counted && mhz != 0 && mhz <= 0x10000 ? mhz : expected_mhz;
}

/// The tick: the processor's own timer (PM0214 4.5), its exception every millisecond, and the count of ticks
/// that nobody took.
template <class Word>
class Tick {
 public:
  explicit Tick(SysTickRegisters<Word>& timer) : timer_(timer) {}

  /// `core_hz`: whole megahertz. Up to 99 ms at 168 MHz.
  void start(std::uint32_t core_hz, std::uint32_t period_us) {
    constexpr std::uint32_t kEnable = 1u << 0, kException = 1u << 1, kCoreClock = 1u << 2;
    timer_.csr = 0;
    timer_.rvr = core_hz / 1'000'000 * period_us - 1;
    timer_.cvr = 0;  // whatever is written: begins anew
    timer_.csr = kEnable | kException | kCoreClock;
  }

  /// The exception.
  void on_exception() { ticks_ = ticks_ + 1; }

  /// Whether a tick is due; takes it. Of several that are due all are taken, and all but one are missed: the
  /// application sees one long interval.
  bool take() {
    const std::uint32_t ticks = ticks_;
    const std::uint32_t due = ticks - taken_;
    if (due == 0) return false;
    missed_ += due - 1;
    taken_ = ticks;
    return true;
  }
  /// Forgets what became due meanwhile, as after a save that stopped the processor.
  void skip() { taken_ = ticks_; }

  std::uint32_t ticks() const { return ticks_; }
  std::uint32_t missed() const { return missed_; }

 private:
  SysTickRegisters<Word>& timer_;
  volatile std::uint32_t ticks_ = 0;  // by the exception
  std::uint32_t taken_ = 0, missed_ = 0;
};

/// A quadrature encoder on channels 1 and 2 of a timer, 18.3.12: four counts a line, both edges of both
/// inputs. `Bits` is the timer's width: 32 for TIM2 and TIM5, 16 for TIM3 and TIM4. The count is always of 32
/// bits and wraps; it is right as long as it is read before it moved by half of the timer's range.
template <class Word>
class Encoder {
 public:
  Encoder(TimerRegisters<Word>& timer, unsigned bits) : timer_(timer), wide_(bits == 32) {}

  /// `reversed` counts the other way. Inputs must keep their level for 8 clocks of the timer (CCMR1's filter
  /// 0b0011), 95 ns at 84 MHz: shorter pulses are noise.
  void start(bool reversed) {
    constexpr std::uint32_t kBothInputs = 3u, kDirect1 = 1u << 0, kFilter1 = 3u << 4, kDirect2 = 1u << 8,
                            kFilter2 = 3u << 12, kInvert1 = 1u << 1;
    timer_.cr1 = 0;
    timer_.ccmr1 = kDirect1 | kFilter1 | kDirect2 | kFilter2;
    timer_.ccer = reversed ? kInvert1 : 0u;
    timer_.smcr = kBothInputs;
    timer_.psc = 0;
    timer_.arr = wide_ ? 0xffffffffu : 0xffffu;
    timer_.cnt = 0;
    timer_.cr1 = timer_bits::kEnable;
    last_ = 0;
    count_ = 0;
  }

  std::uint32_t count() {
    const std::uint32_t raw = timer_.cnt;
    const std::int32_t moved =
        wide_ ? count_difference(raw, last_)
              : count_difference(static_cast<std::uint16_t>(raw), static_cast<std::uint16_t>(last_));
    last_ = raw;
    count_ += static_cast<std::uint32_t>(moved);
    return count_;
  }

 private:
  TimerRegisters<Word>& timer_;
  bool wide_;
  std::uint32_t last_ = 0, count_ = 0;
};

/// A share of the supply on channel 1 or 2 of a timer: pulse width modulation, 18.3.9 and 19.3.9.
template <class Word>
class Pwm {
 public:
  /// `channel` 1 or 2.
  Pwm(TimerRegisters<Word>& timer, unsigned channel) : timer_(timer), channel_(channel - 1) {}

  /// Starts at 0. `timer_hz / frequency_hz` is the number of steps, at most 65536.
  void start(std::uint32_t timer_hz, std::uint32_t frequency_hz) {
    constexpr std::uint32_t kMode1WithPreload = 6u << 4 | 1u << 3;
    steps_ = timer_hz / frequency_hz;
    timer_.cr1 = 0;
    timer_.psc = 0;
    timer_.arr = steps_ - 1;
    timer_.ccr[channel_] = 0;
    timer_.ccmr1 = kMode1WithPreload << (8 * channel_);
    timer_.ccer = 1u << (4 * channel_);
    timer_.egr = timer_bits::kUpdate;
    timer_.cr1 = timer_bits::kEnable | timer_bits::kPreload;
  }

  /// `duty` 0 to 1, beyond it the nearer of both; what is not a number is 0. From the next period on.
  void set(float duty) {
    const float share = duty >= 1.0f ? 1.0f : duty > 0.0f ? duty : 0.0f;
    // A compare value of all steps is on without a gap.
    timer_.ccr[channel_] = nearest_count(share * static_cast<float>(steps_));
  }

 private:
  TimerRegisters<Word>& timer_;
  unsigned channel_;
  std::uint32_t steps_ = 0;
};

}  // namespace furcula::stm32f4
