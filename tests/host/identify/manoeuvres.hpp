// The main manoeuvre of document 002, simulated: the spring is let go in flight, the leg folded and stretched, the
// spring caught and pulled at before touch-down.
#pragma once

#include <string>
#include <vector>

#include "host/sim/simulate.hpp"
#include "tests/host/identify/synthetic.hpp"

namespace furcula::test {

/// The robot with links and a clutch; mass and damping free.
inline model::Model manoeuvring_model() {
  const model::Model linear = hopper_model();
  model::Model m;
  m.kind = dynamics::Kind::hopper_nonlinear;
  m.parameters = linear.parameters;
  for (const double links : {42e-4, 75e-4, 38e-3}) m.parameters.push_back(links);
  for (const char* name : {"mass_kg", "damping_stance_nspm", "damping_flight_nspm"}) {
    const auto i = *dynamics::parameter_index(m.kind, name);
    m.free[i] = {0.5 * m.parameters[i], 2.0 * m.parameters[i]};
  }
  m.clutch = model::Clutch{0.02, 0.02, 20.0, 4.2857e-3};
  return m;
}

/// `count` recordings of 3 s; the leg folds by 3 to 5 cm.
inline std::vector<log::Log> manoeuvres(const model::Model& truth, int count, unsigned seed) {
  std::vector<log::Log> logs;
  for (int i = 0; i < count; ++i) {
    sim::Scenario s = sim::default_scenario(truth);
    s.start_position = 0.36 + 0.004 * i;
    s.amplitude = 2.0 + 0.1 * (i % 3);
    s.period_s = 0.3;
    s.duration_s = 3.0;
    s.sensors = {.quantisation = true, .noise = true, .bounce = true, .jitter = true};
    s.release_in_flight = truth.clutch.has_value();
    s.contraction_m = 0.03 + 0.005 * (i % 5);
    s.contraction_period_s = 0.3;
    logs.push_back(sim::simulate(truth, s, seed + static_cast<unsigned>(i)));
    logs.back().path = "manoeuvres-" + std::to_string(seed) + "-" + std::to_string(i) + ".csv";
  }
  return logs;
}

}  // namespace furcula::test
