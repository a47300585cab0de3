// The example of document 002, section 3.2.1.
#pragma once

#include <cmath>
#include <numbers>

#include "furcula/dynamics/hopper.hpp"

namespace furcula::test {

inline dynamics::HopperLinearParameters<double> example_hopper() {
  dynamics::HopperLinearParameters<double> p;
  p.mass_kg = 1.5;
  p.stiffness_npm = 600.0;
  p.link_length_m = 0.15;
  p.touchdown_angle_rad = 20.0 * std::numbers::pi / 180.0;
  p.rest_height_m = 2.0 * p.link_length_m * std::cos(p.touchdown_angle_rad);
  p.damping_stance_nspm = 5.0;
  p.damping_flight_nspm = 1.0;
  p.restitution_touchdown = 1.0;
  p.restitution_liftoff = 1.0;
  p.gravity_mps2 = 9.81;
  return p;
}

}  // namespace furcula::test
