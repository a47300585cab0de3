// See sizes.hpp.
//
// Each figure is drawn within 10 %; signs are drawn where nothing else is said.
//
//   on the hopper (1.3 to 1.9 kg)       small    medium   large
//   coulomb_friction     Fc             0.5      1.5      3      N
//   stribeck_friction    Fc             0.5      1        2      N, Fs / Fc 1.8 to 3, vs 0.1 to 0.3 m/s
//   asymmetric_friction  mean           0.5      1.5      3      N, one way 1.5 times, the other 0.5 times
//   quadratic_drag       at 1.2 m/s     0.5      1.5      3      N
//   binding_spot                        1        3        6      N over 2 to 5 cm
//   damping_error                       0.4      1        2.5    N s/m more in the guide
//   force_offset                        0.5      1.5      3      N
//   guide_tilt                          8        15       25     degrees
//   mass_error                          3        6        12     %
//   stiffness_error                     3        6        12     %
//   rest_height_error                   2        5        10     mm, upwards only if large (below)
//   spring_preload                      1        3        6      N, upwards only if large (below)
//   spring_hardening     at 7 cm        1.5      4        10     N, hardening only if large
//   spring_hysteresis                   2        6        15     %
//   leg_inertia                         0.3      0.6      1      of the published rig's a, b, e (002, table 3.1)
//   torque_gain_error                   6        12       25     %
//   torque_offset                       0.05     0.15     0.35   N m, extending the leg only if large
//   actuator_delay                      3        8        20     ms
//   actuator_lag                        4        10       25     ms
//   torque_saturation                   1.5      1.1      0.8    N m
//   torque_ripple                       0.08     0.18     0.32   N m, 12 to 36 cycles a revolution
//   thermal_derating     down to        0.85     0.7      0.5    with 1 to 3 s
//   backlash                            0.02     0.05     0.1    rad
//   touchdown_loss       alpha          0.95     0.9      0.8    the model's is held at 1
//   liftoff_loss         alpha          0.95     0.9      0.8    the model's is held at 1
//   ground_compliance                   30       10       4      kN/m with 10 to 40 N s/m
//   toe_sticking                        8        16       32     N
//   bump_stop                           0.4      1.5      4      kN/m beyond 40 to 55 mm
//   encoder_offset                      1        3        6      mm
//   height_scale_error                  1.5      4        8      %
//   height_eccentricity                 0.3      0.8      2      mm, 0.1 to 0.2 m a turn
//   encoder_slip                        0.5      2        8      mm
//   contact_delay                       5        10       18     ms
//   time_skew                           1.5      4        10     ms
//
//   on the axes
//   all frictions and drags             3        8        20     % of the RMS of the command without the effect
//   force_offset, torque_ripple         3        8        20     % of it
//   binding_spot                        10       25       60     % of it, over a tenth to a third of the travel
//   damping_error        at top speed   5        12       30     % of it
//   mass_error, torque_gain_error       4        8        20     %
//   actuator_delay, time_skew           3        8        20     ms
//   actuator_lag                        4        10       30     ms
//   torque_saturation                   90       70       50     % of the peak command
//   thermal_derating     down to        0.93     0.85     0.65   with 1.5 to 4 s
//   encoder_offset                      0.02     0.06     0.15   rad
//   height_eccentricity, encoder_slip   0.5      1.5      4      % of the travel
//
//   on a hopper with a clutch
//   late_catch                          5        12       25     ms more than modelled
//   incomplete_release                  0.08     0.2      0.4
//   auxiliary_spring                    40       100      200    N/m more than modelled
//
//   on the clutch bench (0.7 to 1.4 kg on a belt)
//   coulomb_friction                    4        10       20     % of the weight
//   damping_error        at 0.4 m/s     4        10       20     % of the weight more
//   clutch_slip                         3        2.2      1.5    times the weight is held
//   late_catch                          4        10       25     ms more than modelled
//   auxiliary_spring                    30       60       100    N/m more than modelled (the belt goes some 5 cm)
//   encoder_slip                        0.03     0.1      0.3    rad
//
// A spring slack by 6 N at touch-down would have the ground pull on the toe: no such rig exists, so a large
// preload pushes upwards, and so do a large error of the rest height and a large offset of the torque.
#include "tests/hidden/sizes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace furcula::hidden {

