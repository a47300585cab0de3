// The board between the application and a bus and lines that are doubles.
#include "boards/linux_sbc/board.hpp"

#include <linux/can/error.h>

#include <catch2/catch.hpp>
#include <cerrno>
#include <cmath>

#include "firmware/app/node.hpp"
#include "furcula/bus/codec.hpp"
#include "furcula/bus/messages.hpp"
#include "host/core/parameter_file.hpp"
#include "host/rig/peers.hpp"
#include "tests/boards/linux_sbc/doubles.hpp"

#ifdef FURCULA_COUNTS_ALLOCATIONS
extern "C" unsigned long furcula_allocations();
#endif

using namespace furcula;
using namespace furcula::test;

namespace {

linux_sbc::Configuration wiring() {
  linux_sbc::Configuration c;
  c.home_count = 1000;
  c.home_height_m = 0.28f;
  return c;
}

struct Bench {
  explicit Bench(const linux_sbc::Configuration& c = wiring()) : configuration(c) {}
  /// A drive at 0.35 rad and an encoder at home answer.
  void devices_answer() {
    if (const auto reply = drive.receive(bus::empty_frame(bus::message::kMotorExit, 1), 0.35f, 0.0f))
      can.arrive(*reply);
    can.arrive(encoder.sample(1000, 0, true));
  }

  linux_sbc::Configuration configuration;
  QuietBus can;
  QuietLines lines;
  std::atomic<bool> stop{false};
  linux_sbc::LoopFigures figures;
  rig::Drive drive;
  rig::EncoderNode encoder{1};
  QuietBoard board{configuration, can, lines, stop, figures};
};

}  // namespace

TEST_CASE("a sample has the encoder's count, the drive's angle, the switch, and what was home") {
  Bench bench;
  bench.devices_answer();
  bench.lines.reading.closed = true;
  REQUIRE(bench.board.wait_for_tick());
  const auto sample = bench.board.sense();
  REQUIRE(sample.ok());
  CHECK(sample.value().height_count == 1000);
  CHECK(sample.value().home_count == 1000);
  CHECK(sample.value().home_height_m == 0.28f);
  CHECK(sample.value().contact == 1);
  CHECK(sample.value().leg_angle_rad == Approx(0.35f).margin(25.0 / 65535.0));
  CHECK(sample.value().age_us < 1000);
}

TEST_CASE("a frame that lay in the kernel's queue is so much older") {
  Bench bench;
  bench.devices_answer();
  bench.can.incoming[1].age_ns = 1'500'000;
  REQUIRE(bench.board.wait_for_tick());
  const auto sample = bench.board.sense();
  REQUIRE(sample.ok());
  CHECK(sample.value().age_us >= 1500);
  CHECK(sample.value().age_us < 2500);
}

TEST_CASE("devices that were never heard are a disconnected sample, a broken line too") {
  Bench bench;
  REQUIRE(bench.board.wait_for_tick());
  CHECK(bench.board.sense().status() == Status::disconnected);
  bench.devices_answer();
  bench.lines.reading.ok = false;
  REQUIRE(bench.board.wait_for_tick());
  CHECK(bench.board.sense().status() == Status::disconnected);
}

TEST_CASE("a drive whose frames the bus does not take is reported") {
  Bench bench;
  REQUIRE(bench.board.wait_for_tick());
  CHECK(bench.board.actuate({}) == Status::ok);
  bench.can.takes = false;
  CHECK(bench.board.actuate({}) == Status::disconnected);
  CHECK(bench.figures.can_refused.load() == 1);
}

TEST_CASE("a board that is not running tells the drive to be off, and no torque") {
  Bench bench;
  REQUIRE(bench.board.wait_for_tick());
  CHECK(bench.board.actuate({5.0f, 0.0f}) == Status::ok);
  CHECK(bus::is(bench.can.last(), bus::message::kMotorExit, 1));
  bench.board.set_state(bus::NodeState::running);
  CHECK(bench.board.actuate({5.0f, 0.0f}) == Status::ok);
  CHECK(bus::is(bench.can.last(), bus::message::kMotorCommand, 1));
}

