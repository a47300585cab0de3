// Pins and timers on models of their registers.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "firmware/chip/stm32f4/gpio.hpp"
#include "firmware/chip/stm32f4/processor.hpp"
#include "firmware/chip/stm32f4/timers.hpp"
#include "tests/firmware/chip/model.hpp"

namespace {

using namespace furcula::stm32f4;
using furcula::test::Register;

/// EGR's update bit takes the prescaler over and sets the flag; flags are cleared by writing 0, and a 1
/// leaves them (18.4.5, 18.4.6).
struct TimerModel {
  TimerRegisters<Register> timer;
  std::uint32_t prescaler = 0;
  TimerModel() {
    timer.egr.on_write = [this](std::uint32_t, std::uint32_t written) {
      if ((written & 1u) != 0) {
        prescaler = timer.psc.value;
        timer.sr.value |= 1u;
      }
      return 0u;
    };
    timer.sr.on_write = [](std::uint32_t old, std::uint32_t written) { return old & written; };
  }
};

struct GpioModel {
  GpioRegisters<Register> gpio;
  GpioModel() {
    gpio.bsrr.on_write = [this](std::uint32_t, std::uint32_t written) {
      gpio.odr.value = (gpio.odr.value & ~(written >> 16)) | (written & 0xffffu);
      return 0u;
    };
    gpio.moder.on_write = [this](std::uint32_t, std::uint32_t written) {
      level_at_start = gpio.odr.value;
      return written;
    };
  }
  std::uint32_t level_at_start = 0;
};

}  // namespace

