// bxCAN on a model of its mailboxes and FIFOs.
#include "firmware/chip/stm32f4/can.hpp"

#include <catch2/catch.hpp>
#include <deque>
#include <vector>

#include "tests/firmware/chip/model.hpp"

namespace {

using namespace furcula;
using namespace furcula::stm32f4;
using bus::Frame;
using test::Register;

/// Flags of TSR and RFxR are cleared by writing 1; a mailbox is taken by its request bit; a FIFO holds three,
/// and a fourth takes the place of the third (32.7.4, 32.9.2).
struct CanModel {
  CanRegisters<Register> can;
  std::deque<std::array<std::uint32_t, 4>> fifo[2];
  std::vector<std::array<std::uint32_t, 4>> on_bus;
  bool answers = true;    ///< the peripheral has a clock
  bool bus_quiet = true;  ///< 11 recessive bits were seen

  CanModel() {
    can.mcr.value = 0x1'0002;  // asleep after a reset
    can.msr.on_read = [this](std::uint32_t) -> std::uint32_t {
      if (!answers) return 0;
      return (can.mcr.value & 1u) != 0 || !bus_quiet ? 1u : 0u;
    };
    can.tsr.value = 7u << 26;
    can.tsr.on_write = [](std::uint32_t old, std::uint32_t written) {
      for (int box = 0; box < 3; ++box)
        if ((written >> (8 * box + 7) & 1u) != 0) old |= 1u << (26 + box);  // an abort empties it
      return old & ~(written & 0x0f0f0fu);
    };
    for (int box = 0; box < 3; ++box)
      can.transmit[box].identifier.on_write = [this, box](std::uint32_t, std::uint32_t written) {
        CHECK((can.tsr.value >> (26 + box) & 1u) == 1);  // nobody writes to a mailbox that is taken
        if ((written & 1u) != 0) can.tsr.value &= ~(1u << (26 + box));
        return written;
      };
    for (int i = 0; i < 2; ++i) {
      can.rfr[i].on_read = [this, i](std::uint32_t value) {
        return (value & ~3u) | static_cast<std::uint32_t>(fifo[i].size());
      };
      can.rfr[i].on_write = [this, i](std::uint32_t old, std::uint32_t written) {
        if ((written & 1u << 5) != 0 && !fifo[i].empty()) fifo[i].pop_front();
        return old & ~(written & 0x18u);
      };
      const auto head = [this, i](int word) {
        return fifo[i].empty() ? 0xdead'beefu : fifo[i].front()[word];
      };
      can.receive[i].identifier.on_read = [head](std::uint32_t) { return head(0); };
      can.receive[i].length.on_read = [head](std::uint32_t) { return head(1); };
      can.receive[i].data_low.on_read = [head](std::uint32_t) { return head(2); };
      can.receive[i].data_high.on_read = [head](std::uint32_t) { return head(3); };
    }
  }

  void arrive(int i, const std::array<std::uint32_t, 4>& words) {
    if (fifo[i].size() == 3) {
      fifo[i].pop_back();
      can.rfr[i].value |= 1u << 4;
    }
    fifo[i].push_back(words);
  }

  /// The bus takes what waits in a mailbox.
  void transmit(int box) {
    REQUIRE((can.tsr.value >> (26 + box) & 1u) == 0);
    const auto& m = can.transmit[box];
    on_bus.push_back({m.identifier.value, m.length.value, m.data_low.value, m.data_high.value});
    can.tsr.value |= 1u << (26 + box) | 3u << (8 * box);
  }
};

const CanFilter kFilters[] = {{0x000, 0x7ff}, {0x460, 0x7f0}, {0x123, 0x7ff}};

Frame frame_of(std::uint32_t id, std::initializer_list<std::uint8_t> bytes) {
  Frame frame;
  frame.id = id;
  for (const std::uint8_t byte : bytes) frame.data[frame.size++] = byte;
  return frame;
}

}  // namespace

