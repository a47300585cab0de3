// Each law of the hopper's effects against a closed form or an independent fine-step run. The plant is of
// second order in its step: where a tolerance is not rounding it is some h^2, and halving the step must
// quarter the error.
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "furcula/dynamics/hopper.hpp"
#include "tests/common/dynamics/example.hpp"
#include "tests/common/dynamics/reference_hopper.hpp"

using namespace furcula::dynamics;
using furcula::test::example_hopper;
using furcula::test::ReferenceHopper;
using furcula::test::ReferenceLaws;
using Parameters = HopperLinearParameters<double>;

namespace {

/// The rig of document 002, somewhat lossy: rest height above the touch-down height, restitutions below one.
Parameters rig() {
  auto p = example_hopper();
  p.rest_height_m = 0.289;
  p.restitution_touchdown = 0.92;
  p.restitution_liftoff = 0.97;
  return p;
}

double harmonic(int millisecond) { return 1.2 * std::sin(2.0 * std::numbers::pi * millisecond * 1e-3 / 0.3); }

/// Largest distance in height from the reference over some hops under a torque that is held over each
/// millisecond, the plant in `parts` steps a millisecond.
struct Apart {
  double height_m = 0.0, velocity_mps = 0.0;
  int events = 0;
};
Apart apart(const Parameters& p, const Effects<double>& effects, const ReferenceLaws& laws, int parts = 1,
            int milliseconds = 1000) {
  Hopper<double> plant(p, effects);
  ReferenceHopper fine(p, laws);
  plant.reset(0.34, 0.0);
  fine.z = 0.34;
  Apart out;
  int events = 0;
  for (int n = 0; n < milliseconds; ++n) {
    for (int i = 0; i < parts; ++i) {
      plant.advance(harmonic(n), 1e-3 / parts);
      events += static_cast<int>(plant.events().size());
    }
    fine.advance(harmonic(n), 1e-3);
    out.height_m = std::max(out.height_m, std::abs(plant.height_m() - fine.z));
    if (plant.in_stance() == fine.stance)
      out.velocity_mps = std::max(out.velocity_mps, std::abs(plant.velocity_mps() - fine.v));
  }
  CHECK(events == fine.events);
  out.events = events;
  return out;
}

/// Checks the distance at a millisecond, and that it falls with the step's square down to the reference's own
/// error: events up to 1 microsecond late, at 1 m/s.
void check_follows(const Effects<double>& effects, const ReferenceLaws& laws, double within_m) {
  const Apart coarse = apart(rig(), effects, laws), fine = apart(rig(), effects, laws, 4);
  INFO("apart " << coarse.height_m << " m at 1 ms, " << fine.height_m << " m at 0.25 ms");
  CHECK(coarse.events >= 5);
  CHECK(coarse.height_m < within_m);
  CHECK(fine.height_m < std::max(within_m / 10.0, 5e-6));
}

Hopper<double> dropped(const Parameters& p, const Effects<double>& effects, int milliseconds = 50) {
  Hopper<double> hopper(p, effects);
  hopper.reset(0.36, -0.5);
  for (int n = 0; n < milliseconds; ++n) hopper.advance(0.0, 1e-3);
  return hopper;
}

double balance(Parameters p, const Effects<double>& effects, double torque = 0.0) {
  p.damping_stance_nspm = 60.0;
  Hopper<double> hopper(p, effects);
  hopper.reset(0.25, 0.0);
  for (int n = 0; n < 5000; ++n) hopper.advance(torque, 1e-3);
  CHECK(hopper.in_stance());
  return hopper.height_m();
}

}  // namespace

TEST_CASE("The reference and the plant without effects keep together") { check_follows({}, {}, 1e-5); }

