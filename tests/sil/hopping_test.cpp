// The whole stack in one process: application, controller, sensors, plant. Asserts physics.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "furcula/dynamics/hopper.hpp"
#include "host/sim/simulate.hpp"
#include "tests/sil/machines.hpp"

using namespace furcula;
using namespace furcula::test;

TEST_CASE("the example of 002 section 3.2.1 hops at a steady apex of 0.361 m") {
  const auto apex = apexes(sim::simulate(example_hopper(), example_scenario(20.0), 1));
  REQUIRE(apex.size() > 40);
  for (std::size_t i = 20; i < apex.size(); ++i) {
    INFO("hop " << i);
    CHECK(apex[i] == Approx(0.361).margin(0.001));
  }
}

TEST_CASE("with the torque's sign flipped the hopping dies to apexes between 0.28 and 0.33 m") {
  auto scenario = example_scenario(20.0);
  scenario.amplitude = -2.0;
  const auto apex = apexes(sim::simulate(example_hopper(), scenario, 1));
  REQUIRE(apex.size() > 20);
  for (std::size_t i = 5; i < apex.size(); ++i) CHECK(apex[i] < 0.33);
}

TEST_CASE("without torque the apexes fall from hop to hop until the body rests in its spring") {
  auto scenario = example_scenario(20.0);
  scenario.profile = control::ProfileShape::zero;
  const log::Log log = sim::simulate(example_hopper(), scenario, 1);
  const auto apex = apexes(log);
  REQUIRE(apex.size() >= 2);
  for (std::size_t i = 1; i < apex.size(); ++i) CHECK(apex[i] < apex[i - 1]);
  // At rest the spring carries the weight: k (z0 - z) = m g.
  CHECK(log.at("height_m").back() == Approx(kTouchdownM - 1.5 * 9.81 / 600.0).margin(1e-5));
}

TEST_CASE("the constant profile pumps energy in, more than the harmonic one of the same amplitude") {
  auto scenario = example_scenario(20.0);
  const auto harmonic = apexes(sim::simulate(example_hopper(), scenario, 1));
  scenario.profile = control::ProfileShape::constant;
  const auto constant = apexes(sim::simulate(example_hopper(), scenario, 1));
  REQUIRE(constant.size() > 20);
  CHECK(constant.back() > harmonic.back() + 0.05);
}

TEST_CASE(
    "a row's command acts from its instant until the next row's: replaying it gives the log to the bit") {
  const log::Log log = sim::simulate(example_hopper(), example_scenario(5.0), 1);
  dynamics::Hopper<double> plant(dynamics::from_table<dynamics::HopperLinearParameters<double>>(
      std::span<const double>(example_hopper().parameters)));
  plant.reset(0.35, 0.0);
  for (std::size_t row = 0; row < log.rows(); ++row) {
    INFO("row " << row);
    REQUIRE(log.at("height_m")[row] == plant.height_m());
    REQUIRE(log.at("velocity_mps")[row] == plant.velocity_mps());
    REQUIRE((log.at("contact")[row] == 1.0) == plant.in_stance());
    REQUIRE(log.at("leg_angle_rad")[row] == plant.leg_angle_rad());
    plant.advance(log.at("torque_cmd_nm")[row], 0.001);
  }
}

TEST_CASE("hopping stays up with a quantised and noisy encoder and a switch that bounces and is 10 ms off") {
  const auto seed = GENERATE(range(1, 11));
  auto scenario = example_scenario(30.0);
  scenario.sensors = {true, true, true, true};
  const log::Log log = sim::simulate(example_hopper(), scenario, static_cast<std::uint64_t>(seed));
  INFO("seed " << seed);
  const auto& fault = log.at("fault");
  CHECK(std::all_of(fault.begin(), fault.end(), [](double f) { return f == 0.0; }));
  // In any second the body flies at least 3 cm above the touch-down height, and never higher than twice what
  // it does with ideal sensors.
  const auto& z = log.at("height_m");
  for (std::size_t from = 0; from + 1000 <= z.size(); from += 500) {
    const double highest =
        *std::max_element(z.begin() + static_cast<long>(from), z.begin() + static_cast<long>(from) + 1000);
    CHECK(highest > kTouchdownM + 0.03);
    CHECK(highest < kTouchdownM + 2 * 0.079);
  }
}

TEST_CASE("hopping stays up with the settling rule of debouncing as well") {
  auto scenario = example_scenario(20.0);
  scenario.sensors = {true, true, true, false};
  sim_host::SimBoard board(sim::rig_config(example_hopper(), scenario, 4));
  control::Config config = sim::controller_config(example_hopper(), scenario);
  config.debounce.rule = control::DebounceRule::settling;
  firmware::App app(board, config);
  double highest_m = 0.0;
  while (board.wait_for_tick()) {
    app.tick();
    REQUIRE(board.telemetry().outputs.fault == control::Fault::none);
    if (board.time_s() > 19.0) highest_m = std::max(highest_m, board.plant().height_m());
  }
  CHECK(highest_m == Approx(0.361).margin(0.005));
}

TEST_CASE("a cause planted in the model acts in the simulated rig: dry friction lowers the apexes") {
  model::Model model = example_hopper();
  const auto free = apexes(sim::simulate(model, example_scenario(10.0), 1));
  model.effects[dynamics::Effect::coulomb_friction] = {1.0, 0.0, 0.0};
  const auto rubbed = apexes(sim::simulate(model, example_scenario(10.0), 1));
  // From 0.35 m the first flight down and up again loses about 1 N over 2 x 0.068 m and the stance's travel.
  CHECK(rubbed[1] < free[1] - 0.01);
}
