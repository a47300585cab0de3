#include "host/reproduce/virtual_rig.hpp"

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "host/core/random.hpp"
#include "host/sim/simulate.hpp"

namespace furcula::reproduce {
namespace {

using core::Random;

void set(model::Model& m, std::string_view name, double value) {
  m.parameters[*dynamics::parameter_index(m.kind, name)] = value;
}

/// Around what the document measured and assumed: 1.62 kg, 605 N/m, 0.289 m; links as in section 3.2.2.
model::Model draw_truth(Random& random) {
  model::Model m;
  m.kind = dynamics::kKindOf<dynamics::machines::HopperNonlinear>;
  m.parameters.resize(dynamics::info(m.kind).parameters.size());
  constexpr double kLength = 0.15;
  set(m, "mass_kg", 1.62 * random.uniform(0.98, 1.02));
  set(m, "stiffness_npm", 605.0 * random.uniform(0.98, 1.02));
  set(m, "rest_height_m", random.uniform(0.288, 0.290));
  set(m, "damping_stance_nspm", random.uniform(4.5, 7.0));
  set(m, "damping_flight_nspm", random.uniform(0.8, 1.5));
  set(m, "restitution_touchdown", 1.0);
  set(m, "restitution_liftoff", 1.0);
  set(m, "link_length_m", kLength);
  set(m, "touchdown_angle_rad", 20.0 * std::numbers::pi / 180.0);
  set(m, "gravity_mps2", 9.81);
  const double lower_kg = 0.1 * random.uniform(0.9, 1.1), lower_m = 0.075 * random.uniform(0.9, 1.1);
  const double upper_kg = 0.8 * random.uniform(0.9, 1.1), upper_m = 0.0194 * random.uniform(0.9, 1.1);
  const double inertia = 20e-4 * random.uniform(0.9, 1.1);
  set(m, "inertia_a_kgm2",
      inertia + lower_kg * (lower_m * lower_m + kLength * kLength) + upper_kg * upper_m * upper_m);
  set(m, "inertia_b_kgm", lower_kg * lower_m);
  set(m, "inertia_e_kgm", lower_kg * (lower_m + kLength) + upper_kg * upper_m);
  m.effects[dynamics::Effect::coulomb_friction] = {random.uniform(0.3, 1.0)};
  m.effects[dynamics::Effect::torque_gain_error] = {random.uniform(0.97, 1.03)};
  return m;
}

void apply(const RigChange& change, model::Model& truth) {
  if (change.weightless_links)
    for (const char* name : {"inertia_a_kgm2", "inertia_b_kgm", "inertia_e_kgm"}) set(truth, name, 0.0);
  if (change.friction_n) truth.effects[dynamics::Effect::coulomb_friction] = {*change.friction_n};
}

/// Into height and velocity; the recorded velocity is differences over 5 ms.
void ring(const RigChange::Ringing& ringing, double touchdown_m, log::Log& log) {
  constexpr double kDifferenceS = 5e-3;
  const auto& time_s = log.at("time_s");
  auto &height_m = log.columns.at("height_m"), &velocity_mps = log.columns.at("velocity_mps");
  double impact_s = -std::numeric_limits<double>::infinity();
  bool above = height_m.front() > touchdown_m;
  const auto vibration = [&](double since_s) {
    return since_s < 0.0 || since_s > 50.0 * ringing.decay_s  // over, or none yet
               ? 0.0
               : ringing.amplitude_m * std::exp(-since_s / ringing.decay_s) *
                     std::sin(2.0 * std::numbers::pi * ringing.frequency_hz * since_s);
  };
  for (std::size_t i = 0; i < height_m.size(); ++i) {
    // A count or two of noise at the crossing is not another impact.
    if ((height_m[i] > touchdown_m) != above && time_s[i] - impact_s > 0.02) {
      above = !above;
      impact_s = time_s[i];
    }
    const double since_s = time_s[i] - impact_s;
    height_m[i] += vibration(since_s);
    velocity_mps[i] += (vibration(since_s) - vibration(since_s - kDifferenceS)) / kDifferenceS;
  }
}

log::Log record(const model::Model& truth, const Experiment& e, double duration_s, std::uint64_t seed,
                const std::string& name, const RigChange& change) {
  sim::Scenario s = sim::default_scenario(truth);
  s.start_position = e.start_m;
  s.duration_s = duration_s;
  s.amplitude = e.amplitude_nm;
  s.period_s = e.period_s;
  s.sensors = {.quantisation = !change.exact_positions,
               .noise = !change.exact_positions,
               .bounce = !change.punctual_switch,
               .jitter = !change.punctual_switch};
  log::Log log = sim::simulate(truth, s, seed);
  if (change.ringing)
    ring(*change.ringing,
         2.0 * truth.parameter("link_length_m") * std::cos(truth.parameter("touchdown_angle_rad")), log);
  log.path = name;
  return log;
}

}  // namespace

VirtualRig draw_rig(std::uint64_t seed, std::size_t stances, std::size_t flights, const RigChange& change) {
  Random random(seed, 0);
  VirtualRig rig;
  rig.truth = draw_truth(random);
  // A kitchen scale, a force plate.
  rig.weighed_kg = rig.truth.parameter("mass_kg") + 0.003 * random.gaussian();
  rig.stiffness_npm = rig.truth.parameter("stiffness_npm") * (1.0 + 0.003 * random.gaussian());
  rig.rest_height_m = rig.truth.parameter("rest_height_m") + 0.0003 * random.gaussian();
  apply(change, rig.truth);
  const auto run = [&](std::size_t count, const char* what, double duration_s, std::vector<Experiment>& list,
                       std::vector<log::Log>& logs) {
    for (std::size_t i = 0; i < count; ++i) {
      list.push_back({random.uniform(0.32, 0.36), random.uniform(1.0, 2.5), random.uniform(0.26, 0.34)});
      logs.push_back(record(rig.truth, list.back(), duration_s, random.next(),
                            std::string(what) + "-" + std::to_string(i + 1), change));
    }
  };
  run(stances, "stride", 0.75, rig.stance_experiments, rig.stance_logs);
  run(flights, "flight", 0.95, rig.flight_experiments, rig.flight_logs);
  return rig;
}

}  // namespace furcula::reproduce