TEST_CASE("1 Mbit/s comes out exactly, with the sample point at three quarters to nine tenths of the bit") {
  for (const std::uint32_t clock_hz : {42'000'000u, 16'000'000u, 36'000'000u, 45'000'000u}) {
    const CanTiming timing = can_timing(clock_hz, 1'000'000);
    REQUIRE(timing.exists());
    // 32.7.7, from the bits of the register: t(q) = (BRP + 1) t(PCLK), and the two segments one more each.
    const std::uint32_t btr = timing.btr();
    const double quantum_s = ((btr & 0x3ff) + 1.0) / clock_hz;
    const double before = (btr >> 16 & 0xf) + 1.0, after = (btr >> 20 & 7) + 1.0,
                 jump = (btr >> 24 & 3) + 1.0;
    CHECK(1.0 / (quantum_s * (1 + before + after)) == Approx(1e6).epsilon(1e-12));
    const double sample_point = (1 + before) / (1 + before + after);
    CHECK((sample_point >= 0.75 && sample_point <= 0.90));
    CHECK(jump <= after);
  }
  // 42 MHz / 3 = 14 quanta; 12 before the sample point.
  static_assert(can_timing(42'000'000, 1'000'000).btr() == (2u | 10u << 16 | 1u << 20 | 1u << 24));
  CHECK_FALSE(can_timing(7'000'000, 1'000'000).exists());
  CHECK_FALSE(can_timing(42'000'001, 1'000'000).exists());
}

TEST_CASE("start sets timing and filters while the peripheral is initialising, and then joins the bus") {
  CanModel model;
  Can<Register> can(model.can);
  model.can.btr.on_write = [&](std::uint32_t, std::uint32_t written) {
    CHECK((model.can.msr & 1u) == 1);
    return written;
  };
  REQUIRE(can.start(can_timing(42'000'000, 1'000'000), kFilters) == Status::ok);
  CHECK(model.can.btr.value == can_timing(42'000'000, 1'000'000).btr());
  CHECK((model.can.mcr.value & 3u) == 0);       // neither initialising nor asleep
  CHECK((model.can.mcr.value >> 6 & 1u) == 1);  // ABOM
  CHECK((model.can.mcr.value >> 2 & 1u) == 1);  // TXFP
  CHECK(model.can.fa1r.value == 7u);
  CHECK(model.can.fs1r.value == 7u);
  CHECK(model.can.fm1r.value == 0u);
  CHECK(model.can.ffa1r.value == 2u);
  CHECK(model.can.filter[1][0].value == 0x460u << 21);
  CHECK(model.can.filter[1][1].value == (0x7f0u << 21 | 6u));
  CHECK((model.can.fmr.value & 1u) == 0);
  CHECK(can.joined());
}

TEST_CASE(
    "a peripheral that does not answer is reported, a bus that is not there yet is waited for by nobody") {
  CanModel model;
  model.answers = false;
  Can<Register> can(model.can);
  CHECK(can.start(can_timing(42'000'000, 1'000'000), kFilters) == Status::disconnected);
  model.answers = true;
  model.bus_quiet = false;
  CHECK(can.start(can_timing(42'000'000, 1'000'000), kFilters) == Status::ok);
  CHECK_FALSE(can.joined());
  model.bus_quiet = true;
  CHECK(can.joined());
  CHECK(can.start({}, kFilters) == Status::invalid);
  const std::vector<CanFilter> many(15);
  CHECK(can.start(can_timing(42'000'000, 1'000'000), many) == Status::invalid);
}

