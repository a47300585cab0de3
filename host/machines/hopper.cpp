// The two hoppers, whose rigs are the same.
#include "host/machines/hopper.hpp"

#include <algorithm>
#include <cmath>

#include "boards/sim_host/sensors.hpp"
#include "host/core/message.hpp"
#include "host/machines/rules.hpp"

namespace furcula::machines {
namespace {

using control::ProfileShape;
using core::rounded;

Run usual_run(const model::Model& m) {
  Run run;
  run.start_position =
      1.25 * 2.0 * m.parameter("link_length_m") * std::cos(m.parameter("touchdown_angle_rad"));
  run.amplitude = 2.0;
  run.period_s = 0.3;
  return run;
}

void experiments(ExperimentLibrary& experiment_library, const model::Model& model, const Reach& reach) {
  const double top = touchdown_height_m(model);
  const double torque = reach.input > 0.0 ? reach.input : usual_run(model).amplitude;
  const double drop = std::clamp(reach.highest, top + 0.02, top + 0.15);
  const auto centimetres = [&](double height) { return rounded(1e2 * (height - top), 2) + " cm"; };
  for (double rise : {0.02, 0.05, 0.1})
    experiment_library.add("a drop from " + centimetres(top + rise) + " above touch-down, without torque",
                           experiment_library.start(top + rise, 0.0, 3.0));
  for (double speed : {1.0, 1.5, 2.0})
    experiment_library.add(
        "a flight pushed up from the touch-down height at " + rounded(speed, 3) + " m/s, without torque",
        experiment_library.start(top + 1e-4, speed, 2.0));
  for (double share : {0.5, 1.0})
    for (double period_s : {0.22, 0.27, 0.33, 0.4})
      experiment_library.add("hopping with a harmonic torque of " + rounded(share * torque, 3) + " N m and " +
                                 rounded(period_s, 3) + " s, dropped from " + centimetres(drop),
                             ExperimentLibrary::driven(experiment_library.start(drop, 0.0, 4.0),
                                                       ProfileShape::harmonic, share * torque, period_s));
  experiment_library.add("hopping with a constant torque of " + rounded(0.4 * torque, 3) +
                             " N m, dropped from " + centimetres(drop),
                         ExperimentLibrary::driven(experiment_library.start(drop, 0.0, 4.0),
                                                   ProfileShape::constant, 0.4 * torque, 1.0));
  experiment_library.add("a long run for drift: 60 s of hopping with a harmonic torque of " +
                             rounded(torque, 3) + " N m and 0.3 s",
                         ExperimentLibrary::driven(experiment_library.start(drop, 0.0, 60.0),
                                                   ProfileShape::harmonic, torque, 0.3));
  // On the ground: about where the spring bears the body, by less than what would lift it off.
  const double rest = model.parameter("rest_height_m") - model.parameter("mass_kg") *
                                                             model.parameter("gravity_mps2") /
                                                             model.parameter("stiffness_npm");
  const double room = top - rest;
  const double length = model.parameter("link_length_m");
  const double lever = std::sqrt(std::max(4.0 * length * length - rest * rest, 1e-6));
  for (double share : {0.4, 0.8})
    experiment_library.add(
        "a slow compression: standing, a harmonic torque of 2 s that moves the body by " +
            rounded(1e3 * share * room, 2) + " mm",
        ExperimentLibrary::driven(experiment_library.start(rest, 0.0, 8.0), ProfileShape::harmonic,
                                  std::min(torque, share * room * model.parameter("stiffness_npm") * lever),
                                  2.0));
  experiment_library.add("a swing without torque: let go on the ground " + rounded(0.9e3 * room, 2) +
                             " mm below where it stands",
                         experiment_library.start(rest - 0.9 * room, 0.0, 3.0));
}

constexpr Rules kRules{
    .channel = "height",
    .columns = {.position = "height_m",
                .velocity = "velocity_mps",
                .input = "torque_cmd_nm",
                .report = "torque_nm",
                .leg_angle = "leg_angle_rad",
                .coil = "solenoid",
                .cable = "clutch_travel_m",
                .touchdown = "contact"},
    .keys = {.position = "height_m",
             .position_unit = "m",
             .position_least = 1e-3,
             .position_most = 10.0,
             .velocity = "velocity_mps",
             .velocity_unit = "m/s",
             .velocity_most = 20.0,
             .drive = "torque",
             .amplitude = "amplitude_nm",
             .amplitude_unit = "N m",
             .amplitude_most = 20.0},  // what the controller commands at most
    .count = sim_host::kHeightCountM,
    .cut = Cut::strides,
    .usual_run = usual_run,
    .experiments = experiments,
    .weight = [](const model::Model& m) { return m.parameter("mass_kg") * m.parameter("gravity_mps2"); },
    .fit_expects = "a stance or a flight of at least 30 ms",
    .window_expected =
        [](const model::Model& m) {
          return "stride from apex to apex: expected the height to rise above the touch-down height of " +
                 rounded(touchdown_height_m(m), 4) + " m at least twice in a recording";
        },
};

}  // namespace

double touchdown_height_m(const model::Model& model) {
  return 2.0 * model.parameter("link_length_m") * std::cos(model.parameter("touchdown_angle_rad"));
}

}  // namespace furcula::machines

const furcula::machines::Rules& furcula::dynamics::machines::HopperLinear::rules() {
  return furcula::machines::kRules;
}
const furcula::machines::Rules& furcula::dynamics::machines::HopperNonlinear::rules() {
  return furcula::machines::kRules;
}
