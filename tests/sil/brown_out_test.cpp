// A supply that fails in flight: the board starts anew while the host still says hop.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>

#include "boards/sim_host/can_board.hpp"
#include "firmware/app/node.hpp"
#include "firmware/store/fault_log.hpp"
#include "host/sim/simulate.hpp"
#include "tests/sil/machines.hpp"

using namespace furcula;
using namespace furcula::test;
using sim_host::CanBoard;
using sim_host::RigFault;
using sim_host::SimBoard;

namespace {

struct EmptyStore {
  Result<std::size_t> load(std::span<std::uint8_t>) const { return std::size_t{0}; }
  Status save(std::span<const std::uint8_t>) { return Status::ok; }
};

SimBoard& rig_of(SimBoard& board) { return board; }
SimBoard& rig_of(CanBoard& board) { return board.rig(); }

/// The robot's node on the rig: told to hop by a stream that goes on, whatever happens.
template <class Board>
void fail_in_flight(const double outage_s) {
  constexpr double kFailsS = 1.6;
  sim::Scenario scenario = clutch_scenario(5.0);
  scenario.faults = {{kFailsS, RigFault::brown_out, outage_s}};
  Board board(sim::rig_config(robot_with_clutch(), scenario, 1));
  control::Config config = sim::controller_config(robot_with_clutch(), scenario);
  config.supervisor.sample_age_max_us = firmware::kCanSampleAgeMaxUs;
  EmptyStore store;
  firmware::FaultLog faults;
  faults.begin();
  using Node = firmware::Node<Board, EmptyStore>;
  std::optional<Node> node(std::in_place, board, store, config, bus::Identity{}, std::uint16_t{7}, faults);
  firmware::StreamCommand stream{bus::Request::stop, 3.0f, 0.3f, true};
  bool ran = false;
  std::uint32_t anew_ticks = 0;
  bool restarted = false;
  while (board.wait_for_tick()) {
    const double time_s = rig_of(board).time_s();
    if (rig_of(board).take_restart()) {
      REQUIRE(ran);
      CHECK(time_s == Approx(kFailsS + outage_s).margin(1e-6));
      // What acts as the board comes up: no coil, and a drive that has heard nothing for 5 ms is off.
      CHECK(rig_of(board).command().coil_duty == 0.0f);
      if (outage_s > 0.006) CHECK(rig_of(board).command().torque_nm == 0.0f);
      if constexpr (requires { board.restart(); }) board.restart();
      node.emplace(board, store, config, bus::Identity{}, std::uint16_t{9}, faults);
      restarted = true;
    }
    node->tick();
    if (std::lround(time_s * 1e3) % 10 == 0) {
      stream.request = node->state() == bus::NodeState::idle || ran ? bus::Request::hop : bus::Request::stop;
      node->stream(stream);
    }
    ran = ran || node->state() == bus::NodeState::running;
    if (!restarted) continue;
    ++anew_ticks;
    REQUIRE(node->state() != bus::NodeState::running);
    REQUIRE(node->state() != bus::NodeState::armed);
    REQUIRE(node->app().telemetry().outputs.command.torque_nm == 0.0f);
    REQUIRE(rig_of(board).command().coil_duty == 0.0f);
    if (anew_ticks > 1) REQUIRE(std::abs(rig_of(board).command().torque_nm) < 0.01f);
  }
  CHECK(anew_ticks > 1500);
  // Where the counters' home is lost, the node says so once its start is over, and waits for a person.
  CHECK(node->state() == bus::NodeState::fault);
  CHECK(node->app().telemetry().outputs.fault == control::Fault::non_finite_input);
  CHECK(rig_of(board).plant().clutched()->caught());
}

}  // namespace

TEST_CASE(
    "after a brown-out in flight the board is idle with coil and drive off, though the host still says hop") {
  fail_in_flight<CanBoard>(GENERATE(0.003, 0.05, 0.4));
}

TEST_CASE("so is a board whose encoders are its own") {
  fail_in_flight<SimBoard>(GENERATE(0.003, 0.05, 0.4));
}