TEST_CASE("A binding spot takes its force times the way through it, and no more") {
  auto p = example_hopper();
  p.damping_flight_nspm = 0.0;
  const double centre = 0.3471, width = 0.0123, force = 4.0;
  Effects<double> effects;
  effects.set(Effect::binding_spot, {force, centre, width});
  const Hopper<double> hopper = dropped(p, effects);
  const double z = hopper.height_m(), v = hopper.velocity_mps();
  REQUIRE(z < centre - width / 2);
  const double energy =
      0.5 * p.mass_kg * (v * v - 0.25) + p.mass_kg * p.gravity_mps2 * (z - 0.36) + force * width;
  // The force counts for the share of the step's way that is predicted to lie within: an error of a h^2 / 2
  // of the way (5e-6 m) at each end.
  CHECK(std::abs(energy) < force * 2 * 5e-6);
}

TEST_CASE("A binding spot holds a body that stops in it, and lets go of one outside") {
  auto p = example_hopper();
  const double equilibrium = p.rest_height_m - p.mass_kg * p.gravity_mps2 / p.stiffness_npm;
  Effects<double> effects;
  effects.set(Effect::binding_spot, {3.0, equilibrium, 0.006});
  Hopper<double> hopper(p, effects);
  hopper.reset(equilibrium + 0.0029, 0.0);  // the spring pulls with 1.7 N
  hopper.advance(0.0, 1e-3);
  CHECK(hopper.velocity_mps() == 0.0);
  hopper.reset(equilibrium + 0.0031, 0.0);
  hopper.advance(0.0, 1e-3);
  CHECK(hopper.velocity_mps() < 0.0);
}

TEST_CASE("A hopper with a binding spot follows the fine run") {
  Effects<double> effects;
  effects.set(Effect::binding_spot, {2.0, 0.301, 0.011});
  check_follows(effects, {.binding_n = 2.0, .binding_centre_m = 0.301, .binding_width_m = 0.011}, 5e-6);
}

TEST_CASE("More damping in the guide shows in flight and in stance") {
  auto p = example_hopper();
  Effects<double> effects;
  effects.set(Effect::damping_error, 0, 2.5);
  // m v' = -m g - d v
  const double d = p.damping_flight_nspm + 2.5, terminal = -p.mass_kg * p.gravity_mps2 / d;
  CHECK(dropped(p, effects).velocity_mps() ==
        Approx(terminal + (-0.5 - terminal) * std::exp(-d / p.mass_kg * 0.05)).epsilon(1e-12));
  check_follows(effects, {.guide_damping_nspm = 2.5}, 1e-5);
}

TEST_CASE("On a tilted guide a body falls with the cosine of the tilt") {
  auto p = example_hopper();
  p.damping_flight_nspm = 0.0;
  Effects<double> effects;
  effects.set(Effect::guide_tilt, 0, 0.2);
  CHECK(dropped(p, effects).velocity_mps() ==
        Approx(-0.5 - p.gravity_mps2 * std::cos(0.2) * 0.05).epsilon(1e-13));
  CHECK(balance(p, effects) ==
        Approx(p.rest_height_m - p.mass_kg * p.gravity_mps2 * std::cos(0.2) / p.stiffness_npm).epsilon(1e-9));
  check_follows(effects, {.tilt_rad = 0.2}, 1e-5);
}

TEST_CASE("A true mass and a true rest height act as if the model had them") {
  Effects<double> effects;
  effects.set(Effect::mass_error, 0, 1.71);
  effects.set(Effect::rest_height_error, 0, 0.2921);
  effects.set(Effect::liftoff_loss, 0, 0.9);
  auto told = rig();
  told.mass_kg = 1.71;
  told.rest_height_m = 0.2921;
  told.restitution_liftoff = 0.9;
  Hopper<double> effect(rig(), effects), model(told);
  effect.reset(0.34, 0.0);
  model.reset(0.34, 0.0);
  for (int n = 0; n < 1000; ++n) {
    effect.advance(harmonic(n), 1e-3);
    model.advance(harmonic(n), 1e-3);
    REQUIRE(effect.height_m() == Approx(model.height_m()).epsilon(1e-14));
  }
  CHECK(balance(rig(), effects) == Approx(0.2921 - 1.71 * 9.81 / 600.0).epsilon(1e-9));
}

