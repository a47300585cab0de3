// An independent hopper to measure the plant by: classic Runge-Kutta steps of microseconds on the equations
// of docs/physics.md and the laws of docs/contracts.md, written from there. Events are taken at the end of
// the step in which they happen.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "furcula/dynamics/machines.hpp"

namespace furcula::test {

/// The laws, by their parameters in the contract; zero is off.
struct ReferenceLaws {
  double binding_n = 0.0, binding_centre_m = 0.0, binding_width_m = 0.0;
  double guide_damping_nspm = 0.0, tilt_rad = 0.0, cubic_npm3 = 0.0, hysteresis = 0.0;
  double ripple_nm = 0.0, ripple_cycles = 0.0, ripple_phase_rad = 0.0;
  double ground_npm = 0.0, ground_nspm = 0.0;
  double sticking_n = 0.0;
  double stop_compression_m = 0.0, stop_npm = 0.0;
};

class ReferenceHopper {
 public:
  ReferenceHopper(const dynamics::HopperLinearParameters<double>& p, const ReferenceLaws& laws)
      : p_(p), l_(laws), touchdown_(2.0 * p.link_length_m * std::cos(p.touchdown_angle_rad)) {}

  double z = 0.0, v = 0.0, toe = 0.0;
  bool stance = false;
  int events = 0;
  double step_s = 1e-6;

  void advance(double torque, double seconds) {
    const int steps = static_cast<int>(std::lround(seconds / step_s));
    for (int i = 0; i < steps; ++i) step(torque);
  }

  /// Of the ground on the toe, N.
  double ground_force(double torque) const { return leg(z, v, toe, torque)[0]; }

 private:
  using State = std::array<double, 3>;  // height, velocity, toe

  void step(double torque) {
    up_ = v > 0.0 || (v == 0.0 && up_);
    const State s{z, v, toe};
    const auto along = [&](const State& d, double t) {
      return State{s[0] + t * d[0], s[1] + t * d[1], s[2] + t * d[2]};
    };
    const State a = rate(s, torque), b = rate(along(a, step_s / 2), torque),
                c = rate(along(b, step_s / 2), torque), d = rate(along(c, step_s), torque);
    z += step_s / 6 * (a[0] + 2 * b[0] + 2 * c[0] + d[0]);
    v += step_s / 6 * (a[1] + 2 * b[1] + 2 * c[1] + d[1]);
    toe += step_s / 6 * (a[2] + 2 * b[2] + 2 * c[2] + d[2]);
    // At a turning point the friction turns; what holds the body there for good is not asked of this
    // integrator.
    if (!stance && v < 0.0 && z <= touchdown_) {
      stance = true;
      v *= p_.restitution_touchdown;
      toe = 0.0;
      ++events;
    } else if (stance && v > 0.0) {
      const double force = ground_force(torque);
      const bool pulled_off = l_.sticking_n > 0.0 ? force <= -l_.sticking_n : force <= 0.0;
      const bool straight = l_.sticking_n == 0.0 && l_.ground_npm == 0.0 && z >= touchdown_;
      if (pulled_off || straight) {
        stance = false;
        v *= p_.restitution_liftoff;
        toe = 0.0;
        ++events;
      }
    }
  }

  /// Force of the leg on the body (the ground's on the massless toe), and the toe's speed.
  std::array<double, 2> leg(double height, double speed, double toe_height, double torque) const {
    const double reach = 2.0 * p_.link_length_m, length = height - toe_height;
    const double compression = p_.rest_height_m - length;
    const double spring =
        p_.stiffness_npm * compression + l_.cubic_npm3 * compression * compression * compression;
    const double angle = std::acos(std::min(1.0, length / reach));
    const double motor = torque + l_.ripple_nm * std::sin(l_.ripple_cycles * angle + l_.ripple_phase_rad);
    const double damping = p_.damping_stance_nspm - p_.damping_flight_nspm;
    // What the leg pushes with while its length stays.
    double push =
        spring - motor / (reach * std::sin(angle)) - (up_ ? 1.0 : -1.0) * l_.hysteresis * std::abs(spring);
    if (l_.sticking_n > 0.0) push -= 6000.0 * std::max(0.0, length - touchdown_);
    push += l_.stop_npm * std::max(0.0, touchdown_ - length - l_.stop_compression_m);
    if (l_.ground_npm == 0.0) return {push - damping * speed, 0.0};
    // A toe without mass: push - damping (v - toe') = -kg toe - dg toe'. On the leg's stop it moves with the
    // body, unless the ground pushes it in.
    double toe_speed = (damping * speed - l_.ground_npm * toe_height - push) / (damping + l_.ground_nspm);
    if (length >= touchdown_ && speed > toe_speed) toe_speed = speed;
    return {-l_.ground_npm * toe_height - l_.ground_nspm * toe_speed, toe_speed};
  }

  State rate(const State& s, double torque) const {
    double force = -p_.mass_kg * p_.gravity_mps2 * std::cos(l_.tilt_rad) -
                   (p_.damping_flight_nspm + l_.guide_damping_nspm) * s[1];
    if (std::abs(s[0] - l_.binding_centre_m) < 0.5 * l_.binding_width_m)
      force -= (up_ ? 1.0 : -1.0) * l_.binding_n;
    double toe_speed = 0.0;
    if (stance) {
      const auto [push, speed] = leg(s[0], s[1], s[2], torque);
      // The ground does not pull, a toe that sticks up to its force.
      force += std::max(-l_.sticking_n, push);
      toe_speed = speed;
    }
    return {s[1], force / p_.mass_kg, toe_speed};
  }

  dynamics::HopperLinearParameters<double> p_;
  ReferenceLaws l_;
  double touchdown_;
  bool up_ = false;
};

}  // namespace furcula::test