TEST_CASE("frames go into the three mailboxes as the manual lays them out, and a fourth is refused at once") {
  CanModel model;
  Can<Register> can(model.can);
  REQUIRE(can.start(can_timing(42'000'000, 1'000'000), kFilters) == Status::ok);
  CHECK(can.send(frame_of(0x123, {1, 2, 3, 4, 5, 6, 7, 8})) == Status::ok);
  Frame extended = frame_of(0x1234'5678, {0xaa});
  extended.extended = true;
  CHECK(can.send(extended) == Status::ok);
  Frame remote;
  remote.id = 0x7ff;
  remote.size = 4;
  remote.remote = true;
  CHECK(can.send(remote) == Status::ok);
  CHECK(can.send(frame_of(1, {})) == Status::disconnected);
  for (int box = 0; box < 3; ++box) model.transmit(box);
  // 32.9.3 CAN_TIxR: STID in bits 31 to 21, or EXID in 31 to 3; IDE 2, RTR 1, TXRQ 0. CAN_TDLxR: byte 0
  // lowest.
  CHECK(model.on_bus[0] == std::array<std::uint32_t, 4>{0x123u << 21 | 1, 8, 0x0403'0201u, 0x0807'0605u});
  CHECK(model.on_bus[1] == std::array<std::uint32_t, 4>{0x1234'5678u << 3 | 5, 1, 0xaau, 0});
  CHECK(model.on_bus[2] == std::array<std::uint32_t, 4>{0x7ffu << 21 | 3, 4, 0, 0});
  CHECK(can.send(frame_of(1, {})) == Status::ok);
}

TEST_CASE("what has not gone out can be taken back") {
  CanModel model;
  Can<Register> can(model.can);
  REQUIRE(can.start(can_timing(42'000'000, 1'000'000), kFilters) == Status::ok);
  for (int i = 0; i < 3; ++i) REQUIRE(can.send(frame_of(1, {})) == Status::ok);
  model.transmit(1);
  can.abort_pending();
  CHECK((model.can.tsr.value >> 26 & 7u) == 7u);
  CHECK(model.on_bus.size() == 1);
}

TEST_CASE("frames that cannot be are refused") {
  CanModel model;
  Can<Register> can(model.can);
  Frame frame = frame_of(0x800, {});
  CHECK(can.send(frame) == Status::invalid);
  frame.extended = true;
  CHECK(can.send(frame) == Status::ok);
  frame.id = 0x2000'0000;
  CHECK(can.send(frame) == Status::invalid);
  frame = frame_of(1, {});
  frame.size = 9;
  CHECK(can.send(frame) == Status::invalid);
}

TEST_CASE("frames are received from both FIFOs, in order, and what came too much is counted") {
  CanModel model;
  Can<Register> can(model.can);
  REQUIRE(can.start(can_timing(42'000'000, 1'000'000), kFilters) == Status::ok);
  CHECK(can.receive().status() == Status::disconnected);
  model.arrive(0, {0x000u << 21, 6, 0x4433'2211u, 0xffff'6655u});
  model.arrive(1, {0x461u << 21, 8, 0x0403'0201u, 0x0807'0605u});
  model.arrive(1, {0x1555'5555u << 3 | 4u | 2u, 0xf, 1, 2});
  const auto first = can.receive();
  REQUIRE(first.ok());
  CHECK(first.value() == frame_of(0, {0x11, 0x22, 0x33, 0x44, 0x55, 0x66}));
  CHECK(can.receive().value() == frame_of(0x461, {1, 2, 3, 4, 5, 6, 7, 8}));
  const auto third = can.receive();
  REQUIRE(third.ok());
  CHECK((third.value().extended && third.value().remote && third.value().id == 0x1555'5555u));
  CHECK(third.value().size == 8);                              // a length code of 9 to 15 is 8 bytes
  CHECK(third.value().data == std::array<std::uint8_t, 8>{});  // a remote frame carries none
  CHECK_FALSE(can.receive().ok());

  for (std::uint32_t i = 0; i < 5; ++i) model.arrive(0, {i << 21, 0, 0, 0});
  CHECK(can.receive().value().id == 0);
  CHECK(can.receive().value().id == 1);
  CHECK(can.receive().value().id == 4);
  CHECK_FALSE(can.receive().ok());
  CHECK(can.overruns() == 1);
}

TEST_CASE("the error counters are those of the manual's register") {
  CanModel model;
  const Can<Register> can(model.can);
  model.can.esr.value = 0x60u << 24 | 0x88u << 16 | 3u << 4 | 7u;  // 32.9.2 CAN_ESR
  const CanErrors e = can.errors();
  CHECK((e.receive == 0x60 && e.transmit == 0x88 && e.last_code == 3));
  CHECK((e.warning && e.passive && e.bus_off));
  model.can.esr.value = 0;
  CHECK_FALSE(can.errors().bus_off);
}

TEST_CASE("an error on the bus is told once") {
  CanModel model;
  Can<Register> can(model.can);
  // Only the code of the last error can be written (32.9.2 CAN_ESR).
  model.can.esr.on_write = [](std::uint32_t old, std::uint32_t written) {
    return (old & ~0x70u) | (written & 0x70u);
  };
  model.can.esr.value = 0x0100'0000u | 3u << 4;
  CHECK(can.take_error());
  CHECK_FALSE(can.take_error());
  CHECK(model.can.esr.value == (0x0100'0000u | 7u << 4));
  model.can.esr.value = 0;  // a frame went well
  CHECK_FALSE(can.take_error());
}
