// The node: what it takes in which state, what makes it stop, what it says of itself.
#include "firmware/app/node.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "tests/common/bus/node_board.hpp"

using namespace furcula;
using bus::NodeState;
using bus::Reason;
using bus::Refusal;
using bus::Request;
using test::Bench;

namespace {

/// As flash memory is.
struct WornStore : test::MemoryStore {
  Refusal why = Refusal::none;
  Refusal may_save() const { return why; }
};
static_assert(firmware::WearingStore<WornStore> && !firmware::WearingStore<test::MemoryStore>);

}  // namespace

TEST_CASE("a node starts idle, with torque 0 for as long as nobody arms it") {
  Bench b;
  CHECK(b.node.state() == NodeState::starting);
  CHECK(b.node.reason() == Reason::starting);
  for (int i = 0; i < 5000; ++i) {
    b.tick();
    REQUIRE(b.board.command.torque_nm == 0.0f);
    REQUIRE(b.board.command.coil_duty == 0.0f);
  }
  CHECK(b.node.state() == NodeState::idle);
  CHECK(b.node.reason() == Reason::idle);
  CHECK(b.node.snapshot().uptime_ms == 4999);
}

TEST_CASE("armed and told to hop it commands a torque, and stop takes it away on the next tick") {
  Bench b;
  b.settle();
  CHECK(b.node.request(Request::hop) == Refusal::not_in_this_state);
  b.tick(100);
  CHECK(b.board.command.torque_nm == 0.0f);
  REQUIRE(b.node.request(Request::arm) == Refusal::none);
  b.tick(100);
  CHECK(b.node.state() == NodeState::armed);
  CHECK(b.board.command.torque_nm == 0.0f);
  REQUIRE(b.node.request(Request::hop) == Refusal::none);
  float most_nm = 0.0f;
  for (int i = 0; i < 300; ++i) {
    b.tick();
    most_nm = std::max(most_nm, std::abs(b.board.command.torque_nm));
  }
  CHECK(most_nm == Approx(2.0f).margin(0.01));  // the harmonic's amplitude
  CHECK(b.node.reason() == Reason::none);
  REQUIRE(b.node.request(Request::stop) == Refusal::none);
  b.tick();
  CHECK(b.board.command.torque_nm == 0.0f);
  CHECK(b.node.state() == NodeState::idle);
  CHECK(b.node.reason() == Reason::stopped);
}

TEST_CASE("an armed robot that is not told to hop within 2 s is idle again") {
  Bench b;
  b.settle();
  REQUIRE(b.node.request(Request::arm) == Refusal::none);
  b.tick(2000);
  CHECK(b.node.state() == NodeState::armed);
  b.tick(2);
  CHECK(b.node.state() == NodeState::idle);
  CHECK(b.node.reason() == Reason::arming_expired);
  CHECK(b.node.request(Request::hop) == Refusal::not_in_this_state);
}

TEST_CASE("a fault stops it within two ticks, stays until a reset, and hopping needs arming once more") {
  Bench b;
  b.start();
  b.tick(75);
  REQUIRE(std::abs(b.board.command.torque_nm) > 0.5f);
  b.board.answers = false;
  b.tick(2);
  CHECK(b.board.command.torque_nm == 0.0f);
  CHECK(b.node.state() == NodeState::fault);
  CHECK(b.node.reason() == Reason::fault);
  CHECK(b.node.snapshot().fault == static_cast<int>(control::Fault::peer_lost));
  CHECK(b.node.request(Request::arm) == Refusal::not_in_this_state);
  // While the cause stands a reset does nothing.
  REQUIRE(b.node.request(Request::reset) == Refusal::none);
  b.tick(5);
  CHECK(b.node.state() == NodeState::fault);
  b.board.answers = true;
  b.tick(100);
  CHECK(b.node.state() == NodeState::fault);
  REQUIRE(b.node.request(Request::reset) == Refusal::none);
  b.tick(100);
  CHECK(b.node.state() == NodeState::idle);
  CHECK(b.board.command.torque_nm == 0.0f);
  CHECK(b.node.snapshot().missed_samples == 7);
}

