// Serial port, watchdog and flash memory on models of their registers.
#include <catch2/catch.hpp>
#include <deque>
#include <vector>

#include "firmware/chip/stm32f4/slot_flash.hpp"
#include "firmware/chip/stm32f4/supply.hpp"
#include "firmware/chip/stm32f4/usart.hpp"
#include "firmware/chip/stm32f4/watchdog.hpp"
#include "firmware/store/slot_store.hpp"
#include "tests/firmware/chip/model.hpp"

namespace {

using namespace furcula;
using namespace furcula::stm32f4;
using test::Register;

/// Flags of reception are cleared by reading SR and then DR, and only so (30.6.1).
struct UsartModel {
  UsartRegisters<Register> usart;
  bool status_read = false;
  std::vector<std::uint8_t> sent;
  UsartModel() {
    usart.sr.value = 0xc0;  // empty and complete
    usart.sr.on_read = [this](std::uint32_t value) {
      status_read = true;
      return value;
    };
    usart.dr.on_read = [this](std::uint32_t value) {
      if (status_read) usart.sr.value &= ~0x3fu;
      status_read = false;
      return value;
    };
    usart.dr.on_write = [this](std::uint32_t old, std::uint32_t written) {
      CHECK((usart.sr.value & 0x80u) != 0);
      usart.sr.value &= ~0xc0u;
      sent.push_back(static_cast<std::uint8_t>(written));
      return old;
    };
  }
  void arrive(std::uint32_t data, std::uint32_t error = 0) {
    if ((usart.sr.value & 0x20u) != 0)
      usart.sr.value |= 8u;  // the one before was not read: this one is lost
    else
      usart.dr.value = data;
    usart.sr.value |= 0x20u | error;
  }
};

/// Keys in their order unlock; a sector is erased, a word programmed, only while unlocked and with the right
/// bits; errors stay until 1 is written (3.6, 3.9).
struct FlashChip {
  static constexpr std::uint32_t kWords = 1024;
  FlashRegisters<Register> registers;
  PowerRegisters<Register> power;
  Supply<Register> supply{power, registers};
  std::array<std::array<Register, kWords>, 2> sectors;
  int erases_until_sag = -1;  ///< the supply is low after so many
  int busy_polls = 0, erases = 0, cache_flushes = 0;
  std::uint32_t keys = 0;
  std::uint32_t error_next = 0;
  bool stuck = false;