TEST_CASE("a pin is made what it is to be, and the other fifteen stay as they are") {
  for (std::uint8_t number = 0; number < 16; ++number) {
    GpioModel port;
    auto& g = port.gpio;
    for (Register* r : {&g.moder, &g.otyper, &g.ospeedr, &g.pupdr, &g.afr[0], &g.afr[1]})
      r->value = 0xffff'ffffu;
    const std::uint32_t field = 3u << (2 * number);

    make_input(g, number, Pull::up);
    CHECK(g.moder.value == (0xffff'ffffu & ~field));
    CHECK(g.pupdr.value == ((0xffff'ffffu & ~field) | 1u << (2 * number)));

    make_alternate(g, number, 9, Pull::none);
    CHECK(g.moder.value == ((0xffff'ffffu & ~field) | 2u << (2 * number)));
    CHECK(g.pupdr.value == (0xffff'ffffu & ~field));
    const std::uint32_t at = 4 * (number % 8);
    CHECK(g.afr[number / 8].value == ((0xffff'ffffu & ~(0xfu << at)) | 9u << at));
    CHECK(g.afr[1 - number / 8].value == 0xffff'ffffu);
    CHECK(g.otyper.value == (0xffff'ffffu & ~(1u << number)));

    g.odr.value = 0;
    make_output(g, number, true);
    CHECK(port.level_at_start == 1u << number);  // its level was there before it became an output
    CHECK(g.moder.value == ((0xffff'ffffu & ~field) | 1u << (2 * number)));
    write_pin(g, number, false);
    CHECK(g.odr.value == 0);
    CHECK(g.bsrr.writes.back() == 1u << (number + 16));

    g.idr.value = 1u << number;
    CHECK(read_pin(g, number));
    CHECK_FALSE(read_pin(g, static_cast<std::uint8_t>(15 - number)));
  }
}

TEST_CASE("the clock counts microseconds at either speed of the chip") {
  for (const std::uint32_t hz : {84'000'000u, 16'000'000u}) {
    TimerModel model;
    MicrosecondClock<Register> clock(model.timer);
    clock.start(hz);
    CHECK(hz / (model.prescaler + 1) == 1'000'000);  // 18.3.1: f(CK_PSC) / (PSC + 1)
    CHECK(model.timer.arr.value == 0xffff'ffffu);
    CHECK((model.timer.cr1.value & 1u) == 1);
    CHECK(model.timer.sr.value == 0);
    model.timer.cnt.value = 0xffff'fff0u;
    CHECK(clock.now_us() == 0xffff'fff0u);
  }
}

TEST_CASE("the tick comes every 1000 counts of a microsecond, and nobody takes one that was not there") {
  TimerModel model;
  TickTimer<Register> tick(model.timer);
  tick.start(84'000'000, 1000);
  CHECK((model.prescaler + 1) * (model.timer.arr.value + 1) == 84'000);  // 18.3.1: 84 MHz / 84000 = 1 kHz
  CHECK(model.timer.dier.value == 1u);
  CHECK(model.timer.sr.value == 0);  // the update by software is no tick
  CHECK((model.timer.cr1.value & 5u) == 5u);
  CHECK_FALSE(tick.take());

  model.timer.sr.value = 0x41u;  // an overflow, and a trigger's flag
  tick.on_interrupt();
  CHECK(model.timer.sr.value == 0x40u);  // only its own flag is cleared
  CHECK(tick.take());
  CHECK_FALSE(tick.take());
  CHECK(tick.missed() == 0);
}

TEST_CASE("ticks that nobody took are counted as missed, unless they are skipped") {
  TimerModel model;
  TickTimer<Register> tick(model.timer);
  tick.start(16'000'000, 1000);
  for (int i = 0; i < 4; ++i) tick.on_interrupt();
  CHECK(tick.take());
  CHECK_FALSE(tick.take());
  CHECK(tick.missed() == 3);
  for (int i = 0; i < 250; ++i) tick.on_interrupt();
  tick.skip();
  CHECK_FALSE(tick.take());
  CHECK(tick.missed() == 3);
  CHECK(tick.ticks() == 254);
}

TEST_CASE("a timer is set up as an encoder as 18.3.12 has it") {
  for (const unsigned bits : {16u, 32u})
    for (const bool reversed : {false, true}) {
      TimerModel model;
      Encoder<Register> encoder(model.timer, bits);
      encoder.start(reversed);
      const auto& t = model.timer;
      CHECK((t.smcr.value & 7u) == 3);            // SMS: counts on both edges of both inputs
      CHECK((t.ccmr1.value & 0x303u) == 0x101u);  // CC1S, CC2S: each input to its own channel
      CHECK((t.ccmr1.value >> 4 & 0xfu) == 3);    // IC1F: 8 samples at the timer's clock
      CHECK((t.ccmr1.value >> 12 & 0xfu) == 3);
      CHECK(t.ccer.value == (reversed ? 2u : 0u));  // CC1P
      CHECK(t.arr.value == (bits == 32 ? 0xffff'ffffu : 0xffffu));
      CHECK(t.cr1.value == 1u);
    }
}

TEST_CASE("a count of 16 or 32 bits goes on where the timer wraps, forth and back, for millions of counts") {
  for (const unsigned bits : {16u, 32u}) {
    TimerModel model;
    Encoder<Register> encoder(model.timer, bits);
    encoder.start(false);
    std::int64_t truth = 0;
    for (int n = 0; n < 200'000; ++n) {
      truth += static_cast<std::int64_t>(32'000.0 * std::sin(n * 1e-4) + 700.0 * std::sin(n * 0.37));
      model.timer.cnt.value = static_cast<std::uint32_t>(truth) & (bits == 32 ? 0xffff'ffffu : 0xffffu);
      if (encoder.count() != static_cast<std::uint32_t>(truth)) {
        FAIL("off at reading " << n);
      }
    }
  }
}

TEST_CASE("the coil's duty is a share of the timer's steps") {
  for (unsigned channel = 1; channel <= 2; ++channel) {
    TimerModel model;
    auto& t = model.timer;
    Pwm<Register> pwm(t, channel);
    pwm.start(168'000'000, 20'000);
    CHECK(t.arr.value + 1 == 8400);                          // 168 MHz / 20 kHz
    CHECK(t.ccmr1.value == (0x68u << (8 * (channel - 1))));  // 19.4.5: PWM mode 1, preload
    CHECK(t.ccer.value == 1u << (4 * (channel - 1)));
    CHECK((t.cr1.value & 0x81u) == 0x81u);
    const Register& compare = t.ccr[channel - 1];
    CHECK(compare.value == 0);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const auto& [duty, steps] : {std::pair<float, std::uint32_t>{1.0f, 8400},
                                      {0.5f, 4200},
                                      {0.45f, 3780},
                                      {0.0f, 0},
                                      {-0.1f, 0},
                                      {7.0f, 8400},
                                      {nan, 0}}) {
      pwm.set(duty);
      CHECK(compare.value == steps);
    }
    CHECK(t.ccr[2 - channel].writes.empty());
  }
}

TEST_CASE("an interrupt is let through by its bit alone, and a reset asked for with its key") {
  Register enable[3];
  enable_interrupt(enable, Interrupt::tim4);
  enable_interrupt(enable, Interrupt::tim5);
  CHECK(enable[0].writes == std::vector<std::uint32_t>{1u << 30});
  CHECK(enable[1].writes == std::vector<std::uint32_t>{1u << 18});
  Register aircr;
  request_reset(aircr);
  CHECK(aircr.value == 0x05fa'0004u);
}
