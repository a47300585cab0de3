// The axes in open loop, against closed forms.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "host/sim/simulate.hpp"

using namespace furcula;

namespace {

model::Model machine(dynamics::Kind kind, std::vector<double> parameters) {
  model::Model model;
  model.kind = kind;
  model.parameters = std::move(parameters);
  return model;
}

}  // namespace

TEST_CASE("a constant force moves an axis without friction by F t^2 / (2 m)") {
  sim::Scenario scenario;
  scenario.duration_s = 2.0;
  scenario.profile = control::ProfileShape::constant;
  scenario.amplitude = 3.0;
  const log::Log log = sim::simulate(machine(dynamics::Kind::motor_axis, {12.0, 0.0}), scenario, 1);
  REQUIRE(log.rows() == 2000);
  for (std::size_t row = 0; row < log.rows(); ++row) {
    const double t = log.time_s()[row];
    REQUIRE(log.at("position_m")[row] == Approx(3.0 * t * t / 24.0).margin(1e-9));
    REQUIRE(log.at("force_n")[row] == 3.0);
  }
}

TEST_CASE("a harmonic force is A sin(2 pi t / P) in each row") {
  sim::Scenario scenario;
  scenario.amplitude = 5.0;
  scenario.period_s = 0.7;
  const log::Log log = sim::simulate(machine(dynamics::Kind::motor_axis, {12.0, 3.0}), scenario, 1);
  for (std::size_t row = 0; row < log.rows(); ++row)
    REQUIRE(log.at("force_n")[row] ==
            Approx(5.0 * std::sin(2 * std::numbers::pi * log.time_s()[row] / 0.7)).margin(1e-9));
}

TEST_CASE("a joint that hangs swings with the period 2 pi sqrt(I / (m g l)) of small angles") {
  sim::Scenario scenario;
  scenario.start_position = 0.01;
  scenario.profile = control::ProfileShape::zero;
  scenario.duration_s = 10.0;
  const double inertia = 0.15, gravity_torque = 2.5;
  const log::Log log =
      sim::simulate(machine(dynamics::Kind::rotary_joint, {inertia, gravity_torque, 0.0}), scenario, 1);
  const double omega = std::sqrt(gravity_torque / inertia);
  for (std::size_t row = 0; row < log.rows(); ++row)
    REQUIRE(log.at("angle_rad")[row] == Approx(0.01 * std::cos(omega * log.time_s()[row])).margin(2e-5));
  CHECK(log.at("torque_nm").back() == 0.0);
}

TEST_CASE("a quantised joint's angle is in whole counts of a 13-bit encoder") {
  sim::Scenario scenario;
  scenario.start_position = 0.5;
  scenario.sensors.quantisation = true;
  scenario.amplitude = 0.0;
  const log::Log log = sim::simulate(machine(dynamics::Kind::rotary_joint, {0.15, 2.5, 0.01}), scenario, 1);
  const double count = 2.0 * std::numbers::pi / 8192.0;
  for (const double angle : log.at("angle_rad"))
    REQUIRE(std::abs(angle / count - std::nearbyint(angle / count)) < 1e-9);
}

TEST_CASE("a carriage without friction falls by g t^2 / 2 onto its stop at height 0 and stays there") {
  auto model = machine(dynamics::Kind::rail_carriage, {2.0, 0.0, 9.81});
  sim::Scenario scenario = sim::default_scenario(model);
  scenario.start_position = 0.5;
  const log::Log log = sim::simulate(model, scenario, 1);
  REQUIRE(log.rows() == 1000);
  CHECK(log.rig == "rail_carriage");
  CHECK_FALSE(log.has("force_n"));
  const double landing_s = std::sqrt(2.0 * 0.5 / 9.81);
  for (std::size_t row = 0; row < log.rows(); ++row) {
    const double t = log.time_s()[row];
    CAPTURE(t);
    REQUIRE(log.at("contact")[row] == (t > landing_s ? 1.0 : 0.0));
    REQUIRE(log.at("height_m")[row] == Approx(t > landing_s ? 0.0 : 0.5 - 0.5 * 9.81 * t * t).margin(1e-9));
  }
}

TEST_CASE("a carriage thrown up from its stop is in flight until it is back") {
  auto model = machine(dynamics::Kind::rail_carriage, {2.0, 0.0, 9.81});
  sim::Scenario scenario = sim::default_scenario(model);
  scenario.start_position = 0.0;
  scenario.start_velocity = 3.0;
  const log::Log log = sim::simulate(model, scenario, 1);
  for (std::size_t row = 0; row < log.rows(); ++row)
    REQUIRE(log.at("contact")[row] == (log.time_s()[row] > 2.0 * 3.0 / 9.81 ? 1.0 : 0.0));
}