TEST_CASE("A loss at lift-off takes the square of its share of the height that follows") {
  auto p = example_hopper();
  p.damping_flight_nspm = p.damping_stance_nspm = 0.0;
  Effects<double> effects;
  effects.set(Effect::liftoff_loss, 0, 0.8);
  Hopper<double> hopper(p, effects);
  hopper.reset(0.34, 0.0);
  int events = 0;
  double apex = 0.0;
  for (int n = 0; n < 2000; ++n) {
    hopper.advance(0.0, 1e-3);
    events += static_cast<int>(hopper.events().size());
    if (events == 2) apex = std::max(apex, hopper.height_m());
  }
  const double td = hopper.touchdown_height_m();
  // The highest sample lies within half a step of the apex.
  CHECK(apex == Approx(td + 0.64 * (0.34 - td)).margin(9.81 / 2 * 0.25e-6));
}

TEST_CASE("A hardening spring balances the weight with its cubic law, and follows the fine run") {
  const double k3 = 4e5;
  Effects<double> effects;
  effects.set(Effect::spring_hardening, 0, k3);
  const auto p = rig();
  const double y = p.rest_height_m - balance(p, effects);
  CHECK(p.stiffness_npm * y + k3 * y * y * y == Approx(p.mass_kg * p.gravity_mps2).epsilon(1e-9));
  check_follows(effects, {.cubic_npm3 = k3}, 1e-5);
}

TEST_CASE("A hardening spring without losses keeps the energy to second order") {
  auto p = example_hopper();
  p.damping_flight_nspm = p.damping_stance_nspm = 0.0;
  Effects<double> effects;
  effects.set(Effect::spring_hardening, 0, 4e5);
  const auto drift = [&](double step) {
    Hopper<double> hopper(p, effects);
    hopper.reset(0.34, 0.0);
    double worst = 0.0;
    for (double t = 0.0; t < 1.0; t += step) {
      hopper.advance(0.0, step);
      const double z = hopper.height_m(), v = hopper.velocity_mps(), y = z - p.rest_height_m;
      const double spring = hopper.in_stance() ? 300.0 * y * y + 1e5 * y * y * y * y : 0.0;
      worst = std::max(worst,
                       std::abs(0.5 * p.mass_kg * v * v + p.mass_kg * p.gravity_mps2 * (z - 0.34) + spring));
    }
    return worst;
  };
  CHECK(drift(1e-3) < 5e-4);
  CHECK(drift(5e-4) < 0.35 * drift(1e-3));
}

TEST_CASE("A spring with hysteresis loses 2 h / (1 + h) of its energy in a stance") {
  // Compressing stores (1 + h) k y^2 / 2, of which (1 - h) k y^2 / 2 come back (no gravity).
  auto p = example_hopper();
  p.damping_flight_nspm = p.damping_stance_nspm = 0.0;
  p.gravity_mps2 = 0.0;
  const double h = 0.15;
  Effects<double> effects;
  effects.set(Effect::spring_hysteresis, 0, h);
  const auto returned = [&](double step) {
    Hopper<double> hopper(p, effects);
    hopper.reset(hopper.touchdown_height_m() + 1e-4, -0.8);
    for (double t = 0.0; t < 0.5; t += step) hopper.advance(0.0, step);
    REQUIRE_FALSE(hopper.in_stance());
    return hopper.velocity_mps() / 0.8;
  };
  const double exact = std::sqrt((1.0 - h) / (1.0 + h));
  CHECK(returned(1e-3) == Approx(exact).epsilon(3e-4));
  CHECK(returned(2.5e-4) == Approx(exact).epsilon(3e-5));
}

TEST_CASE("A driven hopper with hysteresis follows the fine run") {
  Effects<double> effects;
  effects.set(Effect::spring_hysteresis, 0, 0.08);
  check_follows(effects, {.hysteresis = 0.08}, 5e-6);
}

TEST_CASE("Ripple on a hopper's motor follows the fine run") {
  Effects<double> effects;
  effects.set(Effect::torque_ripple, {0.3, 14.0, 0.6});
  check_follows(effects, {.ripple_nm = 0.3, .ripple_cycles = 14.0, .ripple_phase_rad = 0.6}, 1e-5);
  const double z = balance(rig(), effects, 0.4);
  const double angle = std::acos(z / 0.3), motor = 0.4 + 0.3 * std::sin(14.0 * angle + 0.6);
  CHECK(600.0 * (0.289 - z) - motor / (0.3 * std::sin(angle)) == Approx(1.5 * 9.81).epsilon(1e-8));
}

