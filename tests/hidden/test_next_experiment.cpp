// Recordings that cannot tell a hidden cause from another: the diagnosis must say so and say what to record;
// the rig then does that, and the diagnosis of all recordings together must name the cause.
#include <catch2/catch.hpp>
#include <functional>
#include <string>
#include <vector>

#include "host/diagnose/diagnose.hpp"
#include "tests/hidden/machine.hpp"
#include "tests/hidden/rig.hpp"

namespace furcula::hidden {
namespace {

/// What the rig records when it is told to do this, the n-th time.
using Record = std::function<log::Log(const sim::Scenario&)>;

diagnose::Diagnosis diagnosis_of(const model::Model& model, const std::vector<log::Log>& logs,
                                 std::size_t held_out_each) {
  std::vector<log::Log> training, held_out;
  for (std::size_t i = 0; i < logs.size(); ++i)
    (i % held_out_each == held_out_each - 1 ? held_out : training).push_back(logs[i]);
  return diagnose::diagnose(model, training, held_out);
}

bool has_rival(const diagnose::Finding& f, const std::string& name) {
  for (const auto& rival : f.indistinguishable_from)
    if (rival.names == std::vector<std::string>{name}) return true;
  return false;
}

/// Recordings of the scenarios leave the planted effect undecided against `rival`; what is proposed then
/// decides.
void expect_settled(const model::Model& model, const std::vector<sim::Scenario>& scenarios,
                    const std::string& planted, const std::string& rival, double size, const Record& record) {
  std::vector<log::Log> logs;
  for (const sim::Scenario& s : scenarios) logs.push_back(record(s));
  const diagnose::Diagnosis before = diagnosis_of(model, logs, 4);
  INFO(before.summary);
  INFO(before.next_experiment);
  REQUIRE(before.verdict == diagnose::Verdict::not_identifiable);
  REQUIRE(before.findings.size() == 1);
  const diagnose::Finding& open = before.findings.front();
  const std::string first(dynamics::info(open.effect).name);
  CHECK(((first == planted && has_rival(open, rival)) || (first == rival && has_rival(open, planted))));
  REQUIRE(!before.experiments.empty());
  const diagnose::Experiment& next = before.experiments.front();
  CHECK(next.recordings <= 20);
  CHECK(before.next_experiment.find(next.what) != std::string::npos);

  for (int i = 0; i < next.recordings + 1; ++i) logs.push_back(record(next.scenario));  // one to hold out
  std::rotate(logs.begin(), logs.end() - 1, logs.end());
  std::swap(logs[0], logs[3]);
  const diagnose::Diagnosis after = diagnosis_of(model, logs, 4);
  INFO(after.summary);
  CHECK(after.verdict == diagnose::Verdict::explained);
  REQUIRE(after.findings.size() == 1);
  const diagnose::Finding& found = after.findings.front();
  CHECK(std::string(dynamics::info(found.effect).name) == planted);
  const auto& estimate =
      found.parameters.at(std::string(name_on(dynamics::info(found.effect).parameter_table[0], model.kind)));
  CHECK(estimate.value == Approx(size).epsilon(0.03));
}

/// One without torque for each start.
std::vector<sim::Scenario> released(double sim::Scenario::*start, const std::vector<double>& starts,
                                    double duration_s) {
  std::vector<sim::Scenario> all(starts.size());
  for (std::size_t i = 0; i < starts.size(); ++i) {
    all[i].profile = control::ProfileShape::zero;
    all[i].duration_s = duration_s;
    all[i].*start = starts[i];
  }
  return all;
}

std::vector<Sine> sines_of(const sim::Scenario& s) {
  if (s.profile != control::ProfileShape::harmonic) return {};
  return {{s.amplitude, 1.0 / s.period_s, 0.0}};
}

}  // namespace

TEST_CASE("Falls cannot tell dry friction from a constant force, and a flight pushed up can") {
  const double friction_n = 0.7;
  Truth truth;
  truth.kind = Kind::rail_carriage;
  truth.parameters = {1.3, 0.8, 9.81};
  truth.planted = {{"coulomb_friction", {friction_n}}};
  model::Model model;
  model.kind = Kind::rail_carriage;
  model.parameters = {1.3, 0.7, 9.81};
  model.free[1] = {0.0, 4.0};
  Random random(11);
  AxisSensors sensors;
  sensors.quantum = 9e-5;
  sensors.noise = 3e-5;
  const auto record = [&](const sim::Scenario& s) {
    CarriageExperiment e;
    if (s.start_velocity > 0.0)
      e.speeds_mps = {s.start_velocity};
    else
      e.fall_m = s.start_position;
    return record_carriage(truth, e, sensors, random).log;
  };
  const auto falls =
      released(&sim::Scenario::start_position, {0.3, 0.35, 0.4, 0.45, 0.5, 0.55, 0.6, 0.65}, 2.0);
  expect_settled(model, falls, "coulomb_friction", "force_offset", friction_n, record);
}

TEST_CASE("Coasting cannot tell a wrong mass from a wrong damping, and a driven axis can") {
  const double damping_nspm = 120.0;
  Truth truth;
  truth.kind = Kind::motor_axis;
  truth.parameters = {60.0, 80.0};
  truth.planted = {{"damping_error", {damping_nspm}}};
  model::Model model;
  model.kind = Kind::motor_axis;
  model.parameters = {60.0, 80.0};
  Random random(12);
  AxisSensors sensors;
  sensors.quantum = 5e-6;
  sensors.noise = 2e-6;
  const auto record = [&](const sim::Scenario& s) {
    AxisExperiment e;
    e.open_loop = sines_of(s);
    e.start_position = s.start_position;
    e.start_velocity = s.start_velocity;
    e.duration_s = s.duration_s;
    return record_axis(truth, model.parameters, e, sensors, random).log;
  };
  const auto coasts =
      released(&sim::Scenario::start_velocity, {0.3, -0.3, 0.2, -0.2, 0.4, -0.4, 0.25, -0.25}, 2.0);
  expect_settled(model, coasts, "damping_error", "mass_error", damping_nspm, record);
}

TEST_CASE(
    "Drops without torque cannot tell a wrong mass from a wrong spring rate, and hopping with torque can") {
  const double stiffness_npm = 560.0;
  model::Model model;
  model.kind = Kind::hopper_linear;
  model.parameters = {1.554, 605.0, 0.289, 6.0, 1.2, 0.97, 1.0, 0.15, 0.349, 9.81};
  model.free[3] = {0.0, 30.0};
  model.free[4] = {0.0, 10.0};
  Truth truth;
  truth.kind = Kind::hopper_linear;
  truth.parameters = model.parameters;
  truth.parameters[3] = 6.5;
  truth.parameters[4] = 1.1;
  truth.planted = {{"stiffness_error", {stiffness_npm}}};
  Random random(13);
  HopperSensors sensors;
  sensors.report_error_s = 4e-3;
  sensors.bounce_s = 2e-3;
  const auto record = [&](const sim::Scenario& s) {
    HopperExperiment e;
    e.profile = s.profile == control::ProfileShape::harmonic   ? Profile::harmonic
                : s.profile == control::ProfileShape::constant ? Profile::constant
                                                               : Profile::none;
    e.amplitude_nm = s.amplitude;
    e.period_s = s.period_s;
    e.drop_height_m = s.start_position;
    e.hops = 100;
    e.longest_s = s.duration_s;
    REQUIRE(s.start_velocity == 0.0);
    return record_hopper(truth, e, sensors, random).log;
  };
  const auto drops =
      released(&sim::Scenario::start_position, {0.32, 0.33, 0.34, 0.35, 0.36, 0.37, 0.38, 0.39}, 2.5);
  expect_settled(model, drops, "stiffness_error", "mass_error", stiffness_npm, record);
}

}  // namespace furcula::hidden
