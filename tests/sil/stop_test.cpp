// A stop over the bus, on the simulated robot: obeyed whoever says it, and not undone by another host's stream.
#include <catch2/catch.hpp>
#include <cmath>

#include "boards/qemu_robot_tick/stop_attack.hpp"
#include "boards/sim_host/can_board.hpp"
#include "firmware/app/node_on_can.hpp"
#include "firmware/app/node_registers.hpp"
#include "host/sim/simulate.hpp"
#include "tests/sil/machines.hpp"

namespace {

using namespace furcula;
using Board = sim_host::CanBoard;
using Node = firmware::Node<Board, firmware::NoStore>;

control::Config config_of(const model::Model& model, const sim::Scenario& scenario) {
  control::Config config = sim::controller_config(model, scenario);
  Board::adapt(config);
  return config;
}

/// The robot of the example, idle, as a board of it goes about a millisecond (firmware/chip/stm32f4/robot_main.cpp).
struct HoppingRobot {
  model::Model model = test::example_hopper();
  sim::Scenario scenario = test::example_scenario(1000.0);
  Board board{sim::rig_config(model, scenario, 1)};
  firmware::NoStore store;
  firmware::FaultLog faults{};
  Node node{board, store, config_of(model, scenario), {.board = "sil", .text = ""}, 1, faults};
  firmware::NodeRegisters<Node> registers{node};

  HoppingRobot() {
    faults.begin();
    for (int ms = 0; ms < 200; ++ms) tick();
  }
  void hear(const bus::Frame& frame) { board.link().receive(frame, board.now_us()); }
  /// Without a fault.
  void tick() {
    tick_whatever_comes();
    REQUIRE(node.snapshot().fault == 0);
  }
  void tick_whatever_comes() {
    REQUIRE(board.wait_for_tick());
    firmware::obey_stop(board.link(), node);
    board.set_state(node.state());
    node.tick();
    firmware::obey_stream(board.link(), node);
    board.link().registers().serve([&](std::span<const std::uint8_t> asked, bus::Response& response) {
      bus::handle_pdu(registers, node.bus_counts(), asked, response);
    });
  }
  bool drives() { return node.state() == bus::NodeState::running || board.rig().command().torque_nm != 0.0f; }
};

}  // namespace

TEST_CASE("a stop is obeyed at each of the 256 offsets from the stream that makes the robot hop") {
  HoppingRobot robot;
  firmware::StopAttack attack(robot);
  CHECK(attack.offsets() == 256);
  CHECK(attack.started() == 256);
}

TEST_CASE("a stop is obeyed in every version and at every age") {
  HoppingRobot robot;
  firmware::StopAttack attack(robot);
  CHECK(attack.versions_and_ages() == 256);
  CHECK(attack.started() == 256);
}

TEST_CASE(
    "a stop by the registers is obeyed at each sequence number, in every version, without key or session") {
  HoppingRobot robot;
  firmware::StopAttack attack(robot);
  CHECK(attack.registers() == 256);
  CHECK(attack.started() == 256);
}

TEST_CASE(
    "500 stops beside another host's stream keep the robot still, until that host lets go and hops anew") {
  for (const std::uint32_t offset : {0u, 1u, 2u, 127u, 128u, 129u, 255u}) {
    CAPTURE(offset);
    HoppingRobot robot;
    firmware::StopAttack attack(robot);
    CHECK(attack.beside(offset));
    CHECK(attack.started() == 2);
    CHECK(robot.node.snapshot().last_refusal == 0);
  }
}

TEST_CASE(
    "a second device with the robot's id, or that commands its drive, is found while it hops, on the same tick") {
  for (const bool heartbeat : {true, false}) {
    HoppingRobot robot;
    REQUIRE(robot.node.request(bus::Request::arm) == bus::Refusal::none);
    REQUIRE(robot.node.request(bus::Request::hop) == bus::Refusal::none);
    for (int ms = 0; ms < 1000; ++ms) {
      robot.node.hear_host();
      robot.tick();
    }
    REQUIRE(robot.drives());
    bus::Frame frame;  // by hand from docs/bus.md
    frame.id = heartbeat ? 0x701 : 0x001;
    frame.size = heartbeat ? 7 : 8;
    for (int ms = 0; ms < 1000; ++ms) {
      if (ms % 100 == 0) robot.hear(frame);
      if (ms % 50 == 25) CHECK(robot.node.request(bus::Request::reset) == bus::Refusal::none);
      robot.tick_whatever_comes();
      REQUIRE(robot.node.snapshot().fault == static_cast<std::uint16_t>(control::Fault::node_id_taken));
      REQUIRE(robot.board.commanded().torque_nm == 0.0f);
      REQUIRE(robot.node.request(bus::Request::arm) == bus::Refusal::not_in_this_state);
    }
    // Alone again: the fault stays until a person resets it.
    for (int ms = 0; ms < 500; ++ms) robot.tick_whatever_comes();
    CHECK(robot.node.state() == bus::NodeState::fault);
    CHECK(robot.node.request(bus::Request::reset) == bus::Refusal::none);
    for (int ms = 0; ms < 5; ++ms) robot.tick_whatever_comes();
    CHECK(robot.node.state() == bus::NodeState::idle);
  }
}