namespace {

constexpr double kTwoPi = 2.0 * std::numbers::pi;

struct BySize {
  Size size;
  double operator()(double small, double medium, double large) const {
    return size == Size::small ? small : size == Size::medium ? medium : large;
  }
};

// In braces, so that draws among the values are made in their order.
Planted planted(std::string_view law, const Values& values) { return {std::string(law), values}; }

// Laws of friction and drag in terms of one force (or torque), on every kind.
Planted friction_of(std::string_view law, double force, double drag_speed, double stribeck_velocity,
                    Random& random) {
  if (law == "stribeck_friction")
    return planted(law, {{force, force * random.uniform(1.8, 3.0), stribeck_velocity}});
  if (law == "asymmetric_friction") {
    const double lean = 0.5 * random.sign();
    return planted(law, {{force * (1 + lean), force * (1 - lean)}});
  }
  if (law == "quadratic_drag") return planted(law, {{force / (drag_speed * drag_speed)}});
  if (law == "force_offset") return planted(law, {{force * random.sign()}});
  if (law == "coulomb_friction") return planted(law, {{force}});
  throw std::invalid_argument("no size for " + std::string(law));
}

}  // namespace

Planted hopper_law(std::string_view law, Size size, const model::Model& model, Random& random) {
  const BySize by{size};
  const bool large = size == Size::large;
  const auto is = [&](std::string_view name) { return law == name; };
  const double scatter = random.uniform(0.9, 1.1);
  // Upwards only if large.
  const auto upwards = [&] {
    const double direction = random.sign();
    return large ? 1.0 : direction;
  };
  if (is("stiffness_error"))
    return planted(law,
                   {model.parameter("stiffness_npm") * (1 + random.sign() * scatter * by(0.03, 0.06, 0.12))});
  if (is("spring_preload")) return planted(law, {{upwards() * scatter * by(1, 3, 6)}});
  if (is("torque_gain_error")) return planted(law, {{1 + random.sign() * scatter * by(0.06, 0.12, 0.25)}});
  if (is("touchdown_loss") || is("liftoff_loss")) return planted(law, {{1 - scatter * by(0.05, 0.1, 0.2)}});
  if (is("stribeck_friction"))
    return friction_of(law, scatter * by(0.5, 1, 2), 0, random.uniform(0.1, 0.3), random);
  if (is("binding_spot"))
    return planted(law, {{scatter * by(1, 3, 6), random.uniform(0.24, 0.31), random.uniform(0.02, 0.05)}});
  if (is("damping_error")) return planted(law, {{scatter * by(0.4, 1, 2.5)}});
  if (is("guide_tilt")) return planted(law, {{scatter * by(8, 15, 25) * std::numbers::pi / 180}});
  if (is("mass_error"))
    return planted(law,
                   {{model.parameter("mass_kg") * (1 + random.sign() * scatter * by(0.03, 0.06, 0.12))}});
  if (is("rest_height_error"))
    return planted(law, {{model.parameter("rest_height_m") + upwards() * scatter * by(0.002, 0.005, 0.010)}});
  if (is("spring_hardening"))
    return planted(law, {{upwards() * scatter * by(1.5, 4, 10) / std::pow(0.07, 3)}});
  if (is("spring_hysteresis")) return planted(law, {{scatter * by(0.02, 0.06, 0.15)}});
  if (is("leg_inertia")) {
    const double share = scatter * by(0.3, 0.6, 1.0);
    return planted(law, {{42e-4 * share, 75e-4 * share, 38e-3 * share}});
  }
  if (is("torque_offset")) return planted(law, {{-upwards() * scatter * by(0.05, 0.15, 0.35)}});
  if (is("actuator_delay")) return planted(law, {{scatter * by(3e-3, 8e-3, 20e-3)}});
  if (is("actuator_lag")) return planted(law, {{scatter * by(4e-3, 10e-3, 25e-3)}});
  if (is("torque_saturation")) return planted(law, {{scatter * by(1.5, 1.1, 0.8)}});
  if (is("torque_ripple"))
    return planted(law, {{scatter * by(0.08, 0.18, 0.32), std::round(random.uniform(12, 36)),
                          random.uniform(-std::numbers::pi, std::numbers::pi)}});
  if (is("thermal_derating")) return planted(law, {{1 - scatter * by(0.15, 0.3, 0.5), random.uniform(1, 3)}});
  if (is("backlash")) return planted(law, {{scatter * by(0.02, 0.05, 0.1)}});
  if (is("ground_compliance")) return planted(law, {{scatter * by(30e3, 10e3, 4e3), random.uniform(10, 40)}});
  if (is("toe_sticking")) return planted(law, {{scatter * by(8, 16, 32)}});
  if (is("bump_stop")) return planted(law, {{random.uniform(0.040, 0.055), scatter * by(0.4e3, 1.5e3, 4e3)}});
  if (is("encoder_offset")) return planted(law, {{random.sign() * scatter * by(1e-3, 3e-3, 6e-3)}});
  if (is("height_scale_error")) return planted(law, {{1 + random.sign() * scatter * by(0.015, 0.04, 0.08)}});
  if (is("height_eccentricity"))
    return planted(law, {{scatter * by(0.3e-3, 0.8e-3, 2e-3), random.uniform(0.1, 0.2),
                          random.uniform(-std::numbers::pi, std::numbers::pi)}});
  if (is("encoder_slip"))
    return planted(law, {{random.sign() * scatter * by(0.5e-3, 2e-3, 8e-3), random.uniform(0.6, 1.8)}});
  if (is("contact_delay")) return planted(law, {{random.sign() * scatter * by(5e-3, 10e-3, 18e-3)}});
  if (is("time_skew")) return planted(law, {{random.sign() * scatter * by(1.5e-3, 4e-3, 10e-3)}});
  // Outside of the catalogue: one size.
  if (is("side_mass"))
    return planted(law, {{model.parameter("mass_kg") * random.uniform(0.08, 0.15), random.uniform(4, 9),
                          random.uniform(0.02, 0.08)}});
  if (is("cable_snag"))
    return planted(law, {{random.uniform(5, 10), random.chance(0.5) ? random.uniform(0.23, 0.27) : 0.30,
                          random.uniform(0.008, 0.015)}});
  if (is("periodic_force"))
    return planted(law, {{random.uniform(1, 2.5), random.uniform(5, 12), random.uniform(0, kTwoPi)}});
  if (is("gusts"))
    return planted(law, {{random.uniform(4, 8), random.uniform(0.05, 0.12), random.uniform(2, 4)}});
  if (is("warming_friction")) return planted(law, {{random.uniform(2, 4), random.uniform(1, 3)}});
  if (is("fading_spring")) return planted(law, {{random.uniform(0.1, 0.2), random.uniform(1, 3)}});
  if (is("creeping_spring")) return planted(law, {{random.uniform(0.15, 0.3), random.uniform(0.2, 0.6)}});
  if (is("drive_dropout")) return planted(law, {{0.02, random.uniform(4, 8)}});
  if (is("drive_deadband")) return planted(law, {{random.uniform(0.4, 0.7)}});
  if (is("sticking_counts")) return planted(law, {{random.uniform(0.8e-3, 2e-3)}});
  if (is("torque_crosstalk")) return planted(law, {{random.sign() * random.uniform(0.5e-3, 1.5e-3)}});
  if (is("wandering_zero"))
    return planted(law, {{random.uniform(1e-3, 3e-3), random.uniform(1.1, 2.7), random.uniform(0, kTwoPi)}});
  return friction_of(law, scatter * by(0.5, 1.5, 3), 1.2, 0, random);
}

