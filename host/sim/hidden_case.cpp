// Drawing the virtual hopper, see hidden_case.hpp.
#include "host/sim/hidden_case.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <string>

#include "host/core/random.hpp"
#include "host/sim/simulate.hpp"

namespace furcula::sim {
namespace {

using core::Random;
using dynamics::Effect;

constexpr dynamics::Kind kKind = dynamics::kKindOf<dynamics::machines::HopperLinear>;

constexpr int kExperiments = 8;
constexpr double kExperimentS = 3.0;  // about six hops
constexpr int kFewestHops = 5;

void set(model::Model& model, std::string_view name, double value) {
  model.parameters[*dynamics::parameter_index(model.kind, name)] = value;
}

/// Around the published rig (document 002, section 4.2: m 1.554 kg, k 605 N/m, ds 6.42, df 1.18 N s/m). The
/// body has been weighed and the spring pulled, the dampings are guesses that identification may move.
model::Model draw_model(Random& random) {
  model::Model model;
  model.kind = kKind;
  model.parameters.resize(dynamics::info(model.kind).parameters.size());
  const double mass_kg = random.uniform(1.4, 1.8);
  set(model, "mass_kg", mass_kg);
  set(model, "stiffness_npm", mass_kg * random.uniform(370.0, 410.0));
  set(model, "rest_height_m", random.uniform(0.288, 0.291));
  set(model, "damping_stance_nspm", random.uniform(4.5, 7.0));
  set(model, "damping_flight_nspm", random.uniform(0.8, 1.5));
  set(model, "restitution_touchdown", random.uniform(0.94, 1.0));
  set(model, "restitution_liftoff", 1.0);
  set(model, "link_length_m", 0.15);
  set(model, "touchdown_angle_rad", 20.0 * std::numbers::pi / 180.0);
  set(model, "gravity_mps2", 9.81);
  for (const char* damping : {"damping_stance_nspm", "damping_flight_nspm"})
    model.free[*dynamics::parameter_index(model.kind, damping)] = {0.0, 5.0 * model.parameter(damping)};
  return model;
}

/// The catalogue's clear sizes, or, of what depends on the machine, a size for it.
std::array<double, dynamics::kMaxEffectParameters> draw_size(Effect cause, const model::Model& model,
                                                             Random& random) {
  const double force_n = random.uniform(1.5, 3.0);
  const double sign = random.coin() ? 1.0 : -1.0;
  switch (cause) {
    case Effect::coulomb_friction:
      return {force_n};
    case Effect::stribeck_friction:
      return {0.7 * force_n, 0.7 * force_n * random.uniform(1.8, 3.0), random.uniform(0.1, 0.3)};
    case Effect::asymmetric_friction:
      return {force_n * (1.0 + 0.5 * sign), force_n * (1.0 - 0.5 * sign)};
    case Effect::quadratic_drag:
      return {force_n / (1.2 * 1.2)};  // at 1.2 m/s, about the speed at touch-down
    case Effect::force_offset:
      return {force_n * sign};
    case Effect::stiffness_error:
      return {model.parameter("stiffness_npm") * (1.0 + sign * random.uniform(0.06, 0.12))};
    case Effect::spring_preload:
      return {2.0 * force_n};
    case Effect::touchdown_loss:
      return {model.parameter("restitution_touchdown") * random.uniform(0.8, 0.9)};
    case Effect::binding_spot:
      return {3.0 * force_n, random.uniform(0.26, 0.30), random.uniform(0.01, 0.03)};
    case Effect::mass_error:
      return {model.parameter("mass_kg") * (1.0 + sign * random.uniform(0.06, 0.12))};
    case Effect::rest_height_error:
      return {model.parameter("rest_height_m") + sign * random.uniform(0.004, 0.008)};
    case Effect::spring_hardening:
      return {force_n / (0.05 * 0.05 * 0.05)};  // at a compression of 5 cm
    case Effect::torque_offset:
      return {0.15 * force_n * sign};
    case Effect::torque_ripple:
      return {0.2 * force_n, std::round(random.uniform(10.0, 30.0)), random.uniform(-1.0, 1.0)};
    case Effect::thermal_derating:
      return {random.uniform(0.5, 0.75), random.uniform(0.5, 1.5)};
    case Effect::height_eccentricity:
      return {random.uniform(5e-4, 2e-3), random.uniform(0.03, 0.1), random.uniform(-1.0, 1.0)};
    case Effect::encoder_slip:
      return {0.09e-3 * std::round(sign * random.uniform(30.0, 90.0)), random.uniform(0.5, 2.0)};
    case Effect::time_skew:
      return {sign * 1e-3 * std::round(random.uniform(5.0, 15.0))};  // whole rows
    default: {
      const dynamics::EffectInfo& e = dynamics::info(cause);
      std::array<double, dynamics::kMaxEffectParameters> values{};
      for (std::size_t i = 0; i < e.parameter_count; ++i) {
        const auto& p = e.parameter_table[i];
        const auto [low, high] = e.search.clear[i];
        const double size = high > low ? random.uniform(low, high) : low;
        const double side = !(p.lower < p.neutral) ? 1.0 : p.neutral < p.upper ? sign : -1.0;
        values[i] = (std::isnan(p.neutral) ? 0.0 : p.neutral) + side * size;
      }
      return values;
    }
  }
}

/// Falls through the touch-down height.
int hops(const log::Log& log, const model::Model& model) {
  const double touchdown_m =
      2.0 * model.parameter("link_length_m") * std::cos(model.parameter("touchdown_angle_rad"));
  int count = 0;
  bool above = false;
  for (double height_m : log.at("height_m")) {
    if (height_m > touchdown_m + 0.003) above = true;
    if (above && height_m < touchdown_m) {
      above = false;
      ++count;
    }
  }
  return count;
}

log::Log record(const model::Model& truth, int number, std::uint64_t seed, Random& random) {
  Scenario scenario = default_scenario(truth);
  scenario.start_position = number == 0 ? random.uniform(0.36, 0.38) : random.uniform(0.33, 0.36);
  scenario.duration_s = kExperimentS;
  scenario.sensors = {.quantisation = true, .noise = true, .bounce = true, .jitter = true};
  // One drop without torque, one with a constant one, then harmonics of several sizes and periods.
  scenario.profile = number == 0   ? control::ProfileShape::zero
                     : number == 1 ? control::ProfileShape::constant
                                   : control::ProfileShape::harmonic;
  scenario.amplitude = number == 1 ? random.uniform(0.4, 0.7) : random.uniform(1.4, 2.4);
  scenario.period_s = random.uniform(0.26, 0.36);
  log::Log log = simulate(truth, scenario, seed + static_cast<std::uint64_t>(number));
  // Whoever runs the rig turns the torque up until it keeps hopping.
  while (scenario.profile == control::ProfileShape::harmonic && hops(log, truth) < kFewestHops &&
         scenario.amplitude < 3.0) {
    scenario.amplitude *= 1.15;
    log = simulate(truth, scenario, seed + static_cast<std::uint64_t>(number));
  }
  log.metadata["experiment"] = "hop-0" + std::to_string(number + 1);
  return log;
}

}  // namespace

HiddenCase draw_hidden_case(std::uint64_t seed) {
  Random random(seed, 0);
  HiddenCase m;
  m.model = draw_model(random);
  m.truth = m.model;
  m.truth.free.clear();
  for (const char* damping : {"damping_stance_nspm", "damping_flight_nspm"})
    set(m.truth, damping, m.model.parameter(damping) * random.uniform(0.85, 1.15));
  std::vector<Effect> possible;
  for (const dynamics::EffectInfo& e : dynamics::kCatalogue)
    if (dynamics::applies(e.effect, kKind) &&
        e.effect != Effect::damping_error &&  // the dampings are free: identification finds it
        e.effect != Effect::backlash &&       // hardly moves the body: shows in the leg angle
        !dynamics::needs_clutch(e.effect))
      possible.push_back(e.effect);
  m.cause = possible[random.next() % possible.size()];
  m.truth.effects[m.cause] = draw_size(m.cause, m.model, random);
  for (int i = 0; i < kExperiments; ++i) m.logs.push_back(record(m.truth, i, seed, random));
  return m;
}

}  // namespace furcula::sim
