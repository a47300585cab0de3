// The example simulations of document 002, chapter 3: one stride after the other of the linear model, and a
// single stride of both models.
#pragma once

#include <vector>

#include "furcula/dynamics/links.hpp"
#include "furcula/dynamics/machines.hpp"

namespace furcula::reproduce {

/// One entry a millisecond.
struct Trajectory {
  std::vector<double> time_s, height_m, velocity_mps, force_n;  ///< force: of the motor along the leg, up
  std::vector<double> apexes_m;                          ///< highest point of each flight but the first
  std::vector<double> touchdown_ratios, liftoff_ratios;  ///< velocity after over velocity before
};

/// Harmonic torque, zero in flight: positive `amplitude_nm` pumps energy in, negative is what the signs of
/// eq. 3.3 as printed make of it.
struct Drive {
  double amplitude_nm = 2.0, period_s = 0.3;
  bool restarted =
      true;  ///< at each touch-down (eq. 4.1); else T sin(2 pi t / P), as section 3.2.1 prints it
};

/// Section 3.2.1: L 0.15 m, k 600 N/m, m 1.5 kg, ds 5, df 1 N s/m, z0 = 2 L cos 20 deg, alphas 1.
dynamics::HopperLinearParameters<double> example_parameters();

/// Table 3.1; the linear model is the base of the non-linear one, with its own touch-down loss of 0.9.
dynamics::HopperNonlinearParameters<double> table_parameters();

/// By the exact step of eq. 3.8 at 1 kHz.
Trajectory hop(const dynamics::HopperLinearParameters<double>& parameters, const Drive& drive, double start_m,
               double duration_s);
/// By the equations of section 3.2.2, the leg on its stop in flight unless it swings.
Trajectory hop(const dynamics::HopperNonlinearParameters<double>& parameters, const Drive& drive,
               double start_m, double duration_s);

/// The links of section 3.2.2 by the definition of a, b and e (below eq. 3.14): lower links of 50 g, upper
/// ones of 500 g and 300 g, 1e-4 and 9e-4 kg m^2 about their centres, 0.15 m long. Where the centres are is
/// not printed: `lower_m` and `upper_m` from the joint above.
dynamics::Links<double> links_of_section_3_2_2(double lower_m, double upper_m);

}  // namespace furcula::reproduce
