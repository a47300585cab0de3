// A node through its registers: the arming sequence, what is refused, and what a repeated frame does.
#include "firmware/app/node_registers.hpp"

#include <algorithm>
#include <bit>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "tests/common/bus/node_board.hpp"

using namespace furcula;
using bus::ModbusException;
using bus::NodeState;
using bus::Refusal;
using bus::Request;
using test::Bench;
using Words = std::vector<std::uint16_t>;

namespace {

std::uint16_t input(Bench& b, std::uint16_t address) {
  std::uint16_t word = 0xdead;
  REQUIRE(b.registers.read_input(address, {&word, 1}) == ModbusException::none);
  return word;
}
std::uint16_t session(Bench& b) { return input(b, 5); }

Words request(Bench& b, Request wanted) { return {0x4655, session(b), static_cast<std::uint16_t>(wanted)}; }

Words real(float x) {
  const auto bits = std::bit_cast<std::uint32_t>(x);
  return {static_cast<std::uint16_t>(bits >> 16), static_cast<std::uint16_t>(bits & 0xffff)};
}

constexpr std::uint16_t kAmplitude = 258, kPeriod = 260;

}  // namespace

TEST_CASE("the arming sequence makes it run, and each of its frames does nothing a second time") {
  Bench b;
  b.settle();
  const Words arm = request(b, Request::arm);
  CHECK(b.registers.write_holding(0, arm) == ModbusException::none);
  CHECK(input(b, 1) == static_cast<int>(NodeState::armed));
  const Words hop = request(b, Request::hop);
  CHECK(hop[1] != arm[1]);
  CHECK(b.registers.write_holding(0, hop) == ModbusException::none);
  b.tick(50);
  CHECK(input(b, 1) == static_cast<int>(NodeState::running));
  CHECK(b.registers.write_holding(2, Words{1}) == ModbusException::none);  // stop, alone
  b.tick();
  CHECK(input(b, 1) == static_cast<int>(NodeState::idle));
  for (const Words& recorded : {arm, hop, arm, hop}) {
    CHECK(b.registers.write_holding(0, recorded) == ModbusException::device_failure);
    CHECK(input(b, 4) == static_cast<int>(Refusal::wrong_session));
    b.tick();
    CHECK(input(b, 1) == static_cast<int>(NodeState::idle));
  }
}

TEST_CASE("a host that falls silent stops what it started: torque 0 on the next tick, and it says why") {
  Bench b;
  b.settle();
  CHECK(b.registers.write_holding(0, request(b, Request::arm)) == ModbusException::none);
  CHECK(b.registers.write_holding(0, request(b, Request::hop)) == ModbusException::none);
  float most_nm = 0.0f;
  const auto run = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      b.tick();
      REQUIRE(b.node.state() == NodeState::running);
      most_nm = std::max(most_nm, std::abs(b.board.command.torque_nm));
    }
  };
  // Each kind of request is a sign of life; 2 s after the last one there is none.
  run(1999);
  std::uint16_t word = 0;
  CHECK(b.registers.read_holding(0, {&word, 1}) == ModbusException::none);
  run(1999);
  CHECK(b.registers.identification(0) == "Furcula");
  run(1999);
  CHECK(b.registers.write_holding(kAmplitude, real(1.0f)) != ModbusException::none);
  run(1999);
  CHECK(input(b, 1) == static_cast<int>(NodeState::running));
  run(2000);
  CHECK(most_nm > 1.9f);
  b.tick();
  CHECK(b.board.command.torque_nm == 0.0f);
  CHECK(b.board.command.coil_duty == 0.0f);
  CHECK(input(b, 1) == static_cast<int>(NodeState::idle));
  CHECK(input(b, 2) == static_cast<int>(bus::Reason::host_silent));
  CHECK(b.node.snapshot().stale_stops == 1);
}

TEST_CASE("how long a host may be silent is a parameter, and 0 lets the robot run on") {
  Bench b;
  b.settle();
  const std::uint16_t address = bus::address_of(*bus::parameter_named("host_timeout_s"));
  const auto start = [&] {
    CHECK(b.registers.write_holding(0, request(b, Request::arm)) == ModbusException::none);
    CHECK(b.registers.write_holding(0, request(b, Request::hop)) == ModbusException::none);
  };
  REQUIRE(b.registers.write_holding(address, real(0.1f)) == ModbusException::none);
  start();
  b.tick(100);
  CHECK(b.node.state() == NodeState::running);
  b.tick(2);
  CHECK(b.node.state() == NodeState::idle);
  REQUIRE(b.registers.write_holding(address, real(0.0f)) == ModbusException::none);
  start();
  b.tick(100000);
  CHECK(b.node.state() == NodeState::running);
  CHECK(b.registers.write_holding(address, real(-1.0f)) != ModbusException::none);
}

