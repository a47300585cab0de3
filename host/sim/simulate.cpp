// Simulating scenarios, see simulate.hpp.
#include "host/sim/simulate.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "boards/sim_host/can_board.hpp"
#include "firmware/app/app.hpp"
#include "furcula/dynamics/plants.hpp"
#include "furcula/dynamics/stages.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/sim/recorder.hpp"

namespace furcula::sim {
namespace {

using dynamics::has;
using dynamics::LocationType;
using sim_host::SimBoard;

dynamics::Effects<double> effects_of(const model::Model& model) {
  dynamics::Effects<double> effects;
  for (const auto& [effect, values] : model.effects) effects.set(effect, values);
  return effects;
}

template <class Parameters>
Parameters parameters_of(const model::Model& model) {
  return dynamics::from_table<Parameters>(std::span<const double>(model.parameters));
}

std::map<std::string, std::string> metadata_of(const model::Model& model, const Scenario& scenario,
                                               std::uint64_t seed) {
  static constexpr const char* kProfiles[] = {"zero", "harmonic", "constant"};
  std::string sensors;
  const auto add = [&sensors](bool on, const char* what) {
    if (on) sensors += std::string(sensors.empty() ? "" : " ") + what;
  };
  add(scenario.sensors.quantisation, "quantisation");
  add(scenario.sensors.noise, "noise");
  add(scenario.sensors.bounce, "bounce");
  add(scenario.sensors.jitter, "jitter");
  std::map<std::string, std::string> all{{"sample_rate_hz", "1000"},
                                         {"model", std::string(dynamics::info(model.kind).name)},
                                         {"seed", std::to_string(seed)},
                                         {"profile", kProfiles[static_cast<int>(scenario.profile)]},
                                         {"amplitude", core::shortest(scenario.amplitude)},
                                         {"period_s", core::shortest(scenario.period_s)},
                                         {"sensors", sensors.empty() ? "ideal" : sensors}};
  if (model.clutch && has(model.kind, LocationType::heavy_links))
    all["clutch_in_flight"] = scenario.release_in_flight ? "release" : "hold";
  if (scenario.contraction_m > 0.0) all["contraction_m"] = core::shortest(scenario.contraction_m);
  if (scenario.ground_steps_m > 0.0) all["ground_steps_m"] = core::shortest(scenario.ground_steps_m);
  if (!scenario.faults.empty()) all["planted_faults"] = std::to_string(scenario.faults.size());
  return all;
}

SimBoard& rig_of(SimBoard& board) { return board; }
SimBoard& rig_of(sim_host::CanBoard& board) { return board.rig(); }

template <class Board>
void simulate_hopper(const model::Model& model, Board& seam, const control::Config& config,
                     const Scenario& scenario, log::Log& log) {
  firmware::App app(seam, config);
  SimBoard& board = rig_of(seam);
  HopperRecorder recorder(scenario.duration_s);
  while (seam.wait_for_tick()) {
    app.tick();
    recorder.add(board);
  }
  recorder.finish(log, model.clutch.has_value());
}

void simulate_hopper(const model::Model& model, const Scenario& scenario, std::uint64_t seed, log::Log& log) {
  const sim_host::RigConfig rig = rig_config(model, scenario, seed);
  control::Config config = controller_config(model, scenario);
  if (!control::fits(config.envelope, config.torque, config.limits.torque_nm))
    throw core::DataError(
        "the scenario: [torque] amplitude_nm = " + core::shortest(scenario.amplitude) +
        " takes this robot higher or faster than its controller lets it; expected at most " +
        core::rounded(static_cast<double>(control::amplitude_max_nm(config.envelope, config.torque.shape))) +
        " N m");
  if (needs_bus(scenario)) {
    sim_host::CanBoard board(rig);
    sim_host::CanBoard::adapt(config);
    simulate_hopper(model, board, config, scenario, log);
  } else {
    SimBoard board(rig);
    simulate_hopper(model, board, config, scenario, log);
  }
}

double drive(const Scenario& scenario, double time_s) {
  switch (scenario.profile) {
    case control::ProfileShape::zero:
      return 0.0;
    case control::ProfileShape::constant:
      return scenario.amplitude;
    case control::ProfileShape::harmonic:
      return scenario.amplitude * std::sin(2.0 * std::numbers::pi * time_s / scenario.period_s);
  }
  return 0.0;
}

/// Whether the coil is on at an instant.
bool coil_on(const Scenario& scenario, double time_s) {
  bool on = false;
  for (const machines::ClutchAction& a : scenario.clutch)
    if (a.time_s <= time_s + 1e-9) on = a.release;
  return on;
}

/// A machine without a board of its own, in open loop: its plant between its drive, or its coil, and its encoder.
template <class Machine>
void simulate_open_loop(const model::Model& model, const Scenario& scenario, std::uint64_t seed,
                        log::Log& log) {
  constexpr bool kDriven = dynamics::any_of(Machine::kInfo.location_types, dynamics::LocationType::drive);
  const machines::Rules& rules = machines::rules(model.kind);
  dynamics::Stages<typename Machine::template Plant<double>, double> stages(
      parameters_of<typename Machine::template Parameters<double>>(model), effects_of(model));
  auto& plant = stages.plant();
  plant.reset(scenario.start_position, scenario.start_velocity);
  sim_host::Encoder encoder(scenario.sensors, rules.count, seed);
  sim_host::LiveCommands commands;
  const auto column = [&](std::string_view name) {
    return name.empty() ? nullptr : &log.columns[std::string(name)];
  };
  auto& time_s = *column("time_s");
  auto& position = *column(rules.columns.position);
  auto* input = column(rules.columns.input);
  auto* stop = column(rules.columns.stop);
  const auto rows = static_cast<std::size_t>(std::llround(scenario.duration_s / SimBoard::kPeriodS));
  bool fallen = false;
  for (std::size_t row = 0; row < rows; ++row) {
    if (stop != nullptr) {
      fallen = fallen || plant.position() < 0.0 || (plant.position() == 0.0 && plant.velocity() <= 0.0);
      if (fallen) plant.reset(0.0, 0.0);
      stop->push_back(fallen ? 1.0 : 0.0);
    }
    time_s.push_back(static_cast<double>(row) * SimBoard::kPeriodS);
    position.push_back(encoder.measure(stages.position()));
    double told = 0.0;
    if (input != nullptr) {
      told = kDriven ? drive(scenario, time_s.back()) : coil_on(scenario, time_s.back()) ? 1.0 : 0.0;
      input->push_back(told);
    }
    if constexpr (kDriven) told = commands.torque(stages.actuation(), told, SimBoard::kPeriodS);
    if (!fallen) plant.advance(told, SimBoard::kPeriodS);
  }
}

/// As the log of an encoder with a clock of its own has the columns that it measures: between rows in a
/// straight line, held at the ends.
void skew_columns(double skew_s, const machines::Columns& columns, log::Log& log) {
  const std::vector<double>& time_s = log.time_s();
  for (const std::string_view column : {columns.position, columns.velocity}) {
    const std::string name(column);
    if (!log.has(name)) continue;
    const std::vector<double> original = log.at(name);
    for (std::size_t i = 0; i < time_s.size(); ++i) {
      const double at_s = std::clamp(time_s[i] - skew_s, time_s.front(), time_s.back());
      const auto after = std::upper_bound(time_s.begin() + 1, time_s.end() - 1, at_s);
      const auto k = static_cast<std::size_t>(after - time_s.begin());
      const double share = (at_s - time_s[k - 1]) / (time_s[k] - time_s[k - 1]);
      log.columns[name][i] = original[k - 1] + share * (original[k] - original[k - 1]);
    }
  }
}

/// The position's jump; the velocity is not derived from it.
void slip_column(const dynamics::Sensing<double>& sensing, std::string_view name, log::Log& log) {
  const std::vector<double>& time_s = log.time_s();
  std::vector<double>& position = log.columns.at(std::string(name));
  for (std::size_t i = 0; i < time_s.size(); ++i)
    if (const double step = sensing.slip(time_s[i]); step != 0.0) position[i] += step;
}

}  // namespace

bool needs_bus(const Scenario& scenario) {
  return std::any_of(scenario.faults.begin(), scenario.faults.end(), [](const sim_host::PlannedFault& f) {
    return sim_host::info(f.kind).part == sim_host::RigPart::bus;
  });
}

sim_host::Plant plant_of(const model::Model& model, const dynamics::Effects<double>& effects) {
  if (!has(model.kind, LocationType::heavy_links)) {
    const auto p = parameters_of<dynamics::HopperLinearParameters<double>>(model);
    if (!model.clutch) return sim_host::Plant(p, effects);
    return {p,
            effects,
            {model.clutch->release_delay_s, model.clutch->catch_delay_s,
             model.clutch->auxiliary_stiffness_npm, model.clutch->tooth_pitch_m}};
  }
  const auto p = parameters_of<dynamics::HopperNonlinearParameters<double>>(model);
  if (!model.clutch) return sim_host::Plant(p, effects);
  return {p, clutch_of(model)};
}

dynamics::ClutchParameters<double> clutch_of(const model::Model& model) {
  const double straight_m =
      2.0 * model.parameter("link_length_m") * std::cos(model.parameter("touchdown_angle_rad"));
  const double pull_n =
      model.parameter("stiffness_npm") * std::max(0.0, model.parameter("rest_height_m") - straight_m);
  auto clutch = dynamics::modular_clutch<double>(pull_n);
  clutch.tooth_clearance_m *= model.clutch->tooth_pitch_m / clutch.tooth_pitch_m;
  clutch.tooth_pitch_m = model.clutch->tooth_pitch_m;
  clutch.auxiliary_stiffness_npm = model.clutch->auxiliary_stiffness_npm;
  return clutch;
}

sim_host::RigConfig rig_config(const model::Model& model, const Scenario& scenario, std::uint64_t seed) {
  const dynamics::Effects<double> effects = effects_of(model);
  sim_host::RigConfig rig{plant_of(model, effects)};
  rig.effects = effects;
  if (model.clutch) rig.cable_count_m = kCableCountM;
  rig.ground_steps_m = scenario.ground_steps_m;
  rig.start_height_m = scenario.start_position;
  rig.start_velocity_mps = scenario.start_velocity;
  rig.duration_s = scenario.duration_s;
  rig.sensors = scenario.sensors;
  rig.faults = scenario.faults;
  for (const machines::ClutchAction& a : scenario.clutch) rig.coil_switches.push_back({a.time_s, a.release});
  rig.seed = seed;
  return rig;
}

/// As the image of such a robot would have it: the rail is as long as ten links.
control::EnvelopeConfig envelope_of(const model::Model& model) {
  const control::EnvelopeConfig own;
  const double length_m = model.parameter("link_length_m"),
               angle_rad = model.parameter("touchdown_angle_rad");
  const float size = static_cast<float>(length_m / 0.15);
  control::EnvelopeConfig envelope;
  envelope.mass_kg = static_cast<float>(model.parameter("mass_kg"));
  envelope.straight_leg_rad = static_cast<float>(angle_rad);
  envelope.gravity_mps2 = static_cast<float>(std::max(0.1, model.parameter("gravity_mps2")));
  envelope.apex_max_m = size * own.apex_max_m;
  envelope.apex_fault_m = size * own.apex_fault_m;
  return envelope;
}

control::Config controller_config(const model::Model& model, const Scenario& scenario) {
  const double length_m = model.parameter("link_length_m");
  const double angle_rad = model.parameter("touchdown_angle_rad");
  control::Config config;
  config.link_length_m = static_cast<float>(length_m);
  config.height.metres_per_count = static_cast<float>(sim_host::metres_per_count(scenario.sensors));
  config.phase.touchdown_height_m = static_cast<float>(2.0 * length_m * std::cos(angle_rad));
  config.torque.shape = scenario.profile;
  config.torque.amplitude_nm = static_cast<float>(scenario.amplitude);
  config.torque.period_s = static_cast<float>(scenario.period_s);
  // The rail is as long as ten links, and the leg folds until its links are almost level.
  config.supervisor.height_max_m = static_cast<float>(10.0 * length_m);
  config.supervisor.height_min_m = static_cast<float>(0.2 * length_m);
  config.supervisor.leg_angle_min_rad = static_cast<float>(angle_rad - 0.05);
  config.gravity_mps2 = static_cast<float>(std::max(0.1, model.parameter("gravity_mps2")));
  config.envelope = envelope_of(model);
  control::ClutchConfig& clutch = config.clutch;
  clutch.spring_npm = static_cast<float>(std::max(1.0, model.parameter("stiffness_npm")));
  clutch.spring_rest_m = static_cast<float>(model.parameter("rest_height_m"));
  config.observer.leg_damping_nspm =
      static_cast<float>(model.parameter("damping_stance_nspm") - model.parameter("damping_flight_nspm"));
  if (!has(model.kind, LocationType::heavy_links)) return config;
  clutch.contraction_m = static_cast<float>(scenario.contraction_m);
  clutch.contraction_s = static_cast<float>(0.5 * scenario.contraction_period_s);
  clutch.touchdown_margin_s = static_cast<float>(scenario.catch_before_touchdown_s);
  const dynamics::Links<double> links{model.parameter("inertia_a_kgm2"), model.parameter("inertia_b_kgm"),
                                      model.parameter("inertia_e_kgm"), length_m, model.parameter("mass_kg")};
  const auto inertia = links.pose(angle_rad).inertia;
  config.leg.inertia_kgm2 =
      static_cast<float>(inertia.angle - inertia.coupling * inertia.coupling / inertia.height);
  if (!model.clutch) return config;
  const auto design = clutch_of(model);
  clutch.fitted = 1;
  clutch.release_in_flight = scenario.release_in_flight ? 1 : 0;
  clutch.metres_per_count = static_cast<float>(kCableCountM);
  clutch.tooth_pitch_m = static_cast<float>(design.tooth_pitch_m);
  clutch.tooth_play_m = static_cast<float>(design.tooth_clearance_m);
  config.supervisor.cable_travel_max_m = static_cast<float>(design.travel_m + 0.01);
  if (model.clutch->release_delay_s > 0.0)
    clutch.release_delay_s =
        std::min(clutch.longest_delay_s, static_cast<float>(model.clutch->release_delay_s));
  if (model.clutch->catch_delay_s > 0.0)
    clutch.catch_wait_s = std::min(clutch.longest_delay_s, static_cast<float>(model.clutch->catch_delay_s));
  return config;
}

/// A clutch, a contraction and a ground that moves need a leg that is free in flight.
void refuse_what_has_no_free_leg(const model::Model& model, const Scenario& scenario) {
  const char* what = model.clutch                    ? "a clutch"
                     : scenario.contraction_m > 0.0  ? "[contraction]"
                     : scenario.ground_steps_m > 0.0 ? "[ground]"
                                                     : nullptr;
  if (what == nullptr || !has(model.kind, LocationType::heavy_links)) return;
  for (const auto& [effect, values] : model.effects) {
    dynamics::Effects<double> one;
    one.set(effect, values);
    if (sim_host::Plant::changes_motion(one))
      throw core::DataError(
          "the model: [effect." + std::string(dynamics::info(effect).name) + "] with " + what +
          "; expected effects of the drive and the sensors alone: the leg that is free in flight knows no others");
  }
  if (!dynamics::NonlinearHopper<double>::resolves(
          parameters_of<dynamics::HopperNonlinearParameters<double>>(model)))
    throw core::DataError(
        std::string(
            "the model: inertia_a_kgm2, inertia_b_kgm and inertia_e_kgm are too small, or no links', for ") +
        what + "; expected those of links, as a = 42e-4, b = 75e-4, e = 38e-3 of table 3.1 of document 002");
}

log::Log simulate(const model::Model& model, const Scenario& scenario, std::uint64_t seed) {
  refuse_what_has_no_free_leg(model, scenario);
  log::Log log;
  log.rig = std::string(dynamics::info(model.kind).rig);
  log.metadata = metadata_of(model, scenario, seed);
  if (!has(model.kind, LocationType::drive))
    for (const char* key : {"profile", "amplitude", "period_s"}) log.metadata.erase(key);
  dynamics::with_machine(model.kind, [&]<class Machine>() {
    if constexpr (dynamics::any_of(Machine::kInfo.location_types, LocationType::leg))
      simulate_hopper(model, scenario, seed, log);
    else
      simulate_open_loop<Machine>(model, scenario, seed, log);
  });
  // What an encoder does to the log rather than to a reading.
  const dynamics::Sensing<double> sensing(effects_of(model), 0.0);
  const machines::Columns& columns = machines::rules(model.kind).columns;
  if (sensing.skew_s() && log.rows() > 1) skew_columns(*sensing.skew_s(), columns, log);
  if (sensing.slips()) slip_column(sensing, columns.position, log);
  return log;
}

}  // namespace furcula::sim