std::optional<Planted> clutch_law(std::string_view law, Size size, const model::Model& model,
                                  Random& random) {
  const BySize by{size};
  const double scatter = random.uniform(0.9, 1.1);
  if (law == "late_catch")
    return planted(law, {{model.clutch->catch_delay_s + scatter * by(5e-3, 12e-3, 25e-3)}});
  if (law == "incomplete_release") return planted(law, {{scatter * by(0.08, 0.2, 0.4)}});
  if (law == "auxiliary_spring")
    return planted(law, {{model.clutch->auxiliary_stiffness_npm + scatter * by(40, 100, 200)}});
  return std::nullopt;
}

Planted bench_law(std::string_view law, Size size, const model::Model& model, Random& random) {
  const BySize by{size};
  const double scatter = random.uniform(0.9, 1.1);
  const double load_n = model.parameter("load_mass_kg") * 9.81, radius_m = model.parameter("pulley_radius_m");
  const auto is = [&](std::string_view name) { return law == name; };
  if (is("coulomb_friction")) return planted(law, {{load_n * radius_m * scatter * by(0.04, 0.1, 0.2)}});
  if (is("damping_error"))
    return planted(law, {{model.parameter("damping_nmspr") +
                          load_n * radius_m * scatter * by(0.04, 0.1, 0.2) / (0.4 / radius_m)}});
  if (is("clutch_slip")) return planted(law, {{load_n * scatter * by(3.0, 2.2, 1.5)}});
  if (is("late_catch"))
    return planted(law, {{model.parameter("catch_delay_s") + scatter * by(4e-3, 10e-3, 25e-3)}});
  if (is("auxiliary_spring"))
    return planted(law, {{model.parameter("auxiliary_stiffness_npm") + scatter * by(30, 60, 100)}});
  if (is("encoder_slip"))
    return planted(law, {{random.sign() * scatter * by(0.03, 0.1, 0.3), random.uniform(0.4, 1.5)}});
  // Outside of the catalogue: one size.
  if (is("cable_snag"))
    return planted(law, {{load_n * radius_m * random.uniform(0.3, 0.6), random.uniform(1.0, 2.0),
                          random.uniform(0.3, 0.8)}});
  if (is("warming_friction"))
    return planted(law, {{load_n * radius_m * random.uniform(0.2, 0.4), random.uniform(0.4, 1.0)}});
  if (is("catch_scatter")) return planted(law, {{random.uniform(6e-3, 12e-3)}});
  throw std::invalid_argument("no size for " + std::string(law));
}