TEST_CASE("On a ground that gives, leg and ground are springs in series") {
  Effects<double> effects;
  effects.set(Effect::ground_compliance, {4000.0, 30.0});
  const auto p = rig();
  const double weight = p.mass_kg * p.gravity_mps2;
  CHECK(balance(p, effects) ==
        Approx(p.rest_height_m - weight / p.stiffness_npm - weight / 4000.0).epsilon(1e-9));
  // The motor feels the leg's own angle: the leg is longer than the body is high.
  const double z = balance(p, effects, 0.8), toe = -weight / 4000.0, length = z - toe;
  const double lever = 1.0 / std::sqrt(0.09 - length * length);
  CHECK(600.0 * (0.289 - length) - 0.8 * lever == Approx(weight).epsilon(1e-8));
}

TEST_CASE(
    "Without dampers a ground that gives keeps the energy, and its stance is that of the softer spring") {
  auto p = example_hopper();
  p.damping_flight_nspm = p.damping_stance_nspm = 0.0;
  Effects<double> effects;
  effects.set(Effect::ground_compliance, {3000.0, 0.0});
  Hopper<double> hopper(p, effects);
  hopper.reset(0.32, 0.0);
  double touchdown = 0.0, liftoff = 0.0, apex = 0.0;
  for (int n = 0; n < 600; ++n) {
    hopper.advance(0.0, 1e-3);
    for (const auto& e : hopper.events())
      (e.kind == ContactEvent<double>::Kind::touchdown ? touchdown : liftoff) = n * 1e-3 + e.offset_s;
    if (liftoff > 0.0) apex = std::max(apex, hopper.height_m());
    if (liftoff > 0.0 && hopper.velocity_mps() < 0.0) break;
  }
  CHECK(apex == Approx(0.32).margin(2e-5));
  const double series = 600.0 * 3000.0 / 3600.0, omega = std::sqrt(series / p.mass_kg);
  const double speed = std::sqrt(2 * p.gravity_mps2 * (0.32 - hopper.touchdown_height_m()));
  const double sag = p.mass_kg * p.gravity_mps2 / series;
  const double duration = 2 * (std::numbers::pi - std::atan(speed / (omega * sag))) / omega;
  CHECK(liftoff - touchdown == Approx(duration).margin(1e-5));
}

TEST_CASE("A hopper on a ground that gives follows the fine run") {
  for (const auto& [stiffness, damping] : {std::pair{3000.0, 15.0}, {12000.0, 40.0}, {60000.0, 5.0}}) {
    CAPTURE(stiffness, damping);
    Effects<double> effects;
    effects.set(Effect::ground_compliance, {stiffness, damping, 0.0});
    check_follows(effects, {.ground_npm = stiffness, .ground_nspm = damping}, 5e-6);
  }
}

TEST_CASE("The stiffest ground is hard ground") {
  Effects<double> effects;
  effects.set(Effect::ground_compliance, {1e6, 100.0, 0.0});
  Hopper<double> soft(rig(), effects), hard(rig());
  soft.reset(0.34, 0.0);
  hard.reset(0.34, 0.0);
  double most = 0.0;
  for (int n = 0; n < 1000; ++n) {
    soft.advance(harmonic(n), 1e-3);
    hard.advance(harmonic(n), 1e-3);
    most = std::max(most, std::abs(soft.height_m() - hard.height_m()));
  }
  CHECK(most < 5e-4);  // some 40 N / 1e6 N/m, and the pad's damper in series with the leg's
}

