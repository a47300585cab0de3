// The table of the controller's adjustable parameters: what a person may change over a bus, within which
// bounds, and its place in the configuration. Modbus registers, the saved image, `furcula param`, docs/modbus.md
// and the signs in check() follow from it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

#include "furcula/control/config.hpp"

namespace furcula::control {

/// A row of the table of parameters.
struct Parameter {
  std::uint16_t number;         ///< from 1 on; stable: saved images and register addresses have it
  std::string_view name;        ///< stable
  std::string_view unit;        ///< empty: a number or a code
  float least,                  ///< smallest value allowed
      most;                     ///< largest value allowed
  bool whole;                   ///< an integer: a fraction is rejected
  std::string_view meaning;     ///< one phrase for documentation
  float (*get)(const Config&);  ///< reads the value from a configuration
  void (*put)(Config&, float);  ///< writes it, without checks: see bus::set()
};

namespace table {

/// Row of a member of a block of the configuration; whole numbers stay below 2^24, which a float holds.
template <auto Block, auto Member>
constexpr Parameter parameter(std::uint16_t number, std::string_view name, std::string_view unit, float least,
                              float most, std::string_view meaning) {
  using Value = std::remove_cvref_t<decltype((Config{}.*Block).*Member)>;
  return {number,
          name,
          unit,
          least,
          most,
          !std::is_same_v<Value, float>,
          meaning,
          [](const Config& c) { return static_cast<float>((c.*Block).*Member); },
          [](Config& c, float x) { (c.*Block).*Member = static_cast<Value>(x); }};
}

/// Row of a member of the configuration itself, which must be a float.
template <auto Member>
constexpr Parameter parameter(std::uint16_t number, std::string_view name, std::string_view unit, float least,
                              float most, std::string_view meaning) {
  return {number,
          name,
          unit,
          least,
          most,
          false,
          meaning,
          [](const Config& c) { return c.*Member; },
          [](Config& c, float x) { c.*Member = x; }};
}

}  // namespace table

namespace table_of_parameters {

using table::parameter;

// Blocks of the configuration.
inline constexpr auto kHeight = &Config::height;
inline constexpr auto kDebounce = &Config::debounce;
inline constexpr auto kPhase = &Config::phase;
inline constexpr auto kTorque = &Config::torque;
inline constexpr auto kLimits = &Config::limits;
inline constexpr auto kSupervisor = &Config::supervisor;
inline constexpr auto kClutch = &Config::clutch;
inline constexpr auto kCoil = &Config::coil;
inline constexpr auto kLeg = &Config::leg;
inline constexpr auto kBench = &Config::bench;

/// The table, in the order of numbers. A number is never given to another parameter; a new parameter takes the next one.
inline constexpr std::array kAll{
    parameter<kTorque, &TorqueProfileConfig::shape>(
        1, "torque_shape", "", 0.0f, 2.0f, "Torque over a stance; 0: none, 1: harmonic, 2: constant."),
    parameter<kTorque, &TorqueProfileConfig::amplitude_nm>(
        2, "torque_amplitude_nm", "N m", -20.0f, 20.0f,
        "Of the torque; positive pumps energy in, negative takes it out."),
    parameter<kTorque, &TorqueProfileConfig::period_s>(3, "torque_period_s", "s", 0.01f, 2.0f,
                                                       "Of the harmonic torque."),
    parameter<kLimits, &LimitsConfig::torque_nm>(4, "torque_limit_nm", "N m", 0.1f, 40.0f,
                                                 "Magnitude that no command exceeds."),
    parameter<kLimits, &LimitsConfig::torque_rate_nmps>(
        5, "torque_rate_limit_nmps", "N m/s", 200.0f, 20000.0f, "Change of the torque in a second, at most."),
    parameter<&Config::link_length_m>(6, "link_length_m", "m", 0.05f, 0.5f, "Of each of the four links."),
    parameter<&Config::gravity_mps2>(7, "gravity_mps2", "m/s^2", 9.5f, 10.0f, "Along the rail."),
    parameter<kHeight, &HeightConfig::metres_per_count>(8, "height_metres_per_count", "m", 1e-8f, 0.001f,
                                                        "Of the rail's encoder."),
    parameter<kDebounce, &DebounceConfig::rule>(9, "debounce_rule", "", 0.0f, 1.0f,
                                                "Of the contact switch; 0: two readings, 1: settling."),
    parameter<kDebounce, &DebounceConfig::close_settle_s>(
        10, "close_settle_s", "s", 0.001f, 0.02f, "That the switch reads closed before it counts, settling."),
    parameter<kDebounce, &DebounceConfig::open_settle_s>(
        11, "open_settle_s", "s", 0.001f, 0.02f, "That the switch reads open before it counts, settling."),
    parameter<kPhase, &PhaseConfig::touchdown_height_m>(12, "touchdown_height_m", "m", 0.05f, 1.0f,
                                                        "Of the body with the straight leg on the ground."),
    parameter<kPhase, &PhaseConfig::touchdown_margin_m>(13, "touchdown_margin_m", "m", 0.0f, 0.1f,
                                                        "So far above it the switch may report touch-down."),
    parameter<kPhase, &PhaseConfig::liftoff_margin_m>(14, "liftoff_margin_m", "m", 0.0f, 0.05f,
                                                      "So far above it a straight leg has left the ground."),
    parameter<kPhase, &PhaseConfig::shortest_stance_s>(15, "shortest_stance_s", "s", 0.0f, 0.1f,
                                                       "An open switch before that is touch-down's bounce."),
    parameter<kSupervisor, &SupervisorConfig::tick_interval_max_us>(
        16, "tick_interval_max_us", "us", 1050.0f, 3000.0f,
        "Between two ticks; more is the fault late_tick."),
    parameter<kSupervisor, &SupervisorConfig::sample_age_max_us>(
        17, "sample_age_max_us", "us", 500.0f, 3000.0f, "Of the sensors' sample; more is stale_input."),
    parameter<kSupervisor, &SupervisorConfig::height_min_m>(18, "height_min_m", "m", 0.0f, 1.0f,
                                                            "The rail's lower end."),
    parameter<kSupervisor, &SupervisorConfig::height_max_m>(19, "height_max_m", "m", 0.1f, 5.0f,
                                                            "The rail's upper end."),
    parameter<kSupervisor, &SupervisorConfig::leg_angle_min_rad>(20, "leg_angle_min_rad", "rad", 0.0f, 1.5f,
                                                                 "The straight leg's stop."),
    parameter<kSupervisor, &SupervisorConfig::leg_angle_max_rad>(21, "leg_angle_max_rad", "rad", 0.1f, 1.57f,
                                                                 "The folded leg's stop."),
    parameter<kSupervisor, &SupervisorConfig::height_mismatch_m>(
        22, "height_mismatch_m", "m", 0.005f, 0.06f,
        "By which encoder and leg may differ; more is encoder_implausible."),
    parameter<kSupervisor, &SupervisorConfig::contact_margin_m>(
        23, "contact_margin_m", "m", 0.005f, 0.06f,
        "So far off the touch-down height the switch is to agree; else contact_implausible."),
    parameter<kSupervisor, &SupervisorConfig::cable_travel_max_m>(
        24, "cable_travel_max_m", "m", 0.01f, 0.5f, "Of the clutch's cable; more is cable_implausible."),
    parameter<kSupervisor, &SupervisorConfig::missed_catches_max>(
        25, "missed_catches_max", "", 1.0f, 20.0f,
        "Stances running on a spring that is not caught; then clutch_not_caught."),
    parameter<kClutch, &ClutchConfig::fitted>(26, "clutch_fitted", "", 0.0f, 1.0f,
                                              "1: the robot has a clutch."),
    parameter<kClutch, &ClutchConfig::release_in_flight>(
        27, "clutch_release_in_flight", "", 0.0f, 1.0f,
        "1: the spring is let go in flight and caught again."),
    parameter<kClutch, &ClutchConfig::metres_per_count>(28, "cable_metres_per_count", "m", 1e-8f, 0.001f,
                                                        "Of the cable's encoder, as seen along the leg."),
    parameter<kClutch, &ClutchConfig::tooth_pitch_m>(29, "tooth_pitch_m", "m", 0.0005f, 0.02f,
                                                     "Of the clutch's belt, as seen along the leg."),
    parameter<kClutch, &ClutchConfig::tooth_play_m>(30, "tooth_play_m", "m", 0.0f, 0.02f,
                                                    "Of a caught belt, as seen along the leg."),
    parameter<kClutch, &ClutchConfig::spring_npm>(31, "spring_npm", "N/m", 10.0f, 20000.0f,
                                                  "Stiffness of the spring along the leg."),
    parameter<kClutch, &ClutchConfig::spring_rest_m>(32, "spring_rest_m", "m", 0.05f, 1.0f,
                                                     "Leg's length at which the caught spring is relaxed."),
    parameter<kClutch, &ClutchConfig::contraction_m>(33, "contraction_m", "m", 0.0f, 0.2f,
                                                     "By which the leg folds in flight."),
    parameter<kClutch, &ClutchConfig::contraction_s>(34, "contraction_s", "s", 0.05f, 1.0f,
                                                     "That folding and stretching take."),
    parameter<kClutch, &ClutchConfig::release_delay_s>(35, "release_delay_s", "s", 0.0f, 0.06f,
                                                       "From coil on to a belt that moves, to begin with."),
    parameter<kClutch, &ClutchConfig::catch_wait_s>(36, "catch_wait_s", "s", 0.0f, 0.06f,
                                                    "From coil off to a belt that is held, to begin with."),
    parameter<kCoil, &CoilConfig::peak_s>(37, "coil_peak_s", "s", 0.005f, 0.2f,
                                          "Of full supply, to pull the key in."),
    parameter<kCoil, &CoilConfig::hold_duty>(38, "coil_hold_duty", "", 0.0f, 1.0f,
                                             "Share of the supply that keeps the key in."),
    parameter<kCoil, &CoilConfig::heat_max>(
        39, "coil_heat_max", "", 0.01f, 1.0f,
        "Mean square of the duty that the coil stands for ever; 1: full supply."),
    parameter<kLeg, &LegPositionConfig::stiffness_nmprad>(40, "leg_stiffness_nmprad", "N m/rad", 1.0f, 200.0f,
                                                          "Of the leg that is moved in flight."),
    parameter<kLeg, &LegPositionConfig::damping_nmsprad>(41, "leg_damping_nmsprad", "N m s/rad", 0.01f, 2.0f,
                                                         "Of the leg that is moved in flight."),
    parameter<kLeg, &LegPositionConfig::inertia_kgm2>(42, "leg_inertia_kgm2", "kg m^2", 0.0f, 0.02f,
                                                      "Of the leg about the hip, toe in the air."),
    parameter<kBench, &BenchConfig::on_bench>(
        43, "on_bench", "", 0.0f, 1.0f,
        "1: a clutch on its bench, without leg, rail and drive: hop makes one trial."),
    parameter<kBench, &BenchConfig::window_ticks>(44, "bench_window_ms", "ms", 1.0f, 500.0f,
                                                  "That the coil is on in a trial."),
    parameter<&Config::host_timeout_s>(
        45, "host_timeout_s", "s", 0.0f, 60.0f,
        "Without a read or write from a host, until a robot that a host started stops; 0: it runs on."),
};

}  // namespace table_of_parameters

/// The table of parameters; the index is the number less 1.
inline constexpr auto& kParameters = table_of_parameters::kAll;

static_assert(
    [] {
      for (std::size_t i = 0; i < kParameters.size(); ++i)
        if (kParameters[i].number != i + 1 || !(kParameters[i].least < kParameters[i].most)) return false;
      return true;
    }(),
    "the parameters stand in the order of their numbers, from 1 on");

/// The parameter of a number, or null.
constexpr const Parameter* parameter_numbered(std::uint32_t number) {
  return number >= 1 && number <= kParameters.size() ? &kParameters[number - 1] : nullptr;
}
/// The parameter of a name, or null.
constexpr const Parameter* parameter_named(std::string_view name) {
  for (const Parameter& p : kParameters)
    if (p.name == name) return &p;
  return nullptr;
}

/// Whether a value is within the parameter's bounds, and an integer where it is to be one. False for NaN.
constexpr bool allows(const Parameter& p, float value) {
  if (!(value >= p.least && value <= p.most)) return false;
  return !p.whole || value == static_cast<float>(static_cast<std::int32_t>(value));
}

}  // namespace furcula::control