TEST_CASE("parameters are written when idle and refused when armed or running") {
  Bench b;
  b.settle();
  control::Config config = b.node.config();
  config.torque.amplitude_nm = 3.0f;
  REQUIRE(b.node.configure(config) == Refusal::none);
  CHECK(b.node.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::changed));
  config.torque.amplitude_nm = 4.0f;
  REQUIRE(b.node.request(Request::arm) == Refusal::none);
  CHECK(b.node.configure(config) == Refusal::not_in_this_state);
  CHECK(b.node.request(Request::save) == Refusal::not_in_this_state);
  CHECK(b.node.request(Request::load_defaults) == Refusal::not_in_this_state);
  CHECK(b.node.request(Request::home) == Refusal::not_in_this_state);
  REQUIRE(b.node.request(Request::hop) == Refusal::none);
  CHECK(b.node.configure(config) == Refusal::not_in_this_state);
  CHECK(b.node.request(Request::reset) == Refusal::not_in_this_state);
  CHECK(b.node.config().torque.amplitude_nm == 3.0f);
  CHECK(b.node.snapshot().requests_refused == 6);
  CHECK(b.node.snapshot().last_refusal == static_cast<int>(Refusal::not_in_this_state));
  CHECK(b.store.saves == 0);
}

TEST_CASE("what was saved is there after a restart, and the defaults can be had back") {
  Bench first;
  first.settle();
  control::Config config = first.node.config();
  config.torque.amplitude_nm = 3.0f;
  REQUIRE(first.node.configure(config) == Refusal::none);
  REQUIRE(first.node.request(Request::save) == Refusal::none);
  CHECK(first.node.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::store));

  Bench second(first.store);
  CHECK(second.node.config().torque.amplitude_nm == 3.0f);
  CHECK(second.node.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::store));
  second.settle();
  REQUIRE(second.node.request(Request::load_defaults) == Refusal::none);
  CHECK(second.node.config().torque.amplitude_nm == 2.0f);
  CHECK(Bench(second.store).node.config().torque.amplitude_nm == 3.0f);  // until it is saved
}

TEST_CASE("a store that takes long is no fault, and one that fails is told") {
  Bench b;
  b.settle();
  REQUIRE(b.node.request(Request::save) == Refusal::none);
  b.board.clock_us += 300000;  // a sector's erase
  b.tick(1);
  CHECK(b.node.state() == NodeState::starting);
  b.settle();
  CHECK(b.node.state() == NodeState::idle);
  b.store.save_status = Status::disconnected;
  CHECK(b.node.request(Request::save) == Refusal::store_failed);
}

TEST_CASE("a damaged store, and one whose image makes no sense, leave the defaults") {
  test::MemoryStore kept;
  kept.load_status = Status::invalid;
  CHECK(Bench(kept).node.snapshot().parameter_origin ==
        static_cast<int>(bus::ParameterOrigin::store_unusable));
  kept.load_status = Status::ok;
  kept.image = {1, 1, 2, 0, 0, 0, 0xc0, 0x7f};
  Bench b(kept);
  CHECK(b.node.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::store_unusable));
  CHECK(b.node.config().torque.amplitude_nm == 2.0f);
}