TEST_CASE("A toe that sticks lets go at its pull, and what the stretched leg holds is lost") {
  auto p = example_hopper();  // the spring is relaxed on the stop
  p.damping_flight_nspm = p.damping_stance_nspm = 0.0;
  const double force = 25.0;
  Effects<double> effects;
  effects.set(Effect::toe_sticking, 0, force);
  Hopper<double> hopper(p, effects);
  hopper.reset(0.34, 0.0);
  double released = 0.0, speed = 0.0;
  for (int n = 0; n < 600 && released == 0.0; ++n) {
    hopper.advance(0.0, 1e-3);
    for (const auto& e : hopper.events())
      if (e.kind == ContactEvent<double>::Kind::liftoff) {
        released = n * 1e-3 + e.offset_s;
        speed = e.velocity_after_mps;
      }
  }
  REQUIRE(released > 0.0);
  // Spring and stop in parallel stretch until they pull with the force; what they hold then is lost.
  const double rate = p.stiffness_npm + 6000.0, stretch = force / rate;
  const double energy = p.mass_kg * p.gravity_mps2 * (0.34 - hopper.touchdown_height_m() - stretch) -
                        0.5 * rate * stretch * stretch;
  CHECK(0.5 * p.mass_kg * speed * speed == Approx(energy).epsilon(1e-9));
}

TEST_CASE(
    "A toe that sticks harder than the body pulls keeps it down, and the stop gives back what it took") {
  auto p = example_hopper();
  p.damping_flight_nspm = p.damping_stance_nspm = 0.0;
  Effects<double> effects;
  effects.set(Effect::toe_sticking, 0, 500.0);
  Hopper<double> hopper(p, effects);
  hopper.reset(0.30, 0.0);
  double drift = 0.0;
  for (int n = 0; n < 2000; ++n) {
    hopper.advance(0.0, 1e-3);
    if (!hopper.in_stance()) continue;
    const double z = hopper.height_m(), v = hopper.velocity_mps(), y = z - p.rest_height_m;
    const double rate = p.stiffness_npm + (y > 0.0 ? 6000.0 : 0.0);
    drift = std::max(drift, std::abs(0.5 * p.mass_kg * v * v + p.mass_kg * p.gravity_mps2 * (z - 0.30) +
                                     0.5 * rate * y * y));
  }
  CHECK(hopper.in_stance());
  CHECK(drift < 1e-9);
}

TEST_CASE("A hopper whose toe sticks follows the fine run") {
  Effects<double> effects;
  effects.set(Effect::toe_sticking, 0, 12.0);
  check_follows(effects, {.sticking_n = 12.0}, 5e-6);
}

TEST_CASE("A bump stop adds its spring beyond its compression, and keeps the energy") {
  auto p = example_hopper();
  p.damping_flight_nspm = p.damping_stance_nspm = 0.0;
  const double compression = 0.04, rate = 3000.0, drop = 0.36;
  Effects<double> effects;
  effects.set(Effect::bump_stop, {compression, rate});
  Hopper<double> hopper(p, effects);
  hopper.reset(drop, 0.0);
  const double top = hopper.touchdown_height_m();  // where the spring is relaxed
  double drift = 0.0, deepest = 0.0;
  for (int n = 0; n < 3000; ++n) {
    hopper.advance(0.0, 1e-3);
    const double z = hopper.height_m(), v = hopper.velocity_mps();
    const double folded = hopper.in_stance() ? top - z : 0.0, into = std::max(0.0, folded - compression);
    deepest = std::max(deepest, into);
    drift = std::max(drift, std::abs(0.5 * p.mass_kg * v * v + p.mass_kg * p.gravity_mps2 * (z - drop) +
                                     0.5 * p.stiffness_npm * folded * folded + 0.5 * rate * into * into));
  }
  CHECK(deepest > 0.005);
  CHECK(drift < 1e-9);
  // At rest, spring and stop share the weight: one so low that the weight alone folds the leg onto it.
  effects.set(Effect::bump_stop, {0.01, rate});
  const double folded = top - balance(p, effects), weight = p.mass_kg * p.gravity_mps2;
  CHECK(p.stiffness_npm * folded + rate * (folded - 0.01) == Approx(weight).epsilon(1e-9));
}