Planted axis_law(std::string_view law, Size size, const model::Model& model, const AxisHabits& habits,
                 Random& random) {
  const BySize by{size};
  const auto is = [&](std::string_view name) { return law == name; };
  const double stribeck_velocity = habits.speed * random.uniform(0.05, 0.25);
  const double scatter = random.uniform(0.9, 1.1);
  const double share = habits.input * scatter * by(0.03, 0.08, 0.2);
  if (is("binding_spot"))
    return planted(law,
                   {{habits.input * scatter * by(0.1, 0.25, 0.6), habits.reach * random.uniform(-0.5, 0.5),
                     habits.reach * random.uniform(0.2, 0.6)}});
  if (is("damping_error")) {
    const double more = habits.input * scatter * by(0.05, 0.12, 0.3) / habits.speed;
    const double nominal = model.parameters.back();
    const double sign = nominal > 1.5 * more ? random.sign() : 1.0;
    return planted(law, {{nominal + sign * more}});
  }
  if (is("mass_error"))
    return planted(law, {{model.parameters[0] * (1 + random.sign() * scatter * by(0.04, 0.08, 0.2))}});
  if (is("torque_gain_error")) return planted(law, {{1 + random.sign() * scatter * by(0.04, 0.08, 0.2)}});
  if (is("actuator_delay")) return planted(law, {{scatter * by(3e-3, 8e-3, 20e-3)}});
  if (is("time_skew")) return planted(law, {{random.sign() * scatter * by(3e-3, 8e-3, 20e-3)}});
  if (is("actuator_lag")) return planted(law, {{scatter * by(4e-3, 10e-3, 30e-3)}});
  if (is("torque_saturation"))
    return planted(law, {{habits.peak * std::min(1.0, scatter) * by(0.9, 0.7, 0.5)}});
  if (is("torque_ripple"))
    return planted(
        law, {share, std::round(random.uniform(3, 12)), random.uniform(-std::numbers::pi, std::numbers::pi)});
  if (is("thermal_derating"))
    return planted(law, {{1 - scatter * by(0.07, 0.15, 0.35), random.uniform(1.5, 4)}});
  if (is("encoder_offset")) return planted(law, {{random.sign() * scatter * by(0.02, 0.06, 0.15)}});
  if (is("height_eccentricity"))
    return planted(law,
                   {{habits.reach * scatter * by(0.005, 0.015, 0.04), habits.reach * random.uniform(0.4, 1),
                     random.uniform(-std::numbers::pi, std::numbers::pi)}});
  if (is("encoder_slip"))
    return planted(
        law, {random.sign() * habits.reach * scatter * by(0.005, 0.015, 0.04), random.uniform(0.8, 3.0)});
  // Outside of the catalogue: one size.
  if (is("side_mass"))
    return planted(law, {{model.parameters[0] * random.uniform(0.1, 0.2), random.uniform(3, 8),
                          random.uniform(0.02, 0.08)}});
  if (is("end_stop"))
    return planted(law, {{habits.reach * random.uniform(0.4, 0.6),
                          habits.input / (0.3 * habits.reach) * random.uniform(0.7, 1.4)}});
  if (is("cable_snag"))
    return planted(law, {{habits.input * random.uniform(0.8, 1.6), habits.reach * random.uniform(-0.4, 0.4),
                          habits.reach * random.uniform(0.06, 0.12)}});
  if (is("detents"))
    return planted(law, {{habits.input * random.uniform(0.15, 0.3), habits.reach * random.uniform(0.08, 0.25),
                          random.uniform(0, kTwoPi)}});
  if (is("periodic_force"))
    return planted(
        law, {habits.input * random.uniform(0.1, 0.25), random.uniform(3, 9), random.uniform(0, kTwoPi)});
  if (is("gusts"))
    return planted(
        law, {habits.input * random.uniform(0.4, 0.8), random.uniform(0.05, 0.12), random.uniform(2, 4)});
  if (is("warming_friction"))
    return planted(law, {{habits.input * random.uniform(0.2, 0.35), random.uniform(1, 3)}});
  if (is("drive_dropout")) return planted(law, {{0.02, random.uniform(4, 8)}});
  if (is("drive_deadband")) return planted(law, {{habits.input * random.uniform(0.25, 0.45)}});
  if (is("sticking_counts")) return planted(law, {{habits.reach * random.uniform(0.005, 0.015)}});
  if (is("torque_crosstalk"))
    return planted(law, {{random.sign() * habits.reach / habits.input * random.uniform(0.01, 0.03)}});
  if (is("wandering_zero"))
    return planted(law, {{habits.reach * random.uniform(0.01, 0.03), random.uniform(0.4, 0.9),
                          random.uniform(0, kTwoPi)}});
  return friction_of(law, share, habits.speed, stribeck_velocity, random);
}

}  // namespace furcula::hidden
