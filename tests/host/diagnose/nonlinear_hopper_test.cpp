// Recordings of a robot whose links have inertia, simulated with the leg free in flight and the ground as a
// constraint, which is not what the fits run.
#include <catch2/catch.hpp>
#include <cmath>

#include "host/diagnose/diagnose.hpp"
#include "host/diagnose/result.hpp"
#include "host/identify/identification.hpp"
#include "host/result/diagnosis_json.hpp"
#include "host/sim/simulate.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using dynamics::Kind;

namespace {

void set(model::Model& m, const char* name, double value) {
  m.parameters[*dynamics::parameter_index(m.kind, name)] = value;
}
void free(model::Model& m, const char* name, double lower, double upper) {
  m.free[*dynamics::parameter_index(m.kind, name)] = {lower, upper};
}

/// Table 3.1 of document 002.
model::Model robot() {
  model::Model m = test::hopper_model();
  m.kind = Kind::hopper_nonlinear;
  m.free.clear();
  m.parameters.insert(m.parameters.end(), {42e-4, 75e-4, 38e-3});
  return m;
}

std::vector<log::Log> recordings(const model::Model& truth, std::uint64_t seed, int count) {
  std::vector<log::Log> logs;
  for (int i = 0; i < count; ++i) {
    sim::Scenario s = sim::default_scenario(truth);
    s.start_position = 0.33 + 0.005 * i;
    s.duration_s = 3.0;
    s.amplitude = 2.0 + 0.3 * (i % 4);
    s.period_s = 0.28 + 0.02 * (i % 5);
    s.sensors = {.quantisation = true, .noise = true, .bounce = true, .jitter = false};
    logs.push_back(sim::simulate(truth, s, seed + static_cast<std::uint64_t>(i)));
    logs.back().path = "robot-" + std::to_string(seed + static_cast<std::uint64_t>(i)) + ".csv";
  }
  return logs;
}

}  // namespace

TEST_CASE("Mass and dampings of the non-linear robot are found from guesses that are off", "[long]") {
  model::Model guess = robot();
  set(guess, "mass_kg", 1.4);
  set(guess, "damping_stance_nspm", 8.0);
  set(guess, "damping_flight_nspm", 0.3);
  free(guess, "mass_kg", 1.0, 2.5);
  free(guess, "damping_stance_nspm", 0.0, 30.0);
  free(guess, "damping_flight_nspm", 0.0, 10.0);
  const auto out = identify::identify(guess, recordings(robot(), 1, 6), recordings(robot(), 50, 2));
  for (const auto& found : out.estimations.front().parameters) {
    CAPTURE(found.name, found.value);
    if (found.name == "mass_kg") CHECK(found.value == Approx(1.62).epsilon(0.005));
    if (found.name == "damping_stance_nspm") CHECK(found.value == Approx(5.0).epsilon(0.03));
    if (found.name == "damping_flight_nspm") CHECK(found.value == Approx(1.0).epsilon(0.1));
  }
  CHECK(out.estimations.front().parameters.size() == 3);
}

TEST_CASE("With its own model the non-linear robot is adequate, and a planted cause is named", "[long]") {
  model::Model model = robot();
  free(model, "damping_stance_nspm", 0.0, 30.0);
  free(model, "damping_flight_nspm", 0.0, 10.0);
  const auto clean = diagnose::diagnose(model, recordings(robot(), 1, 5), recordings(robot(), 50, 2));
  INFO(result::to_json_text(diagnose::result_of(clean)));
  CHECK(clean.verdict == diagnose::Verdict::adequate);
  CHECK(clean.findings.empty());
  model::Model rubbing = robot();
  rubbing.effects[dynamics::Effect::coulomb_friction] = {1.8};
  const auto d = diagnose::diagnose(model, recordings(rubbing, 1, 5), recordings(rubbing, 50, 2));
  INFO(result::to_json_text(diagnose::result_of(d)));
  REQUIRE(d.findings.size() == 1);
  CHECK(d.findings[0].effect == dynamics::Effect::coulomb_friction);
  CHECK(d.findings[0].parameters.at("force_n").value == Approx(1.8).epsilon(0.05));
}

TEST_CASE("A model without links is told that it lacks them", "[long]") {
  // Links three times as heavy as the published ones; what a linear model can take up is free.
  model::Model truth = robot();
  set(truth, "inertia_a_kgm2", 3 * 42e-4);
  set(truth, "inertia_b_kgm", 3 * 75e-4);
  set(truth, "inertia_e_kgm", 3 * 38e-3);
  model::Model linear = test::hopper_model();
  free(linear, "damping_flight_nspm", 0.0, 10.0);
  free(linear, "restitution_touchdown", 0.5, 1.1);
  free(linear, "restitution_liftoff", 0.5, 1.1);
  const auto d = diagnose::diagnose(linear, recordings(truth, 1, 6), recordings(truth, 50, 2));
  INFO(result::to_json_text(diagnose::result_of(d)));
  REQUIRE(!d.findings.empty());
  CHECK(d.findings[0].effect == dynamics::Effect::leg_inertia);
  CHECK(d.findings[0].explainable_nmse_removed > 0.9);
}