TEST_CASE("A hopper with a bump stop follows the fine run, on hard ground and on one that gives") {
  for (const auto& [compression, rate] : {std::pair{0.045, 3000.0}, {0.02, 800.0}, {0.05, 20000.0}}) {
    CAPTURE(compression, rate);
    Effects<double> effects;
    effects.set(Effect::bump_stop, {compression, rate});
    ReferenceLaws laws{.stop_compression_m = compression, .stop_npm = rate};
    check_follows(effects, laws, 1e-5);
    effects.set(Effect::spring_hysteresis, 0, laws.hysteresis = 0.08);
    check_follows(effects, laws, 1e-5);
  }
  Effects<double> effects;
  effects.set(Effect::bump_stop, {0.045, 3000.0});
  effects.set(Effect::ground_compliance, {12000.0, 40.0});
  check_follows(effects,
                {.ground_npm = 12000.0, .ground_nspm = 40.0, .stop_compression_m = 0.045, .stop_npm = 3000.0},
                1e-5);
}

TEST_CASE("A bump stop that the leg never reaches is not there, to the bit") {
  Effects<double> effects;
  effects.set(Effect::bump_stop, {0.2, 3000.0});
  Hopper<double> with(rig(), effects), without(rig());
  with.reset(0.34, 0.0);
  without.reset(0.34, 0.0);
  for (int n = 0; n < 1000; ++n) {
    with.advance(harmonic(n), 1e-3);
    without.advance(harmonic(n), 1e-3);
    REQUIRE(with.height_m() == without.height_m());
  }
}

namespace {

/// The leg with links on the ground, from M, B, G and J of docs/physics.md with the contact as a constraint:
/// q = (theta, z), Runge-Kutta at 2 microseconds. In flight a point mass with its leg on the stop.
class LinkedHopper {
 public:
  LinkedHopper(const Parameters& p, double a, double b, double e) : p_(p), a_(a), b_(b), e_(e) {}
  double z = 0.0, v = 0.0;
  bool stance = false;
  int events = 0;
  bool pulled = false;  // whether the ground would have had to pull on the way down

  void advance(double torque, double seconds) {
    const double h = 2e-6;
    for (int i = 0; i < static_cast<int>(std::lround(seconds / h)); ++i) {
      const auto s = [&](const std::array<double, 2>& d, double t) {
        return std::array{z + t * d[0], v + t * d[1]};
      };
      const auto k1 = rate({z, v}, torque), k2 = rate(s(k1, h / 2), torque), k3 = rate(s(k2, h / 2), torque),
                 k4 = rate(s(k3, h), torque);
      z += h / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0]);
      v += h / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1]);
      const double touchdown = 2 * p_.link_length_m * std::cos(p_.touchdown_angle_rad);
      if (!stance && v < 0 && z <= touchdown) {
        stance = true;
        v *= p_.restitution_touchdown;
        ++events;
      } else if (stance && v > 0 && (z >= touchdown || contact(z, v, torque)[1] <= 0)) {
        stance = false;
        v *= p_.restitution_liftoff;
        ++events;
      } else if (stance && v < 0 && contact(z, v, torque)[1] < 0) {
        pulled = true;
      }
    }
  }

  /// Height's acceleration and the ground's force on the toe.
  std::array<double, 2> contact(double height, double speed, double torque) const {
    const double L = p_.link_length_m, theta = std::acos(height / (2 * L));
    const double sine = std::sin(theta), cosine = std::cos(theta), turning = -speed / (2 * L * sine);
    const double m11 = a_ - 2 * L * b_ * std::cos(2 * theta), m12 = e_ * sine, m22 = p_.mass_kg;
    const double leg_damping = p_.damping_stance_nspm - p_.damping_flight_nspm;
    const double cos0 = p_.rest_height_m / (2 * L);
    // tau - B - G, the leg's damper over its length's rate -2 L sin(theta) theta'.
    const double r1 = torque - 2 * L * b_ * std::sin(2 * theta) * turning * turning -
                      p_.gravity_mps2 * e_ * sine + 4 * p_.stiffness_npm * L * L * (cosine - cos0) * sine -
                      leg_damping * 4 * L * L * sine * sine * turning;
    const double r2 =
        -e_ * cosine * turning * turning - p_.damping_flight_nspm * speed - p_.mass_kg * p_.gravity_mps2;
    const double det = m11 * m22 - m12 * m12;
    const auto inverse = [&](double x, double y) {
      return std::array{(m22 * x - m12 * y) / det, (m11 * y - m12 * x) / det};
    };
    const double j1 = 2 * L * sine, j1_rate = 2 * L * cosine * turning;
    const auto free = inverse(r1, r2), unit = inverse(j1, 1.0);
    const double force = -(j1 * free[0] + free[1] + j1_rate * turning) / (j1 * unit[0] + unit[1]);
    return {free[1] + unit[1] * force, force};
  }

 private:
  std::array<double, 2> rate(const std::array<double, 2>& s, double torque) const {
    if (stance) return {s[1], contact(s[0], s[1], torque)[0]};
    return {s[1], -p_.gravity_mps2 - p_.damping_flight_nspm / p_.mass_kg * s[1]};
  }
  Parameters p_;
  double a_, b_, e_;
};

}  // namespace