TEST_CASE("homing on the ground takes the height from the leg's angle, and the fault can then be cleared") {
  Bench b;
  b.board.sample.home_height_m = std::numeric_limits<float>::quiet_NaN();
  b.board.sample.height_count = 0xfffffff0u;
  b.board.sample.cable_count = 77;
  b.tick(1100);
  CHECK(b.node.state() == NodeState::fault);
  CHECK(b.node.snapshot().fault == static_cast<int>(control::Fault::non_finite_input));
  b.board.sample.contact = 0;
  b.tick();
  CHECK(b.node.request(Request::home) == Refusal::not_on_the_ground);
  b.board.sample.contact = 1;
  b.tick();
  REQUIRE(b.node.request(Request::home) == Refusal::none);
  REQUIRE(b.node.request(Request::reset) == Refusal::none);
  b.tick(2);
  CHECK(b.node.state() == NodeState::idle);
  CHECK(b.node.snapshot().height_m == Approx(0.22f).margin(1e-5));  // 2 x 0.15 cos(0.747584)
  CHECK(b.node.snapshot().velocity_mps == 0.0f);
  b.board.sample.height_count += 100;  // over the wrap of the counter
  b.tick();
  CHECK(b.node.snapshot().height_m == Approx(0.22f + 100 * 0.00009f).margin(1e-5));
}

TEST_CASE("a stream starts it at the change to hop, and stops it when it says so or falls silent") {
  Bench b;
  b.settle();
  const firmware::StreamCommand none{}, stop{Request::stop}, hop{Request::hop, 3.0f, 0.25f, false};
  CHECK(b.node.stream(hop) == Refusal::no_edge);  // the first that was ever heard
  CHECK(b.node.stream(hop) == Refusal::no_edge);
  b.tick(10);
  CHECK(b.node.state() == NodeState::idle);
  CHECK(b.node.stream(none) == Refusal::none);
  b.tick(10);
  CHECK(b.node.stream(hop) == Refusal::no_edge);  // hop was said 20 ms ago
  for (int i = 0; i < 11; ++i) {
    b.tick(10);
    CHECK(b.node.stream(none) == Refusal::none);
  }
  REQUIRE(b.node.stream(hop) == Refusal::none);
  CHECK(b.node.config().torque.amplitude_nm == 3.0f);
  for (int i = 0; i < 100; ++i) {
    b.tick(10);
    CHECK(b.node.stream(hop) == Refusal::none);
  }
  CHECK(b.node.state() == NodeState::running);
  SECTION("silence") {
    b.tick(100);
    CHECK(b.node.state() == NodeState::running);
    b.tick(1);
    CHECK(b.node.state() == NodeState::idle);
    CHECK(b.board.command.torque_nm == 0.0f);
    CHECK(b.node.reason() == Reason::stream_silent);
    CHECK(b.node.snapshot().stale_stops == 1);
    CHECK(b.node.stream(hop) == Refusal::no_edge);  // the stream is back, and starts nothing
    b.tick();
    CHECK(b.node.stream(hop) == Refusal::no_edge);
    CHECK(b.node.state() == NodeState::idle);
  }
  SECTION("none") {
    b.node.stream(none);
    CHECK(b.node.state() == NodeState::idle);
  }
  SECTION("stop") {
    b.node.stream(stop);
    b.tick();
    CHECK(b.node.reason() == Reason::stopped);
  }
  SECTION("a fault, and its reset while the stream still says hop") {
    b.board.answers = false;
    b.tick(3);
    b.board.answers = true;
    b.tick(3);
    CHECK(b.node.stream(hop) == Refusal::no_edge);
    REQUIRE(b.node.request(Request::reset) == Refusal::none);
    b.tick(2);
    CHECK(b.node.stream(hop) == Refusal::no_edge);
    b.tick(2);
    CHECK(b.node.state() == NodeState::idle);
  }
}

TEST_CASE("a stream with an amplitude out of bounds starts nothing") {
  Bench b;
  b.settle();
  b.node.stream({});
  b.tick();
  CHECK(b.node.stream({Request::hop, std::nanf(""), 0.3f, false}) == Refusal::value_not_allowed);
  CHECK(b.node.state() == NodeState::idle);
  b.tick(100);
  b.node.stream({});
  b.tick();
  CHECK(b.node.stream({Request::hop, 2.0f, 0.0f, false}) == Refusal::value_not_allowed);
  CHECK(b.node.config().torque.period_s == 0.3f);
}

