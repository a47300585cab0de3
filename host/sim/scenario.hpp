// A scenario: how an experiment starts, what drives it, what is wrong with its sensors, and what fails when
// (docs/contracts.md, section 4).
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "boards/sim_host/faults.hpp"
#include "boards/sim_host/sensors.hpp"
#include "host/machines/rules.hpp"
#include "host/model/model.hpp"

namespace furcula::sim {

struct Scenario : machines::Run {
  Scenario() = default;
  explicit Scenario(machines::Run run) : Run(std::move(run)) {}

  sim_host::SensorErrors sensors;
  std::vector<sim_host::PlannedFault> faults;  ///< on the hopper alone
  // Where the leg is free in flight (hopper_nonlinear):
  bool release_in_flight = false;           ///< needs a clutch
  double catch_before_touchdown_s = 0.012;  ///< the catch verified
  double contraction_m = 0.0;               ///< by which the leg folds in flight
  double contraction_period_s = 0.4;  ///< folding and stretching take half of it, or what the flight leaves
  double ground_steps_m = 0.0;        ///< the ground is at another height within this in each flight
};

/// When the first fault is planted; absent: none is.
inline std::optional<double> first_fault_s(const Scenario& scenario) {
  std::optional<double> first_s;
  for (const sim_host::PlannedFault& fault : scenario.faults)
    if (!first_s || fault.time_s < *first_s) first_s = fault.time_s;
  return first_s;
}

/// What holds for everything that a scenario file leaves out: the hopper starts at rest a quarter above its
/// touch-down height and is driven with 2 N m, 0.3 s; an axis starts at rest at 0 and is driven with 1 N or
/// 1 N m, 1 s; a rail carriage starts at rest 1 m above its stop; the belt of
/// a clutch bench hangs at 0, is released at 0.1 s and caught at 0.14 s; 5 s, the carriage 1 s, the bench
/// 0.5 s; ideal sensors; no faults.
Scenario default_scenario(const model::Model& model);

/// A scenario file for a model of this kind; an example is in docs/logs_and_models.md. @throws core::DataError
/// naming file, line, key, value and what was expected.
///
/// - `[start]` height_m, velocity_mps (rail_carriage: from 0, its stop, upwards); on motor_axis position_m,
///   velocity_mps; on rotary_joint angle_rad, velocity_radps.
///   On clutch_bench angle_rad.
/// - `[run]` duration_s.
/// - `[[clutch]]` time_s, action ("release", "catch"), in the order of time and in turn: on clutch_bench, and
///   on hopper_linear with a clutch.
/// - `[torque]` profile ("harmonic", "constant", "zero"), amplitude_nm, period_s; on motor_axis it is
///   `[force]`, and amplitude_n; nothing drives a rail carriage.
/// - `[sensors]` quantisation, noise, bounce, jitter (true or false; the last two on the hopper alone).
/// - `[clutch]` in_flight ("release", "hold"), catch_before_touchdown_s; on a hopper with a clutch.
/// - `[contraction]` amplitude_m, period_s; `[ground]` steps_m: on hopper_nonlinear.
/// - `[[fault]]` time_s, kind, duration_s: on the hopper; without duration_s to the end, a late_tick 5 ms, a
///   task_stuck 50 ms. With a fault on the bus drive and encoders are on one (boards/sim_host/can_board.hpp).
/// - `[expect]`: expectation.hpp.
Scenario read_scenario(const std::string& path, const model::Model& model);

/// The same on text; `name` stands for the path in messages.
Scenario parse_scenario(std::string_view text, const std::string& name, const model::Model& model);

/// A scenario file for models of this kind that reads back as the same scenario.
std::string format_scenario(const Scenario& scenario, dynamics::Kind kind);

}  // namespace furcula::sim
