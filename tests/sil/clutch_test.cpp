// The robot with its clutch, whole: plant, sensors, controller. What the sequencer is for, and what may go
// wrong with it.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>

#include "firmware/app/app.hpp"
#include "host/core/random.hpp"
#include "host/sim/simulate.hpp"
#include "tests/host/error_message.hpp"
#include "tests/sil/machines.hpp"

using namespace furcula;
using namespace furcula::test;
using sim_host::RigFault;

namespace {

/// What a run came to.
struct Outcome {
  int hops = 0;
  double lowest_m = 1.0, highest_m = 0.0;  ///< of the body
  double most_flight_torque_nm = 0.0;      ///< once the delays are learned, after 5 s
  double longest_without_touchdown_s = 0.0;
  control::Fault fault = control::Fault::none;  ///< the first
  double fault_s = 0.0, torque_after_fault_nm = 0.0;
  control::ClutchState clutch;
  std::int32_t most_count_at_home = 0;  ///< of the cable's encoder, in verified catches
  std::uint32_t teeth_skipped = 0;
};

Outcome run(const model::Model& model, const sim::Scenario& scenario, std::uint64_t seed) {
  sim_host::SimBoard board(sim::rig_config(model, scenario, seed));
  firmware::App app(board, sim::controller_config(model, scenario));
  Outcome out;
  double last_touchdown_s = 0.0;
  std::uint32_t catches = 0;
  while (board.wait_for_tick()) {
    app.tick();
    const auto& o = board.telemetry().outputs;
    const auto torque_nm = std::abs(static_cast<double>(o.command.torque_nm));
    if (out.fault == control::Fault::none && o.fault != control::Fault::none) {
      out.fault = o.fault;
      out.fault_s = board.time_s();
    }
    if (out.fault != control::Fault::none) {
      out.torque_after_fault_nm =
          std::max({out.torque_after_fault_nm, torque_nm, static_cast<double>(o.command.coil_duty)});
      continue;
    }
    if (o.phase.touchdown) {
      ++out.hops;
      last_touchdown_s = board.time_s();
    }
    out.longest_without_touchdown_s =
        std::max(out.longest_without_touchdown_s, board.time_s() - last_touchdown_s);
    out.lowest_m = std::min(out.lowest_m, board.plant().height_m());
    if (board.time_s() > scenario.duration_s - 2.0)
      out.highest_m = std::max(out.highest_m, board.plant().height_m());
    if (o.phase.phase == control::Phase::flight && board.time_s() > 5.0)
      out.most_flight_torque_nm = std::max(out.most_flight_torque_nm, torque_nm);
    if (app.state().clutch.counts.catches != catches) {
      catches = app.state().clutch.counts.catches;
      const std::int32_t count =
          count_difference(board.sample().cable_count, board.sample().cable_home_count);
      out.most_count_at_home = std::max(out.most_count_at_home, std::abs(count));
    }
  }
  out.clutch = app.state().clutch;
  if (board.plant().clutched() != nullptr)
    out.teeth_skipped = board.plant().clutched()->clutch().skipped_teeth();
  return out;
}

}  // namespace

TEST_CASE("in flight the spring is let go, the leg folds, and the spring is caught before each touch-down") {
  const Outcome out = run(robot_with_clutch(), clutch_scenario(60.0), 1);
  CHECK(out.fault == control::Fault::none);
  CHECK(out.hops > 120);
  const auto& c = out.clutch.counts;
  CHECK(c.failed_releases == 0);
  CHECK(c.missed == 0);
  CHECK(c.slipped == 0);
  CHECK(static_cast<int>(c.releases) >= out.hops - 2);
  CHECK(static_cast<int>(c.catches) >= out.hops - 3);
  CHECK(out.most_count_at_home == 0);
  CHECK(out.teeth_skipped == 0);
  CHECK(out.highest_m == Approx(0.355).margin(0.01));
}

TEST_CASE("a cable that creeps home is waited for, and not taken for one that rests between two teeth") {
  model::Model heavy = robot_with_clutch();
  heavy.parameters[0] = 2.6;
  auto scenario = clutch_scenario(25.0);
  scenario.start_position = 0.34;
  scenario.amplitude = 1.65;
  for (const double contraction_m : {0.065, 0.075, 0.085}) {
    scenario.contraction_m = contraction_m;
    const Outcome out = run(heavy, scenario, 1);
    CAPTURE(contraction_m);
    CHECK(out.hops > 45);
    CHECK(out.clutch.counts.slipped == 0);
    CHECK(out.clutch.counts.missed == 0);
    CHECK(static_cast<int>(out.clutch.counts.catches) >= out.hops - 3);
  }
}

TEST_CASE("the delays that are learned are the coil's and the key's") {
  // As the plant has them: coil on until the key is out, coil off until it is in.
  const auto model = robot_with_clutch();
  auto plant = sim::plant_of(model, {});
  plant.reset(0.35, 0.0);
  int releases_ms = 0, catches_ms = 0;
  plant.set_voltage(10.0);
  for (; plant.clutched()->caught(); ++releases_ms) plant.advance(0.0, 1e-3);
  for (int n = releases_ms; n < 60; ++n) plant.advance(0.0, 1e-3);
  plant.set_voltage(4.5);  // held
  for (int n = 0; n < 30; ++n) plant.advance(0.0, 1e-3);
  plant.set_voltage(0.0);
  for (; !plant.clutched()->caught(); ++catches_ms) plant.advance(0.0, 1e-3);
  const Outcome out = run(model, clutch_scenario(60.0), 1);
  CAPTURE(releases_ms, catches_ms);
  CHECK(out.clutch.release_delay_s * 1e3 == Approx(releases_ms).margin(7.0));
  CHECK(out.clutch.release_delay_s * 1e3 < releases_ms + 1.0);
  // The pull that tests a catch comes so much later than it begins (a sine small enough for its angle).
  const control::ClutchConfig config;
  const double pull_ms = 1e3 * config.test_s / 3.14159 * std::sqrt(config.onset_m / config.test_pull_m);
  CHECK(out.clutch.held_after_s * 1e3 + pull_ms == Approx(catches_ms).margin(3.0));
}

