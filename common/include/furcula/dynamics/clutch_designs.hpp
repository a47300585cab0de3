// The two clutches of 002 chapter 5 in numbers. What the document gives is marked; the rest is chosen so that
// what it gives comes out, within what printed parts and small solenoids have.
#pragma once

#include "furcula/dynamics/clutch.hpp"
#include "furcula/dynamics/clutch_bench.hpp"

namespace furcula::dynamics {

/// The bench's (section 5.1): about 20 N from a stroke of 2.5 mm [given], a belt of 3 mm pitch and 1.8 mm
/// teeth [given].
template <class T>
constexpr ClutchParameters<T> bench_clutch() {
  ClutchParameters<T> p;
  p.solenoid = {T(6.0),    T(5e-3),   T(1.6e-4),
                T(2.5e-3), T(1.5e-3), T(1.0)};  // 20 N at 2 A (12 V) and 4 mm of air
  p.key_mass_kg = T(0.03);
  p.key_damping_nspm = T(1.0);
  p.pressing_force_n = T(8.0);
  p.return_stiffness_npm = T(2000.0);
  p.tooth_height_m = T(1.8e-3);
  p.hold_depth_m = T(0.4e-3);
  p.holding_ratio = T(6.0);  // "almost linear" in the pressing force [given]; the ratio is not
  p.tip_friction = T(0.3);
  p.flank_friction = T(0.2);
  p.tooth_pitch_m = T(3e-3);
  p.tooth_clearance_m = T(1e-3);
  p.cable_mass_kg = T(0.02);
  p.cable_damping_nspm = T(0.2);
  p.cable_friction_n = T(0.3);
  p.travel_m = T(0.5);
  return p;
}

/// The bench of figure 5.5: 1 kg on a belt over a pulley of 20 teeth [load given].
template <class T>
constexpr ClutchBenchSetup<T> release_catch_bench() {
  ClutchBenchSetup<T> p;
  p.clutch = bench_clutch<T>();
  p.load_mass_kg = T(1.0);
  p.pulley_radius_m = T(20 * 3e-3 / (2.0 * 3.14159265358979323846));
  p.pulley_inertia_kgm2 = T(2e-6);
  p.gravity_mps2 = T(9.81);
  return p;
}

/// The modular clutch (section 5.2): 5 mm of stroke, up to 15 kg held at 1.5 A and 10 V [given], of which the
/// key uses the last 2.3 mm; on a cable that gives 7 cm for 10 cm of leg [given], all as seen along the leg.
/// The auxiliary spring is pretensioned to bring the cable home against `pull_n`, which is what the leg's
/// spring has with the leg straight, with 1 N to spare.
template <class T>
constexpr ClutchParameters<T> modular_clutch(const T& pull_n = T(0.0)) {
  constexpr double kCablePerLeg = 0.7;
  ClutchParameters<T> p = bench_clutch<T>();
  p.solenoid = {T(10.0 / 1.5), T(20e-3), T(1.33e-4),
                T(2.3e-3),     T(1e-3),  T(1.0)};  // 150 N at 1.5 A when closed
  p.pressing_force_n = T(10.0);
  p.return_stiffness_npm = T(1500.0);
  p.holding_ratio = T(20.0 * kCablePerLeg);  // holds the hops of chapter 4: 80 N along the leg
  p.tip_friction = T(0.3 * kCablePerLeg);
  p.flank_friction = T(0.2 / kCablePerLeg);
  p.tooth_pitch_m = T(3e-3 / kCablePerLeg);
  p.tooth_clearance_m = T(1e-3 / kCablePerLeg);
  p.cable_mass_kg = T(0.03 * kCablePerLeg * kCablePerLeg);
  p.cable_damping_nspm = T(0.5);
  p.cable_friction_n = T(0.3);
  p.auxiliary_stiffness_npm = T(20.0);
  p.auxiliary_preload_n = T(1.0) + pull_n;
  p.travel_m = T(0.07 / kCablePerLeg);
  return p;
}

}  // namespace furcula::dynamics