TEST_CASE("what a person started does not depend on a stream, but a stream's stop stops it") {
  Bench b;
  b.start();
  b.node.stream({});
  b.tick(500);
  CHECK(b.node.state() == NodeState::running);
  b.node.stream({Request::stop});
  CHECK(b.node.state() == NodeState::idle);
}

TEST_CASE("a hop that comes in the same tick as a stop starts nothing, whoever said the stop") {
  for (const bool holds : {false, true}) {
    Bench b;
    b.settle();
    b.tick(100);
    b.node.stream({});
    b.tick();
    b.node.stop_from_anyone(holds);
    CHECK(b.node.stream({Request::hop, 2.0f, 0.3f, false}) == Refusal::stop_stands);
    CHECK(b.node.state() == NodeState::idle);
    b.tick();
    CHECK(b.node.stream({Request::hop, 2.0f, 0.3f, false}) == Refusal::no_edge);  // it must let go first
  }
}

TEST_CASE("a running robot without a torque says why it does not move") {
  Bench b({}, control::Config{});
  b.start();
  b.tick(10);
  CHECK(b.node.state() == NodeState::running);
  CHECK(b.node.reason() == Reason::no_torque);
}

TEST_CASE("a robot that stands still under a constant torque says why it does not move") {
  control::Config config = test::harmonic_torque();
  config.torque.shape = control::ProfileShape::constant;
  Bench b({}, config);
  b.start();
  b.tick(500);
  CHECK(b.node.reason() == Reason::none);  // as long as a stance may take
  b.tick(600);
  CHECK(b.node.reason() == Reason::standing_still);
}

TEST_CASE("a controller whose configuration makes no sense is in its fault at once") {
  control::Config config = test::harmonic_torque();
  config.height.metres_per_count = 0.0f;
  Bench b({}, config);
  b.tick(2);
  CHECK(b.node.state() == NodeState::fault);
  CHECK(b.node.request(Request::arm) == Refusal::not_in_this_state);
}

TEST_CASE("on the bench arm and hop make one trial, which is kept row by row, then it is idle and says so") {
  control::Config config;
  config.bench = {.on_bench = 1, .rest_ticks = 5, .window_ticks = 10, .watch_ticks = 20};
  config.clutch.metres_per_count = 1e-5f;
  test::Bench b({}, config);
  b.board.sample.leg_angle_rad = 9.0f;  // there is no leg
  b.board.sample.cable_count = 5000;
  b.settle();
  CHECK(b.node.request(bus::Request::home) == bus::Refusal::none);
  CHECK(b.node.request(bus::Request::arm) == bus::Refusal::none);
  CHECK(b.node.request(bus::Request::hop) == bus::Refusal::none);
  for (std::uint32_t row = 0; row < 36; ++row) {
    CHECK(b.node.state() == bus::NodeState::running);
    b.board.sample.cable_count = 5000 + row * row;
    b.tick();
  }
  CHECK(b.node.state() == bus::NodeState::idle);
  CHECK(b.node.reason() == bus::Reason::trial_ended);
  b.tick(50);
  std::array<std::uint16_t, 2> head{};
  REQUIRE(b.registers.read_input(bus::kTrialNumberAddress, head) == bus::ModbusException::none);
  CHECK(head == std::array<std::uint16_t, 2>{1, 36});
  std::array<std::uint16_t, 36> counts{}, coil{};
  REQUIRE(b.registers.read_input(bus::kTrialCountBase, counts) == bus::ModbusException::none);
  REQUIRE(b.registers.read_input(bus::kTrialCoilBase, coil) == bus::ModbusException::none);
  for (std::uint16_t row = 0; row < 36; ++row) {
    CHECK(counts[row] == row * row);
    CHECK(coil[row] == (row >= 5 && row < 15 ? 100 : 0));
  }
  std::uint16_t none = 0;
  CHECK(b.registers.read_input(1026, {&none, 1}) == bus::ModbusException::illegal_address);
  CHECK(b.registers.read_input(bus::kTrialCoilBase + bus::kTrialRowsMost - 1, head) ==
        bus::ModbusException::illegal_address);
}

