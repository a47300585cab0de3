// Pins and timers on models of their registers.
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "firmware/chip/stm32f4/gpio.hpp"
#include "firmware/chip/stm32f4/processor.hpp"
#include "firmware/chip/stm32f4/timers.hpp"
#include "firmware/chip/stm32f4/wiring.hpp"
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
  for (const std::uint32_t mhz : {84u, 16u}) {
    TimerModel model;
    MicrosecondClock<Register> clock(model.timer);
    clock.start(mhz);
    CHECK(mhz / (model.prescaler + 1) == 1);  // 18.3.1: f(CK_PSC) / (PSC + 1)
    CHECK(model.timer.arr.value == 0xffff'ffffu);
    CHECK((model.timer.cr1.value & 1u) == 1);
    CHECK(model.timer.sr.value == 0);
    model.timer.cnt.value = 0xffff'fff0u;
    CHECK(clock.now_us() == 0xffff'fff0u);
  }
}

TEST_CASE("a timer's clock is measured against the processor's") {
  // Each look at the flag takes 10 clocks of the processor; the flag comes every RELOAD + 1 of them.
  for (const auto& [core_hz, timer_mhz] :
       {std::pair{168'000'000u, 84u}, {16'000'000u, 16u}, {168'000'000u, 1000u}}) {
    TimerModel model;
    SysTickRegisters<Register> processor;
    std::uint64_t cycles = 0, flagged = 0;
    processor.csr.on_read = [&](std::uint32_t value) {
      cycles += 10;
      const std::uint64_t periods = cycles / (processor.rvr.value + 1);
      const bool counted = periods > flagged;
      flagged = periods;
      return value | (counted ? 1u << 16 : 0u);
    };
    model.timer.cnt.on_read = [&, mhz = timer_mhz, hz = core_hz](std::uint32_t) {
      return static_cast<std::uint32_t>(cycles * mhz * 1'000'000u / hz);
    };
    CHECK(measure_mhz(processor, model.timer, core_hz, 1u) == timer_mhz);
    CHECK(processor.csr.value == 0);  // off, for the tick to begin
  }
  TimerModel model;
  SysTickRegisters<Register> stopped;
  CHECK(measure_mhz(stopped, model.timer, 16'000'000u, 16u) == 16);
}

TEST_CASE("the tick comes every millisecond, and nobody takes one that was not there") {
  for (const std::uint32_t hz : {168'000'000u, 16'000'000u}) {
    SysTickRegisters<Register> timer;
    timer.cvr.value = 77;
    timer.cvr.on_write = [](std::uint32_t, std::uint32_t) { return 0u; };
    Tick<Register> tick(timer);
    tick.start(hz, 1000);
    // PM0214 4.5.2: the exception comes every RELOAD + 1 clocks; RELOAD has 24 bits.
    CHECK(timer.rvr.value + 1 == hz / 1000);
    CHECK(timer.rvr.value < 1u << 24);
    CHECK(timer.cvr.value == 0);
    CHECK(timer.csr.value == 7u);  // enabled, with its exception, from the core's clock
    CHECK_FALSE(tick.take());
    tick.on_exception();
    CHECK(tick.take());
    CHECK_FALSE(tick.take());
    CHECK(tick.missed() == 0);
  }
}

TEST_CASE("ticks that nobody took are counted as missed, unless they are skipped") {
  SysTickRegisters<Register> timer;
  Tick<Register> tick(timer);
  tick.start(16'000'000, 1000);
  for (int i = 0; i < 4; ++i) tick.on_exception();
  CHECK(tick.take());
  CHECK_FALSE(tick.take());
  CHECK(tick.missed() == 3);
  for (int i = 0; i < 250; ++i) tick.on_exception();
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

TEST_CASE("a reset is asked for with its key") {
  Register aircr;
  request_reset(aircr);
  CHECK(aircr.value == 0x05fa'0004u);
}

TEST_CASE("the clock of a block is let through by the bit that the manual has for it") {
  // RM0090 7.3.10 to 7.3.14.
  const struct {
    std::uintptr_t block;
    Register RccRegisters<Register>::*reg;
    unsigned bit;
  } cases[] = {
      {address::kTim2, &RccRegisters<Register>::apb1enr, 0},
      {address::kTim3, &RccRegisters<Register>::apb1enr, 1},
      {address::kTim4, &RccRegisters<Register>::apb1enr, 2},
      {address::kTim5, &RccRegisters<Register>::apb1enr, 3},
      {address::kTim13, &RccRegisters<Register>::apb1enr, 7},
      {address::kTim14, &RccRegisters<Register>::apb1enr, 8},
      {address::kTim9, &RccRegisters<Register>::apb2enr, 16},
      {address::kUsart1, &RccRegisters<Register>::apb2enr, 4},
      {address::kUsart2, &RccRegisters<Register>::apb1enr, 17},
      {address::kUsart3, &RccRegisters<Register>::apb1enr, 18},
      {address::kCan1, &RccRegisters<Register>::apb1enr, 25},
      {address::kRandom, &RccRegisters<Register>::ahb2enr, 6},
      {address::kGpioA, &RccRegisters<Register>::ahb1enr, 0},
      {address::kGpioA + 4 * address::kGpioStride, &RccRegisters<Register>::ahb1enr, 4},
  };
  for (const auto& c : cases) {
    RccRegisters<Register> rcc;
    (rcc.*c.reg).value = 1u << 31;
    enable_block(rcc, c.block);
    CHECK((rcc.*c.reg).value == (1u << 31 | 1u << c.bit));
  }
}

TEST_CASE("a random number is the second of the generator, and there is none without its clock") {
  RandomRegisters<Register> random;
  std::uint32_t number = 100;
  int polls = 0;
  random.sr.on_read = [&](std::uint32_t) {
    return (random.cr.value & 4u) != 0 && ++polls % 40 == 0 ? 1u : 0u;
  };
  random.dr.on_read = [&](std::uint32_t) { return number++; };
  // Asked for its flags once more after they said ready: no error then.
  const auto drawn = draw_random(random);
  REQUIRE(drawn.ok());
  CHECK(drawn.value() == 101);
  CHECK(random.cr.value == 0);
  random.sr.on_read = [](std::uint32_t) { return 0u; };
  CHECK(draw_random(random).status() == furcula::Status::disconnected);
  random.sr.on_read = [](std::uint32_t) { return 1u | 1u << 2; };  // SECS: the same bits all the time
  CHECK(draw_random(random).status() == furcula::Status::disconnected);
}