  FlashChip() {
    registers.cr.value = 1u << 31;
    registers.acr.value = 5u | 7u << 8;
    for (auto& sector : sectors)
      for (auto& word : sector) word.value = 0x1234'5678;
    registers.keyr.on_write = [this](std::uint32_t, std::uint32_t key) {
      if (keys == 0 && key == 0x4567'0123u)
        keys = 1;
      else if (keys == 1 && key == 0xcdef'89abu)
        registers.cr.value &= ~(1u << 31), keys = 0;
      else
        keys = 2;  // locked until a reset
      return 0u;
    };
    registers.sr.on_read = [this](std::uint32_t value) {
      return value | (stuck || (busy_polls > 0 && --busy_polls > 0) ? 1u << 16 : 0u);
    };
    registers.sr.on_write = [](std::uint32_t old, std::uint32_t written) { return old & ~(written & 0xf3u); };
    registers.cr.on_write = [this](std::uint32_t old, std::uint32_t written) {
      if ((old >> 31 & 1u) != 0) return old;
      if ((written >> 16 & 1u) != 0 && (written & 2u) != 0) {
        const std::uint32_t number = written >> 3 & 0xfu;
        CHECK((number == 4 || number == 5));
        CHECK((written >> 8 & 3u) == 2);  // PSIZE: 32 bits
        if (error_next == 0)
          for (auto& word : sectors[number - 4]) word.value = 0xffff'ffffu;
        registers.sr.value |= error_next;
        error_next = 0;
        busy_polls = 20;
        ++erases;
        if (erases == erases_until_sag) power.csr.value |= 4u;
        written &= ~(1u << 16);
      }
      return written;
    };
    registers.acr.on_write = [this](std::uint32_t old, std::uint32_t written) {
      if ((written >> 12 & 1u) != 0) {
        CHECK((old >> 10 & 1u) == 0);  // only while the cache is off
        ++cache_flushes;
      }
      return written;
    };
    for (auto& sector : sectors)
      for (auto& word : sector)
        word.on_write = [this](std::uint32_t old, std::uint32_t written) {
          const bool may = (registers.cr.value >> 31 & 1u) == 0 && (registers.cr.value & 0x301u) == 0x201u;
          if (!may) registers.sr.value |= 1u << 7;  // PGSERR
          registers.sr.value |= error_next;
          const bool bad = error_next != 0 || !may;
          error_next = 0;
          busy_polls = 3;
          return bad ? old : old & written;
        };
  }
  SlotFlash<Register> flash() {
    return {registers, supply, {{{4, sectors[0].data()}, {5, sectors[1].data()}}}};
  }
};

static_assert(firmware::SlotFlash<SlotFlash<Register>>);

}  // namespace

TEST_CASE("the baud rate is within half a step of the manual's formula") {
  for (const std::uint32_t clock_hz : {42'000'000u, 84'000'000u, 16'000'000u})
    for (const std::uint32_t baud : {9600u, 19'200u, 38'400u, 57'600u, 115'200u}) {
      UsartModel model;
      Usart<Register> port(model.usart);
      port.start(clock_hz, baud, Parity::even);
      // 30.3.4: baud = f(CK) / (16 USARTDIV), the divider's fraction in the lowest four bits.
      const std::uint32_t brr = model.usart.brr.value;
      const double divider = (brr >> 4) + (brr & 0xf) / 16.0;
      CHECK(clock_hz / (16.0 * divider) == Approx(baud).epsilon(0.005));
      CHECK(model.usart.cr1.value == (1u << 13 | 1u << 12 | 1u << 10 | 1u << 3 | 1u << 2));
    }
  UsartModel model;
  Usart<Register>(model.usart).start(42'000'000, 115'200, Parity::none);
  CHECK(model.usart.brr.value == 365);  // table 136: 22.8125 = 22 + 13/16
  CHECK(model.usart.cr1.value == (1u << 13 | 1u << 3 | 1u << 2));
}

TEST_CASE("bytes are taken once, and spoilt and lost ones are told apart and counted") {
  UsartModel model;
  Usart<Register> port(model.usart);
  CHECK(port.receive().status() == Status::disconnected);
  model.arrive(0x155);  // with the parity's bit
  REQUIRE(port.receive().ok());
  CHECK(port.receive().status() == Status::disconnected);
  for (const std::uint32_t error : {1u, 2u, 4u}) {
    model.arrive(0x11, error);
    CHECK(port.receive().status() == Status::invalid);
    CHECK(port.receive().status() == Status::disconnected);
  }
  model.arrive(0x22);
  model.arrive(0x33);
  CHECK(port.receive().status() == Status::invalid);
  const UsartErrors& e = port.errors();
  CHECK((e.parity == 1 && e.framing == 1 && e.noise == 1 && e.overrun == 1));
  model.arrive(0x44);
  CHECK(port.receive().value() == 0x44);
}

TEST_CASE("a byte is handed over when there is room, and the line is held until the last stop bit") {
  UsartModel model;
  Usart<Register> port(model.usart);
  CHECK(port.all_sent());
  CHECK(port.send(0x01) == Status::ok);
  CHECK_FALSE(port.all_sent());
  CHECK(port.send(0x02) == Status::disconnected);
  model.usart.sr.value |= 0x80u;  // into the shift register
  CHECK(port.send(0x02) == Status::ok);
  CHECK_FALSE(port.all_sent());
  model.usart.sr.value |= 0xc0u;
  CHECK(port.all_sent());
  CHECK(model.sent == std::vector<std::uint8_t>{1, 2});
}

TEST_CASE(
    "the watchdog bites no earlier than it is told, and not three times later, whatever its oscillator") {
  for (const std::uint32_t shortest_ms : {1u, 5u, 10u, 100u, 1000u, 5000u, 20'000u}) {
    const WatchdogTiming timing = watchdog_timing(shortest_ms);
    REQUIRE(timing.divider <= 6);
    REQUIRE(timing.reload <= 0xfff);
    // 21.3.3: prescaler 4 to 256; it counts from the reload value to 0.
    const double counts = (timing.reload + 1.0) * (4 << timing.divider);
    CHECK(1000.0 * counts / 47'000 >= shortest_ms);
    CHECK(1000.0 * counts / 17'000 < 2.8 * shortest_ms + 0.5);
    CHECK(timing.at_hz_us(17'000) == Approx(1e6 * counts / 17'000).margin(1));
  }
}

TEST_CASE("the watchdog is started, changed and kicked with its keys") {
  WatchdogRegisters<Register> registers;
  int polls = 5;
  registers.sr.on_read = [&](std::uint32_t) { return polls > 0 && --polls > 0 ? 3u : 0u; };
  Watchdog<Register> watchdog(registers);
  REQUIRE(watchdog.start(watchdog_timing(10)) == Status::ok);
  CHECK(registers.kr.writes == std::vector<std::uint32_t>{0xcccc, 0x5555, 0xaaaa});
  CHECK(registers.pr.value == watchdog_timing(10).divider);
  CHECK(registers.rlr.value == watchdog_timing(10).reload);
  REQUIRE(watchdog.set(watchdog_timing(5000)) == Status::ok);
  CHECK(registers.pr.value == 4);  // 5 s at 47 kHz: 235,000 cycles are 3672 times 64
  CHECK(registers.rlr.value == 3671);
  watchdog.kick();
  CHECK(registers.kr.writes.back() == 0xaaaa);
  registers.sr.on_read = [](std::uint32_t) { return 3u; };
  CHECK(watchdog.set(watchdog_timing(10)) == Status::disconnected);
}

TEST_CASE("the parameters' store works on the chip's flash memory, and leaves it locked") {
  FlashChip chip;
  auto flash = chip.flash();
  firmware::SlotStore store(flash, 1);
  std::vector<std::uint8_t> bytes(37), seen(37);
  for (int n = 1; n <= 5; ++n) {
    for (auto& byte : bytes) byte = static_cast<std::uint8_t>(byte + n);
    REQUIRE(store.save(bytes) == Status::ok);
    REQUIRE(store.load(seen).reason == firmware::LoadReason::loaded);
    CHECK(seen == bytes);
    CHECK(chip.erases == n);
    CHECK((chip.registers.cr.value >> 31 & 1u) == 1);
  }
  CHECK(chip.cache_flushes == 5);
  CHECK((chip.registers.acr.value & 0x1f00u) == 0x700u);  // the caches are on again
}

TEST_CASE(
    "a memory that reports an error, stays busy or stays locked is reported, and the old record stays") {
  for (const std::uint32_t error : {1u << 1, 1u << 4, 1u << 5, 1u << 6, 1u << 7}) {
    FlashChip chip;
    auto flash = chip.flash();
    REQUIRE(flash.erase(0) == Status::ok);
    REQUIRE(flash.erase(1) == Status::ok);
    firmware::SlotStore store(flash, 1);
    std::vector<std::uint8_t> bytes(8, 1), seen(8);
    REQUIRE(store.save(bytes) == Status::ok);
    chip.error_next = error;
    CHECK(store.save(std::vector<std::uint8_t>(8, 2)) == Status::disconnected);
    REQUIRE(store.load(seen).reason == firmware::LoadReason::loaded);
    CHECK(seen == bytes);
    CHECK(store.save(std::vector<std::uint8_t>(8, 3)) == Status::ok);  // the flag left over does not stop it
  }
  FlashChip chip;
  chip.keys = 2;
  CHECK(chip.flash().erase(0) == Status::disconnected);
  CHECK(chip.flash().program(0, 0, 1) == Status::disconnected);
  CHECK(chip.sectors[0][0].value == 0x1234'5678u);
}

TEST_CASE(
    "the supply's detector is started at its highest threshold, and the other bits of its register stay") {
  PowerRegisters<Register> power;
  FlashRegisters<Register> flash;
  Supply<Register> supply(power, flash);
  power.cr.value = 1u << 14 | 1u << 8 | 2u << 5;  // VOS as after a reset, DBP, and another threshold
  supply.start();
  // 5.4.1: PLS in bits 5 to 7, 7 is 2.9 V; PVDE is bit 4. The threshold stands before the detector is on.
  CHECK(power.cr.value == (1u << 14 | 1u << 8 | 7u << 5 | 1u << 4));
  CHECK((power.cr.writes.front() >> 4 & 1u) == 0);
  power.csr.value = 0;
  CHECK(supply.is_high());
  power.csr.value = 1u << 2;  // 5.4.2: PVDO
  CHECK_FALSE(supply.is_high());
  // 3.9.10: BOR_LEV in bits 2 and 3; 3 is off, as sold, 0 the level of 2.7 to 3.6 V. The word is as sold but for it.
  for (std::uint32_t level = 0; level < 4; ++level) {
    flash.optcr.value = 0x0fff'aae1u | level << 2;
    CHECK(supply.resets_when_low() == (level == 0));
  }
}

TEST_CASE("nothing is erased or programmed with a supply that is low, nor erased without a brown-out reset") {
  FlashChip chip;
  auto flash = chip.flash();
  firmware::SlotStore store(flash, 1);
  const std::vector<std::uint8_t> old(8, 1), wanted(8, 2);
  std::vector<std::uint8_t> seen(8);
  REQUIRE(flash.erase(0) == Status::ok);
  REQUIRE(flash.erase(1) == Status::ok);
  REQUIRE(store.save(old) == Status::ok);
  const int erases = chip.erases;
  SECTION("low") { chip.power.csr.value = 4u; }
  SECTION("no brown-out reset") { chip.registers.optcr.value = 3u << 2; }
  SECTION("too low a one") { chip.registers.optcr.value = 1u << 2; }
  CHECK(store.save(wanted) == Status::disconnected);
  CHECK(chip.erases == erases);
  REQUIRE(store.load(seen).reason == firmware::LoadReason::loaded);
  CHECK(seen == old);
  chip.power.csr.value = chip.registers.optcr.value = 0;
  CHECK(store.save(wanted) == Status::ok);
}

TEST_CASE("a supply that sags while a sector is erased fails the save, and the old record stays") {
  FlashChip chip;
  auto flash = chip.flash();
  firmware::SlotStore store(flash, 1);
  REQUIRE(flash.erase(0) == Status::ok);
  REQUIRE(flash.erase(1) == Status::ok);
  REQUIRE(store.save(std::vector<std::uint8_t>(8, 1)) == Status::ok);
  chip.erases_until_sag = chip.erases + 1;
  CHECK(store.save(std::vector<std::uint8_t>(8, 2)) == Status::disconnected);
  CHECK(flash.program(0, 900, 0) == Status::disconnected);
  chip.power.csr.value = 0;
  chip.erases_until_sag = chip.erases + 1;
  CHECK(flash.erase(1) == Status::disconnected);
  std::vector<std::uint8_t> seen(8);
  REQUIRE(store.load(seen).reason == firmware::LoadReason::loaded);
  CHECK(seen == std::vector<std::uint8_t>(8, 1));
}