TEST_CASE("A leg whose links have inertia follows its Lagrangian with the contact as a constraint") {
  // Table 3.1 of document 002.
  const double a = 42e-4, b = 75e-4, e = 38e-3;
  Effects<double> effects;
  effects.set(Effect::leg_inertia, {a, b, e});
  auto p = rig();
  p.mass_kg = 1.6;
  p.rest_height_m = 0.298;  // so that the leg pushes all the way down
  for (const int parts : {1, 4}) {
    Hopper<double> plant(p, effects);
    LinkedHopper fine(p, a, b, e);
    plant.reset(0.34, 0.0);
    fine.z = 0.34;
    double most = 0.0;
    int events = 0;
    for (int n = 0; n < 1000; ++n) {
      for (int i = 0; i < parts; ++i) {
        plant.advance(harmonic(n), 1e-3 / parts);
        events += static_cast<int>(plant.events().size());
      }
      fine.advance(harmonic(n), 1e-3);
      most = std::max(most, std::abs(plant.height_m() - fine.z));
    }
    CAPTURE(parts, most);
    CHECK_FALSE(fine.pulled);
    CHECK(events == fine.events);
    CHECK(events >= 6);
    CHECK(most < (parts == 1 ? 1e-4 : 1e-5));
  }
}

TEST_CASE("The links' weight counts at rest: half of what they carry hangs on the toe's side") {
  Effects<double> effects;
  effects.set(Effect::leg_inertia, {42e-4, 75e-4, 38e-3});
  const auto p = rig();
  // From the potential m g z - g e cos(theta): the weight on the leg is (m - e / (2 L)) g.
  CHECK(balance(p, effects) ==
        Approx(p.rest_height_m - (p.mass_kg - 38e-3 / 0.3) * p.gravity_mps2 / p.stiffness_npm).epsilon(1e-9));
}

TEST_CASE("An effect with its neutral value is not there") {
  auto p = rig();
  p.rest_height_m = 2.0 * p.link_length_m * std::cos(p.touchdown_angle_rad);
  for (const EffectInfo& info : kCatalogue) {
    if (!applies(info.effect, Kind::hopper_linear)) continue;
    CAPTURE(std::string(info.name));
    Effects<double> effects;
    bool can = true;
    for (std::size_t i = 0; i < info.parameter_count; ++i) {
      const auto& parameter = info.parameter_table[i];
      double value = parameter.neutral;
      if (std::isnan(value)) {
        const auto index = parameter_index(Kind::hopper_linear, parameter.name);
        value = parameter.added_on_leg ? 0.0
                : index                ? p.*Parameters::kMembers[*index]
                                       : 0.5 * (parameter.lower + 1.0);
        if (parameter.model_parameter == kNotOfModel) can = false;
      }
      effects.set(info.effect, i, value);
    }
    if (!can) continue;
    Hopper<double> with(p, effects), without(p);
    with.reset(0.34, 0.0);
    without.reset(0.34, 0.0);
    double most = 0.0;
    for (int n = 0; n < 1000; ++n) {
      with.advance(harmonic(n), 1e-3);
      without.advance(harmonic(n), 1e-3);
      most = std::max(most, std::abs(with.height_m() - without.height_m()));
    }
    CHECK(most < 1e-12);
  }
}