TEST_CASE("a trial that is stopped switches the coil off, its rows end there") {
  control::Config config;
  config.bench.on_bench = 1;
  test::Bench b({}, config);
  b.start();
  b.tick(30);
  CHECK(b.board.command.coil_duty > 0.0f);
  CHECK(b.node.reason() == bus::Reason::trial);
  static_cast<void>(b.node.request(bus::Request::stop));
  b.tick();
  CHECK(b.board.command.coil_duty == 0.0f);
  std::uint16_t rows = 0;
  REQUIRE(b.registers.read_input(bus::kTrialRowsAddress, {&rows, 1}) == bus::ModbusException::none);
  CHECK(rows == 30);
}

TEST_CASE("a stop beside the stream stops the robot, and the stream that goes on does not start it again") {
  Bench b;
  b.settle();
  const firmware::StreamCommand none{}, hop{Request::hop, 3.0f, 0.25f, false};
  const auto stream = [&](const firmware::StreamCommand& command, int times) {
    Refusal last = Refusal::none;
    for (int i = 0; i < times; ++i) {
      last = b.node.stream(command);
      b.tick(10);
    }
    return last;
  };
  stream(none, 2);
  REQUIRE(stream(hop, 10) == Refusal::none);
  REQUIRE(b.node.state() == NodeState::running);
  b.node.stop_from_anyone(true);
  b.tick();
  CHECK(b.board.command.torque_nm == 0.0f);
  CHECK(b.node.reason() == Reason::stopped);
  CHECK(stream(hop, 500) == Refusal::no_edge);
  CHECK(b.node.state() == NodeState::idle);
  SECTION("letting go for less than 100 ms is not enough") {
    stream(none, 9);
    CHECK(b.node.stream(hop) == Refusal::no_edge);
  }
  SECTION("neither is letting go while the stop still stands") {
    stream(none, 15);
    b.node.stop_from_anyone(true);
    stream(none, 9);
    CHECK(b.node.stream(hop) == Refusal::stop_stands);
    b.tick(200);
    CHECK(b.node.state() == NodeState::idle);
  }
  SECTION("nor a hop behind a command that is missing") {
    stream(none, 15);
    firmware::StreamCommand late = hop;
    late.follows = false;
    CHECK(b.node.stream(late) == Refusal::no_edge);
  }
  SECTION("nor while somebody else says hop") {
    for (int i = 0; i < 20; ++i) {
      stream(none, 1);
      b.node.note_hop_said();
    }
    CHECK(b.node.stream(hop) == Refusal::no_edge);
  }
  SECTION("letting go for longer is") {
    stream(none, 11);
    CHECK(b.node.stream(hop) == Refusal::none);
    CHECK(b.node.state() == NodeState::running);
  }
}

TEST_CASE(
    "hop over the registers is refused while somebody says stop, and a stop that came again does not hold") {
  Bench b;
  b.settle();
  REQUIRE(b.node.request(Request::arm) == Refusal::none);
  b.node.stop_from_anyone(true);
  CHECK(b.node.state() == NodeState::idle);
  REQUIRE(b.node.request(Request::arm) == Refusal::none);
  b.tick(100);
  CHECK(b.node.request(Request::hop) == Refusal::stop_stands);
  b.tick(1);
  REQUIRE(b.node.request(Request::hop) == Refusal::none);
  b.tick();
  b.node.stop_from_anyone(false);
  CHECK(b.node.state() == NodeState::idle);
  REQUIRE(b.node.request(Request::arm) == Refusal::none);
  CHECK(b.node.request(Request::hop) == Refusal::stop_stands);  // in the same tick
  b.tick();
  CHECK(b.node.request(Request::hop) == Refusal::none);
}