TEST_CASE("a request for registers is answered with the telemetry, a frame a tick") {
  Bench bench;
  bus::RegisterRequest request;
  request.sequence = 7;
  request.value = 4;
  bench.can.arrive(bus::pack(request, 1));
  REQUIRE(bench.board.wait_for_tick());
  bench.board.link().registers().serve([](std::span<const std::uint8_t>, bus::Response& response) {
    response.size = 0;
    for (const std::uint32_t byte : {4u, 8u, 0u, 1u, 0u, 2u, 0u, 3u, 0u, 4u}) response.put(byte);
  });
  for (const std::uint32_t value : {0x00010002u, 0x00030004u}) {
    bench.board.report({});
    const auto answer = bus::unpack_register_answer(bench.can.last(), 1);
    REQUIRE(answer.ok());
    CHECK(answer.value().sequence == 7);
    CHECK(answer.value().value == value);
  }
  const std::size_t sent = bench.can.next;
  bench.board.report({});
  CHECK(bench.can.next == sent);
}

TEST_CASE("the coil's duty is the share of ticks on which the line is on") {
  Bench bench;
  const float duty = GENERATE(0.0f, 0.25f, 0.4f, 1.0f);
  for (int tick = 0; tick < 1000; ++tick) CHECK(bench.board.actuate({0.0f, duty}) == Status::ok);
  CHECK(static_cast<double>(bench.lines.on_ticks) == Approx(1000.0 * static_cast<double>(duty)).margin(2.0));
  CHECK(bench.board.actuate({0.0f, 0.0f}) == Status::ok);
  CHECK_FALSE(bench.lines.solenoid);
}

TEST_CASE("off the bus is a fault of the sample, and ends when the controller is back") {
  Bench bench;
  const auto fault = [&] {
    bench.devices_answer();
    REQUIRE(bench.board.wait_for_tick());
    const auto sample = bench.board.sense();
    REQUIRE(sample.ok());
    return static_cast<control::Fault>(sample.value().reported_fault);
  };
  CHECK(fault() == control::Fault::none);
  bench.can.watch.note_error_frame(CAN_ERR_BUSOFF);
  CHECK(fault() == control::Fault::bus_off);
  CHECK(fault() == control::Fault::bus_off);
  CHECK(bench.figures.can_states[0].load() == socketcan::CanState::off);
  bench.can.watch.note_error_frame(CAN_ERR_RESTARTED);
  CHECK(fault() == control::Fault::none);
  // Off and restarted between two ticks: told once, for the controller to keep.
  bench.can.watch.note_error_frame(CAN_ERR_BUSOFF);
  bench.can.watch.note_error_frame(CAN_ERR_RESTARTED);
  CHECK(fault() == control::Fault::bus_off);
  CHECK(fault() == control::Fault::none);
  CHECK(bench.figures.can_states[0].load() == socketcan::CanState::on);
}

