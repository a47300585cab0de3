// Machines and scenarios for the tests of the simulated rig.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/log/log.hpp"
#include "host/model/model.hpp"
#include "host/sim/scenario.hpp"

namespace furcula::test {

/// The example of 002 section 3.2.1: L 0.15 m, k 600 N/m, m 1.5 kg, ds 5 and df 1 N s/m, no loss at impacts.
inline model::Model example_hopper() {
  model::Model model;
  model.kind = dynamics::Kind::hopper_linear;
  model.parameters = {1.5, 600.0, 0.28190778623577246, 5.0, 1.0, 1.0, 1.0, 0.15, 0.3490658503988659, 9.81};
  return model;
}
inline constexpr double kTouchdownM = 0.28190778623577246;  // 2 L cos 20 deg

/// Its input: T 2 N m, P 0.3 s, from 0.35 m at rest.
inline sim::Scenario example_scenario(double duration_s) {
  sim::Scenario scenario;
  scenario.start_position = 0.35;
  scenario.duration_s = duration_s;
  scenario.profile = control::ProfileShape::harmonic;
  scenario.amplitude = 2.0;
  scenario.period_s = 0.3;
  return scenario;
}

/// The robot of 002 chapter 5: links of table 3.1, spring relaxed at 0.289 m, a clutch with a belt of 3 mm.
inline model::Model robot_with_clutch() {
  model::Model model = example_hopper();
  model.kind = dynamics::Kind::hopper_nonlinear;
  model.parameters[2] = 0.289;
  for (const double inertia : {42e-4, 75e-4, 38e-3}) model.parameters.push_back(inertia);
  model.clutch = model::Clutch{0.020, 0.020, 20.0, 3e-3 / 0.7};
  return model;
}

/// Hops of 7 cm with the spring let go and the leg folded by 5 cm in each flight.
inline sim::Scenario clutch_scenario(double duration_s) {
  sim::Scenario scenario = example_scenario(duration_s);
  scenario.amplitude = 3.0;
  scenario.release_in_flight = true;
  scenario.contraction_m = 0.05;
  return scenario;
}

/// Local maxima of the height above the touch-down height, each the highest of a stretch above it.
inline std::vector<double> apexes(const log::Log& log) {
  std::vector<double> found;
  double highest = 0.0;
  for (const double z : log.at("height_m")) {
    if (z > kTouchdownM + 0.002) {
      highest = z > highest ? z : highest;
    } else if (highest > 0.0) {
      found.push_back(highest);
      highest = 0.0;
    }
  }
  return found;
}

}  // namespace furcula::test