TEST_CASE(
    "a store that wears is saved to as long as it bears it and not too often, with a reason for each refusal") {
  test::StandingBoard board;
  WornStore store;
  firmware::FaultLog faults{};
  faults.begin();
  firmware::Node<test::StandingBoard, WornStore> node(board, store, test::harmonic_torque(),
                                                      test::kTestIdentity, 1, faults);
  const auto save = [&] {
    for (int i = 0; i < 100; ++i) node.tick();
    return node.request(Request::save);
  };
  for (const Refusal why : {Refusal::store_worn, Refusal::supply_low, Refusal::brown_out_off}) {
    store.why = why;
    CHECK(save() == why);
    CHECK(node.snapshot().last_refusal == static_cast<std::uint16_t>(why));
    CHECK(node.state() == NodeState::idle);
  }
  CHECK(store.saves == 0);
  store.why = Refusal::none;
  for (int i = 0; i < 10; ++i) CHECK(save() == Refusal::none);
  CHECK(save() == Refusal::saved_too_often);
  CHECK(store.saves == 10);
  CHECK(node.state() == NodeState::idle);  // what was refused did not start it anew
  for (int i = 0; i < 600'000; ++i) node.tick();
  CHECK(save() == Refusal::none);
  CHECK(save() == Refusal::saved_too_often);
}

TEST_CASE("a robot that hops is not disturbed by ticks that wrap after 49.7 days") {
  // The board's clock of microseconds, which wraps after 71.6 minutes, wraps in each of these tests.
  test::StandingBoard board;
  test::MemoryStore store;
  firmware::FaultLog faults{};
  faults.begin();
  const std::uint32_t first = 0u - 1500u;
  firmware::Node<test::StandingBoard, test::MemoryStore> node(board, store, test::harmonic_torque(),
                                                              test::kTestIdentity, 1, faults, first);
  for (int i = 0; i < 60; ++i) node.tick();
  CHECK(node.snapshot().uptime_ms == first + 59);
  REQUIRE(node.request(Request::arm) == Refusal::none);
  REQUIRE(node.request(Request::hop) == Refusal::none);
  Bench other;  // the same robot far from the wrap
  other.start();
  for (int i = 0; i < 3000; ++i) {
    node.hear_host();
    other.node.hear_host();
    node.tick();
    const float torque_nm = board.command.torque_nm;
    other.tick();
    REQUIRE(torque_nm == other.board.command.torque_nm);
    REQUIRE(node.state() == NodeState::running);
  }
  CHECK(node.snapshot().uptime_ms == 1559);
  for (int i = 0; i < 2010; ++i) node.tick();
  CHECK(node.reason() == Reason::host_silent);
}

TEST_CASE(
    "a late tick is a fault also where the number of the tick is 0 again, and its entry is no unknown one") {
  for (const std::uint32_t until : {0u, 0xffffffffu}) {
    test::StandingBoard board;
    test::MemoryStore store;
    firmware::FaultLog faults{};
    faults.begin();
    firmware::Node<test::StandingBoard, test::MemoryStore> node(board, store, test::harmonic_torque(),
                                                                test::kTestIdentity, 1, faults, until - 100u);
    for (int i = 0; i < 100; ++i) node.tick();
    REQUIRE(node.snapshot().fault == 0);
    board.period_us = 2000;
    node.tick();
    CHECK(node.snapshot().uptime_ms == until);
    CHECK(node.snapshot().fault == static_cast<std::uint16_t>(control::Fault::late_tick));
    REQUIRE(faults.count() == 1);
    CHECK(faults.entry(0).tick != bus::kNoTick);
    CHECK(until - faults.entry(0).tick <= 1);
  }
}
