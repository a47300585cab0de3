// Drops the hopper without damping and compares with the closed form of free fall and of the spring's half
// swing.
#include <cmath>
#include <cstdio>

#include "furcula/dynamics/hopper.hpp"

namespace {

int failures = 0;

void expect(const char* what, double actual, double expected, double tolerance) {
  if (std::abs(actual - expected) <= tolerance) return;
  std::printf("%s is %.12g; expected %.12g\n", what, actual, expected);
  ++failures;
}

}  // namespace

int main() {
  furcula::dynamics::HopperLinearParameters<double> p{};
  p.mass_kg = 1.5;
  p.stiffness_npm = 600.0;
  p.link_length_m = 0.15;
  p.touchdown_angle_rad = 0.35;
  p.restitution_touchdown = p.restitution_liftoff = 1.0;
  p.gravity_mps2 = 9.81;
  const double touchdown_m = 2.0 * p.link_length_m * std::cos(p.touchdown_angle_rad);
  p.rest_height_m = touchdown_m;

  const double drop_m = 0.05;
  furcula::dynamics::Hopper<double> hopper(p);
  hopper.reset(touchdown_m + drop_m, 0.0);
  double time_s = 0.0, touchdown_s = 0.0, liftoff_s = 0.0, impact_mps = 0.0, lowest_m = 1.0;
  for (int tick = 0; tick < 1000 && liftoff_s == 0.0; ++tick) {
    hopper.advance(0.0, 0.001);
    for (const auto& event : hopper.events()) {
      if (event.kind == furcula::dynamics::ContactEvent<double>::Kind::touchdown) {
        touchdown_s = time_s + event.offset_s;
        impact_mps = event.velocity_before_mps;
      } else {
        liftoff_s = time_s + event.offset_s;
      }
    }
    time_s += 0.001;
    if (hopper.height_m() < lowest_m) lowest_m = hopper.height_m();
  }

  // Fall: t = sqrt(2 h / g), v = -sqrt(2 g h). In stance the body swings about the height at which the spring
  // carries it, m g / k below touch-down, with w = sqrt(k / m): lift-off after 2 (pi - atan(w v / g)) / w,
  // and the lowest point an amplitude sqrt((m g / k)^2 + (v / w)^2) below that height.
  const double g = p.gravity_mps2, w = std::sqrt(p.stiffness_npm / p.mass_kg),
               v = std::sqrt(2.0 * g * drop_m);
  const double pi = std::acos(-1.0), sag_m = g / (w * w);
  expect("touch-down, s", touchdown_s, std::sqrt(2.0 * drop_m / g), 1e-9);
  expect("speed at touch-down, m/s", impact_mps, -v, 1e-9);
  expect("stance, s", liftoff_s - touchdown_s, 2.0 * (pi - std::atan(w * v / g)) / w, 1e-9);
  expect("lowest height, m", lowest_m, touchdown_m - sag_m - std::hypot(sag_m, v / w), 2e-5);
  return failures == 0 ? 0 : 1;
}