TEST_CASE("the log of faults is read entry by entry, the newest first, beside start, cause and number") {
  Bench b;
  b.settle();
  CHECK(input(b, 58) == static_cast<int>(bus::ResetCause::watchdog));
  CHECK(input(b, 59) == 0);
  CHECK(input(b, 61) == 1);
  CHECK(input(b, 62) == 0x1111);
  CHECK(input(b, 67) == 0x3333);
  Words entry(4, 0xdead);
  REQUIRE(b.registers.read_input(512, entry) == ModbusException::none);
  CHECK(entry == Words{0, 0, 0, 0});

  b.board.answers = false;
  b.tick(10);  // ticks 60 to 69: one lost sample is bridged
  b.board.answers = true;
  CHECK(b.node.request(Request::reset) == Refusal::none);
  b.tick(10);
  b.board.sample.leg_angle_rad = 1.5f;
  b.tick(1);  // tick 80
  CHECK(input(b, 59) == 2);
  REQUIRE(b.registers.read_input(512, entry) == ModbusException::none);
  CHECK(entry == Words{static_cast<std::uint16_t>(control::Fault::leg_angle_out_of_range), 1, 0, 80});
  REQUIRE(b.registers.read_input(516, entry) == ModbusException::none);
  CHECK(entry == Words{static_cast<std::uint16_t>(control::Fault::peer_lost), 1, 0, 61});
  Words all(32), beyond(33);
  CHECK(b.registers.read_input(512, all) == ModbusException::none);
  CHECK(b.registers.read_input(512, beyond) == ModbusException::illegal_address);
  CHECK(b.registers.read_input(0xffff, entry) == ModbusException::illegal_address);
}

TEST_CASE("no session comes a second time within 65535 requests") {
  Bench b;
  std::vector<bool> seen(65536);
  for (int i = 0; i < 65535; ++i) {
    REQUIRE_FALSE(seen[b.node.session()]);
    seen[b.node.session()] = true;
    b.node.next_session();
  }
  CHECK_FALSE(seen[0]);
}

TEST_CASE("requests with a wrong key, number or shape are refused with their reason") {
  Bench b;
  b.settle();
  Words wrong_key = request(b, Request::arm);
  wrong_key[0] ^= 1;
  CHECK(b.registers.write_holding(0, wrong_key) == ModbusException::device_failure);
  CHECK(input(b, 4) == static_cast<int>(Refusal::wrong_key));
  Words unknown = request(b, Request::arm);
  unknown[2] = 99;
  CHECK(b.registers.write_holding(0, unknown) == ModbusException::illegal_value);
  CHECK(b.registers.write_holding(2, Words{static_cast<std::uint16_t>(Request::arm)}) ==
        ModbusException::illegal_address);
  CHECK(b.registers.write_holding(0, Words{0x4655, session(b)}) == ModbusException::illegal_address);
  CHECK(b.registers.write_holding(0, Words{0x4655, session(b), 4, 0}) == ModbusException::illegal_address);
  CHECK(input(b, 1) == static_cast<int>(NodeState::idle));
}

TEST_CASE("parameters are written whole, several at once, all or none") {
  Bench b;
  b.settle();
  CHECK(b.registers.write_holding(kAmplitude, real(2.5f)) == ModbusException::none);
  CHECK(b.node.config().torque.amplitude_nm == 2.5f);
  Words both = real(3.0f);
  for (const std::uint16_t w : real(0.001f)) both.push_back(w);  // shorter than the bound
  CHECK(b.registers.write_holding(kAmplitude, both) == ModbusException::illegal_value);
  CHECK(b.node.config().torque.amplitude_nm == 2.5f);
  CHECK(input(b, 4) == static_cast<int>(Refusal::value_not_allowed));
  CHECK(b.registers.write_holding(kAmplitude, Words{0x4040}) == ModbusException::illegal_address);
  CHECK(b.registers.write_holding(kAmplitude + 1, Words{0, 0}) == ModbusException::illegal_address);
  CHECK(b.registers.write_holding(kAmplitude, Words{0x7fc0, 0}) == ModbusException::illegal_value);
  Words out(4);
  REQUIRE(b.registers.read_holding(kAmplitude, out) == ModbusException::none);
  CHECK(Words(out.begin(), out.begin() + 2) == real(2.5f));
  CHECK(Words(out.begin() + 2, out.end()) == real(0.3f));
}

TEST_CASE("a parameter that is written while it is armed or runs is refused, and the register says why") {
  Bench b;
  b.start();
  b.tick(5);
  CHECK(b.registers.write_holding(kPeriod, real(0.25f)) == ModbusException::device_failure);
  CHECK(input(b, 4) == static_cast<int>(Refusal::not_in_this_state));
  CHECK(b.node.config().torque.period_s == 0.3f);
}

TEST_CASE("addresses that are none are refused") {
  Bench b;
  Words out(1), two(2);
  CHECK(b.registers.read_input(67, out) == ModbusException::none);
  CHECK(b.registers.read_input(71, out) == ModbusException::illegal_address);
  CHECK(b.registers.read_input(70, two) == ModbusException::illegal_address);
  CHECK(b.registers.read_input(65535, two) == ModbusException::illegal_address);
  CHECK(b.registers.read_holding(2, two) == ModbusException::illegal_address);
  CHECK(b.registers.read_holding(255, two) == ModbusException::illegal_address);
  CHECK(b.registers.read_holding(256 + bus::kParameterWords, out) == ModbusException::illegal_address);
  CHECK(b.registers.write_holding(256 + bus::kParameterWords - 2, Words(4)) ==
        ModbusException::illegal_address);
  CHECK(b.registers.write_holding(65535, two) == ModbusException::illegal_address);
}