TEST_CASE("a robot whose link goes down and up again stays in its safe state until a person resets it") {
  linux_sbc::Configuration configuration = wiring();
  Bench bench(configuration);
  bench.lines.reading.closed = true;
  core::ParameterFile store("");
  firmware::FaultLog faults{};
  faults.begin();
  control::Config config;
  config.supervisor.sample_age_max_us = 100'000;  // of this test's machine
  config.supervisor.tick_interval_max_us = 100'000;
  firmware::Node node(bench.board, store, config, bus::Identity{.board = "linux_sbc", .text = ""}, 1, faults);
  const auto tick = [&](int ticks) {
    for (int i = 0; i < ticks; ++i) {
      bench.devices_answer();
      bench.board.wait_for_tick();
      bench.board.set_state(node.state());
      node.tick();
    }
  };
  tick(100);
  REQUIRE(node.state() == bus::NodeState::idle);
  REQUIRE(node.request(bus::Request::arm) == bus::Refusal::none);
  REQUIRE(node.request(bus::Request::hop) == bus::Refusal::none);
  tick(10);
  REQUIRE(node.state() == bus::NodeState::running);

  const bool off_first = GENERATE(false, true);
  if (off_first) bench.can.watch.note_error_frame(CAN_ERR_BUSOFF);
  bench.can.watch.note_receive(ENETDOWN);
  tick(1);
  CHECK(node.snapshot().fault == static_cast<std::uint16_t>(control::Fault::bus_off));
  CHECK(bus::is(bench.can.last(), bus::message::kMotorCommand, 1) == false);
  CHECK(node.request(bus::Request::reset) == bus::Refusal::none);  // while it is down
  tick(5);
  CHECK(node.state() == bus::NodeState::fault);
  bench.can.watch.note_send(0);
  tick(2000);
  CHECK(node.state() == bus::NodeState::fault);
  CHECK(node.snapshot().fault == static_cast<std::uint16_t>(control::Fault::bus_off));
  CHECK(bus::is(bench.can.last(), bus::message::kMotorExit, 1));
  CHECK(node.request(bus::Request::arm) == bus::Refusal::not_in_this_state);
  CHECK(node.request(bus::Request::reset) == bus::Refusal::none);
  tick(10);
  CHECK(node.state() == bus::NodeState::idle);
}

TEST_CASE("the loop ends when it is told to stop, and counts each tick's lateness and work") {
  Bench bench;
  for (int i = 0; i < 5; ++i) REQUIRE(bench.board.wait_for_tick());
  bench.stop = true;
  CHECK_FALSE(bench.board.wait_for_tick());
  CHECK(bench.figures.lateness.count() == 6);
  CHECK(bench.figures.work.count() == 5);
}

TEST_CASE("a thousand ticks of a node on the board take nothing from the heap") {
#ifndef FURCULA_COUNTS_ALLOCATIONS
  WARN("not counted under a sanitizer");
#else
  Bench bench;
  core::ParameterFile store("");
  firmware::FaultLog faults{};
  faults.begin();
  firmware::Node node(bench.board, store, control::Config{}, bus::Identity{.board = "linux_sbc", .text = ""},
                      1, faults);
  unsigned long begin = 0;
  for (int tick = 0; tick < 1100; ++tick) {
    if (tick == 100) begin = furcula_allocations();
    bench.devices_answer();
    bench.board.wait_for_tick();
    bench.board.set_state(node.state());
    node.tick();
  }
  const unsigned long taken = furcula_allocations() - begin;
  CHECK(taken == 0);
  CHECK(begin > 0);  // the counter counts
  CHECK(node.app().telemetry().tick == 1099);
#endif
}

TEST_CASE("parameters that were saved and cannot be read are a fault from the start until a person's reset") {
  Bench bench;
  core::ParameterFile store("/");  // a folder
  firmware::FaultLog faults{};
  faults.begin();
  firmware::Node<QuietBoard, core::ParameterFile> node(bench.board, store, {}, {}, 7, faults);
  REQUIRE(node.snapshot().parameter_origin == static_cast<int>(bus::ParameterOrigin::store_unusable));
  bench.board.report_start_fault(control::Fault::parameters_lost);
  bench.lines.reading.closed = true;
  const auto tick = [&](std::uint32_t times) {
    for (std::uint32_t i = 0; i < times; ++i) {
      bench.devices_answer();
      REQUIRE(bench.board.wait_for_tick());
      bench.board.set_state(node.state());
      node.tick();
    }
  };
  tick(1200);
  CHECK(node.state() == bus::NodeState::fault);
  CHECK(node.snapshot().fault == static_cast<int>(control::Fault::parameters_lost));
  // A reset does nothing as long as the board still says so, and is what ends it after that.
  node.request(bus::Request::reset);
  tick(10);
  CHECK(node.state() == bus::NodeState::fault);
  tick(400);
  CHECK(node.state() == bus::NodeState::fault);
  node.request(bus::Request::reset);
  tick(10);
  CHECK(node.state() == bus::NodeState::idle);
}
