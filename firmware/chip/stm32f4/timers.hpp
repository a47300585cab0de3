// What timers are used for: the microsecond clock, the millisecond's tick, encoders, and the coil's duty.
#pragma once

#include <cstdint>

#include "firmware/chip/stm32f4/registers.hpp"
#include "furcula/core/count.hpp"

namespace furcula::stm32f4 {

namespace timer_bits {
inline constexpr std::uint32_t kEnable = 1u << 0, kOnlyOverflow = 1u << 2, kPreload = 1u << 7;  // CR1
inline constexpr std::uint32_t kUpdate = 1u << 0;  // DIER, SR, EGR
}  // namespace timer_bits

/// A 32-bit timer (TIM2 or TIM5) as a free-running clock of microseconds, 18.3.2.
template <class Word>
class MicrosecondClock {
 public:
  explicit MicrosecondClock(TimerRegisters<Word>& timer) : timer_(timer) {}

  /// `timer_hz`: whole megahertz, up to 65536 of them.
  void start(std::uint32_t timer_hz) {
    timer_.cr1 = 0;
    timer_.psc = timer_hz / 1'000'000 - 1;
    timer_.arr = 0xffffffffu;
    timer_.egr = timer_bits::kUpdate;  // takes the prescaler over at once
    timer_.sr = 0;
    timer_.cr1 = timer_bits::kEnable;
  }
  std::uint32_t now_us() const { return timer_.cnt; }

 private:
  TimerRegisters<Word>& timer_;
};

/// The tick: a timer that overflows every millisecond, its interrupt, and the count of ticks that nobody
/// took.
template <class Word>
class TickTimer {
 public:
  explicit TickTimer(TimerRegisters<Word>& timer) : timer_(timer) {}

  void start(std::uint32_t timer_hz, std::uint32_t period_us) {
    timer_.cr1 = 0;
    timer_.psc = timer_hz / 1'000'000 - 1;
    timer_.arr = period_us - 1;
    timer_.egr = timer_bits::kUpdate;
    timer_.sr = 0;  // the write to EGR has set the flag
    timer_.dier = timer_bits::kUpdate;
    timer_.cr1 = timer_bits::kEnable | timer_bits::kOnlyOverflow;
  }

  /// The interrupt: clears the flag (written 0, which leaves flags of which 1 is written) and counts.
  void on_interrupt() {
    timer_.sr = ~timer_bits::kUpdate;
    ticks_ = ticks_ + 1;
  }

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
  TimerRegisters<Word>& timer_;
  volatile std::uint32_t ticks_ = 0;  // by the interrupt
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
    timer_.ccr[channel_] = static_cast<std::uint32_t>(share * static_cast<float>(steps_) + 0.5f);
  }

 private:
  TimerRegisters<Word>& timer_;
  unsigned channel_;
  std::uint32_t steps_ = 0;
};

}  // namespace furcula::stm32f4
