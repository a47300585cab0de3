#include "host/reproduce/examples.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/nonlinear_hopper.hpp"

namespace furcula::reproduce {
namespace {

constexpr double kStepS = 1e-3;

template <class Plant>
Trajectory run(Plant plant, double link_length_m, const Drive& drive, double start_m, double duration_s) {
  plant.reset(start_m, 0.0);
  Trajectory t;
  double touchdown_s = 0.0, top_m = 0.0;
  const auto steps = static_cast<std::size_t>(std::lround(duration_s / kStepS));
  for (std::size_t i = 0; i <= steps; ++i) {
    const double now_s = static_cast<double>(i) * kStepS;
    const double torque_nm =
        plant.in_stance()
            ? drive.amplitude_nm *
                  std::sin(2.0 * std::numbers::pi * (now_s + 0.5 * kStepS - touchdown_s) / drive.period_s)
            : 0.0;
    t.time_s.push_back(now_s);
    t.height_m.push_back(plant.height_m());
    t.velocity_mps.push_back(plant.velocity_mps());
    // F = -tau / (2 L sin theta), theta of the leg (docs/physics.md).
    t.force_n.push_back(
        plant.in_stance() ? -torque_nm / (2.0 * link_length_m * std::sin(plant.leg_angle_rad())) : 0.0);
    top_m = std::max(top_m, plant.height_m());
    plant.advance(torque_nm, kStepS);
    for (const auto& event : plant.events()) {
      const bool touchdown = event.kind == std::decay_t<decltype(event)>::Kind::touchdown;
      const double ratio = event.velocity_after_mps / event.velocity_before_mps;
      if (touchdown) {
        if (drive.restarted) touchdown_s = now_s + event.offset_s;
        if (!t.touchdown_ratios.empty()) t.apexes_m.push_back(top_m);
        t.touchdown_ratios.push_back(ratio);
        top_m = 0.0;
      } else {
        t.liftoff_ratios.push_back(ratio);
      }
    }
  }
  return t;
}

}  // namespace

dynamics::HopperLinearParameters<double> example_parameters() {
  dynamics::HopperLinearParameters<double> p;
  p.mass_kg = 1.5;
  p.stiffness_npm = 600.0;
  p.damping_stance_nspm = 5.0;
  p.damping_flight_nspm = 1.0;
  p.restitution_touchdown = p.restitution_liftoff = 1.0;
  p.link_length_m = 0.15;
  p.touchdown_angle_rad = 20.0 * std::numbers::pi / 180.0;
  p.rest_height_m = 2.0 * p.link_length_m * std::cos(p.touchdown_angle_rad);
  p.gravity_mps2 = 9.81;
  return p;
}

dynamics::HopperNonlinearParameters<double> table_parameters() {
  dynamics::HopperNonlinearParameters<double> p;
  static_cast<dynamics::HopperLinearParameters<double>&>(p) = example_parameters();
  p.mass_kg = 1.6;
  p.inertia_a_kgm2 = 42e-4;
  p.inertia_b_kgm = 75e-4;
  p.inertia_e_kgm = 38e-3;
  return p;
}

Trajectory hop(const dynamics::HopperLinearParameters<double>& p, const Drive& drive, double start_m,
               double duration_s) {
  return run(dynamics::Hopper<double>(p), p.link_length_m, drive, start_m, duration_s);
}

Trajectory hop(const dynamics::HopperNonlinearParameters<double>& p, const Drive& drive, double start_m,
               double duration_s) {
  return run(dynamics::NonlinearHopper<double>(p), p.link_length_m, drive, start_m, duration_s);
}

dynamics::Links<double> links_of_section_3_2_2(double lower_m, double upper_m) {
  constexpr double kLower = 2 * 0.050, kUpper = 0.500 + 0.300, kLength = 0.15;  // kg, kg, m
  constexpr double kInertia = 2 * 1e-4 + 2 * 9e-4;                              // kg m^2
  dynamics::Links<double> links;
  links.a = kInertia + kLower * (lower_m * lower_m + kLength * kLength) + kUpper * upper_m * upper_m;
  links.b = kLower * lower_m;
  links.e = kLower * (lower_m + kLength) + kUpper * upper_m;
  links.link_length = kLength;
  links.mass = 1.6;
  return links;
}

}  // namespace furcula::reproduce