TEST_CASE("the leg folds by ten centimetres with a fraction of the torque that the caught spring takes") {
  auto scenario = clutch_scenario(20.0);
  scenario.contraction_m = 0.10;
  const Outcome with = run(robot_with_clutch(), scenario, 1);
  scenario.release_in_flight = false;
  const Outcome without = run(robot_with_clutch(), scenario, 1);
  CHECK(with.fault == control::Fault::none);
  CHECK(without.fault == control::Fault::none);
  CHECK(with.clutch.counts.failed_releases == 0);
  // The spring alone: 600 N/m * (0.1 m + 7 mm) at a lever of 2 L sin(theta), 0.24 m.
  CHECK(without.most_flight_torque_nm > 14.0);
  // What the motor puts into the spring there is held back by the envelope from 19 N m on.
  CHECK(with.most_flight_torque_nm < 0.5 * without.most_flight_torque_nm);
}

TEST_CASE("of 10,000 hops with rough ground and sensors and a failing coil none falls") {
  auto scenario = clutch_scenario(4320.0);
  scenario.sensors = {true, true, true, true};
  scenario.ground_steps_m = 0.03;
  core::Random random(20261121, 9);
  int stuck = 0;
  for (double t = 3.0; t < scenario.duration_s; t += random.uniform(2.0, 20.0)) {
    const double kind = random.uniform(0.0, 4.0);
    if (kind < 1.5) {
      scenario.faults.push_back({t, RigFault::coil_stuck_on, random.uniform(0.05, 0.4)});
      ++stuck;
    } else if (kind < 2.5) {
      scenario.faults.push_back({t, RigFault::coil_open, random.uniform(0.05, 0.6)});
    } else {
      scenario.faults.push_back({t, RigFault::supply_sag, random.uniform(0.1, 2.0)});
    }
  }
  const Outcome out = run(robot_with_clutch(), scenario, 7);
  const auto& c = out.clutch.counts;
  std::printf(
      "%d hops: %u releases, %u failed; %u catches verified, %u slipped, %u tried again; %u stances on a free spring\n",
      out.hops, c.releases, c.failed_releases, c.catches, c.slipped, c.retries, c.missed);
  CHECK(out.fault == control::Fault::none);
  CHECK(out.hops >= 10000);
  CHECK(out.lowest_m > 0.10);
  CHECK(out.longest_without_touchdown_s < 0.8);
  CHECK(stuck > 100);
  CHECK(c.missed > 50);  // the motor bore them
  CHECK(c.missed < 400);
  CHECK(c.releases > 8000);
  CHECK(out.teeth_skipped == 0);
}

TEST_CASE("a coil that never pulls leaves a robot that hops on its caught spring") {
  auto scenario = clutch_scenario(30.0);
  scenario.faults = {{0.0, RigFault::coil_open, 1e9}};
  const Outcome out = run(robot_with_clutch(), scenario, 1);
  CHECK(out.fault == control::Fault::none);
  CHECK(out.hops > 60);
  CHECK(out.clutch.counts.releases == 0);
  CHECK(out.clutch.counts.failed_releases < 12);  // not in each flight
  CHECK(out.clutch.counts.missed == 0);
}

TEST_CASE("a coil that never lets go is a fault after five stances, and then the motor is off") {
  auto scenario = clutch_scenario(20.0);
  scenario.faults = {{3.0, RigFault::coil_stuck_on, 1e9}};
  const Outcome out = run(robot_with_clutch(), scenario, 1);
  CHECK(out.fault == control::Fault::clutch_not_caught);
  CHECK(out.clutch.counts.missed == 5);
  CHECK(out.fault_s < 7.0);
  CHECK(out.torque_after_fault_nm == 0.0);
  CHECK(out.lowest_m > 0.14);  // each was borne by the motor
}

TEST_CASE("what a leg that is free in flight does not know is refused, and not left out") {
  const auto refused = [](const model::Model& model, const sim::Scenario& scenario) {
    return test::error_message([&] { sim::simulate(model, scenario, 1); });
  };
  model::Model sticky = robot_with_clutch();
  sticky.effects[dynamics::Effect::coulomb_friction] = {1.0};
  CHECK_THAT(refused(sticky, clutch_scenario(1.0)),
             Catch::Contains(
                 "[effect.coulomb_friction] with a clutch; expected effects of the drive and the sensors"));
  sticky.clutch.reset();
  sim::Scenario scenario = example_scenario(1.0);
  CHECK(refused(sticky, scenario).empty());
  scenario.contraction_m = 0.05;
  CHECK_THAT(refused(sticky, scenario), Catch::Contains("with [contraction]"));
  model::Model light = robot_with_clutch();
  for (std::size_t i = 10; i < 13; ++i) light.parameters[i] = 0.0;
  CHECK_THAT(refused(light, clutch_scenario(1.0)), Catch::Contains("inertia_a_kgm2"));
  model::Model lagging = robot_with_clutch();
  lagging.effects[dynamics::Effect::actuator_lag] = {0.002};
  CHECK(refused(lagging, clutch_scenario(1.0)).empty());
}
