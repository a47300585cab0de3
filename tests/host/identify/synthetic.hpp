// Recordings from closed forms, with noise of a known size: nothing here runs the plant under test.
#pragma once

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "host/log/log.hpp"
#include "host/model/model.hpp"

namespace furcula::test {

/// A motor axis under a square wave of force, exactly: between switches x'' = (u - d x')/m has a closed form.
/// Position noise is white, `noise_m` its standard deviation.
inline log::Log axis_log(double mass, double damping, double noise_m, unsigned seed, double seconds = 6.0) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, noise_m > 0.0 ? noise_m : 1.0);
  std::uniform_real_distribution<double> uniform(0.6, 1.4);
  const double rate = damping / mass, period = 0.7 * uniform(random), amplitude = 60.0 * uniform(random);
  double x = 0.0, v = 0.0;
  log::Log log;
  log.path = "axis-" + std::to_string(seed) + ".csv";
  log.rig = "motor_axis";
  for (int n = 0; n <= static_cast<int>(seconds * 500.0); ++n) {
    const double t = 0.002 * n;
    const double u = std::fmod(t, 2.0 * period) < period ? amplitude : -amplitude;
    log.columns["time_s"].push_back(t);
    log.columns["position_m"].push_back(x + (noise_m > 0.0 ? noise(random) : 0.0));
    log.columns["force_n"].push_back(u);
    const double terminal = u / damping, decay = std::exp(-rate * 0.002);
    x += terminal * 0.002 + (v - terminal) * (1.0 - decay) / rate;
    v = terminal + (v - terminal) * decay;
  }
  return log;
}

inline model::Model axis_model(double mass, double damping) {
  model::Model m;
  m.kind = dynamics::Kind::motor_axis;
  m.parameters = {mass, damping};
  m.free = {{0, {1.0, 1000.0}}, {1, {0.0, 5000.0}}};
  return m;
}

/// One flight of a rail carriage, 1 kHz, until it is back at height 0 and 50 ms after, on its stop: with dry
/// friction Fc and a constant force between turning points v' = (F - Fc sgn v - d v)/m - g has a closed form.
struct Flight {
  double mass = 2.0, damping = 1.0, friction = 0.0, force = 0.0;
  double height = 1.0, velocity = 0.0;  ///< at the start
};
inline log::Log flight_log(const Flight& f, double noise_m, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, noise_m > 0.0 ? noise_m : 1.0);
  const double rate = f.damping / f.mass, weight = 9.81 * f.mass;
  // Upwards to the turn, then downwards: (v0, terminal velocity, duration) of each leg.
  const double up = (f.force - f.friction - weight) / f.damping;
  const double down = (f.force + f.friction - weight) / f.damping;
  const double turn_s = f.velocity > 0.0 ? std::log1p(-f.velocity / up) / rate : 0.0;
  const auto travel = [rate](double v0, double terminal, double t) {
    return terminal * t - (v0 - terminal) * std::expm1(-rate * t) / rate;
  };
  const double top = f.height + travel(f.velocity, up, turn_s);
  log::Log log;
  log.path = "flight-" + std::to_string(seed) + ".csv";
  log.rig = "rail_carriage";
  for (int n = 0, lying = 0; lying < 50; ++n) {
    const double t = 1e-3 * n;
    const double z = t < turn_s ? f.height + travel(f.velocity, up, t) : top + travel(0.0, down, t - turn_s);
    const bool touches = z < 0.0;
    lying += touches ? 1 : 0;
    log.columns["time_s"].push_back(t);
    log.columns["height_m"].push_back((touches ? 0.0 : z) + (noise_m > 0.0 ? noise(random) : 0.0));
    log.columns["contact"].push_back(touches ? 1.0 : 0.0);
  }
  return log;
}

/// `count` flights: falls from rest at 0.5 to 1.5 m, or every second one thrown up from the stop with 2.5 to
/// 4.5 m/s. Noise of a count of the rig's encoder.
inline std::vector<log::Log> flight_logs(Flight f, bool throws, unsigned first, unsigned count) {
  std::vector<log::Log> logs;
  for (unsigned i = first; i < first + count; ++i) {
    const double share = std::fmod(0.381966 * i, 1.0);
    const bool thrown = throws && i % 2 == 1;
    f.height = thrown ? 0.0 : 0.5 + share;
    f.velocity = thrown ? 2.5 + 2.0 * share : 0.0;
    logs.push_back(flight_log(f, 9e-5, i));
  }
  return logs;
}

inline model::Model carriage_model() {
  model::Model m;
  m.kind = dynamics::Kind::rail_carriage;
  m.parameters = {2.0, 1.0, 9.81};
  m.free = {{1, {0.0, 20.0}}};
  return m;
}

/// The bench of document 002, section 5.1; with `free` its friction, delays and pitch are to be found from
/// values that are off.
inline model::Model clutch_bench_model(bool free = false) {
  model::Model m;
  m.kind = dynamics::Kind::clutch_bench;
  m.parameters = {1.0, 60e-3 / (2.0 * std::numbers::pi), 2e-6, 2e-5, 0.0, 3e-3, 1.8e-3, 0.010, 0.010};
  if (free) m.free = {{3, {0.0, 2e-3}}, {5, {2.4e-3, 3.6e-3}}, {7, {0.0, 0.04}}, {8, {0.0, 0.06}}};
  return m;
}

/// The hopper of document 002's identification: known k, z0, g; mass and dampings free.
inline model::Model hopper_model() {
  model::Model m;
  m.kind = dynamics::Kind::hopper_linear;
  const auto set = [&](const char* name, double value) {
    m.parameters[*dynamics::parameter_index(m.kind, name)] = value;
  };
  m.parameters.assign(dynamics::kHopperLinearParameters.size(), 0.0);
  set("mass_kg", 1.62);
  set("stiffness_npm", 605.0);
  set("rest_height_m", 0.289);
  set("damping_stance_nspm", 5.0);
  set("damping_flight_nspm", 1.0);
  set("restitution_touchdown", 1.0);
  set("restitution_liftoff", 1.0);
  set("link_length_m", 0.15);
  set("touchdown_angle_rad", 20.0 * std::numbers::pi / 180.0);
  set("gravity_mps2", 9.81);
  m.free[*dynamics::parameter_index(m.kind, "mass_kg")] = {1.2, 2.0};
  m.free[*dynamics::parameter_index(m.kind, "damping_stance_nspm")] = {0.0, 30.0};
  return m;
}

}  // namespace furcula::test
