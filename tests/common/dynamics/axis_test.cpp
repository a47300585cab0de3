// The driven axes against closed forms.
#include "furcula/dynamics/axis.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using furcula::dynamics::Effect;
using furcula::dynamics::Effects;
using furcula::dynamics::MotorAxis;
using furcula::dynamics::RailCarriage;
using furcula::dynamics::RotaryJoint;

TEST_CASE("A motor axis approaches its terminal speed exponentially, whatever the step") {
  for (const double step : {1e-3, 0.0173, 0.4}) {
    MotorAxis<double> axis({.mass_kg = 95.0, .damping_nspm = 200.0});
    axis.reset(0.0, 0.0);
    double t = 0.0;
    for (; t < 1.0; t += step) axis.advance(50.0, step);
    CAPTURE(step);
    CHECK(axis.velocity() == Approx(0.25 * -std::expm1(-200.0 / 95.0 * t)).epsilon(1e-11));
  }
}

TEST_CASE("Dry friction stops a coasting axis after v^2 m / (2 Fc) and holds it there") {
  Effects<double> effects;
  effects.set(Effect::coulomb_friction, 0, 20.0);
  MotorAxis<double> axis({.mass_kg = 100.0, .damping_nspm = 0.0}, effects);
  axis.reset(0.0, 0.3);
  for (int n = 0; n < 3000; ++n) axis.advance(0.0, 1e-3);
  CHECK(axis.velocity() == 0.0);
  CHECK(axis.position() == Approx(0.3 * 0.3 * 100.0 / 40.0).epsilon(1e-9));
  axis.advance(19.9, 1e-3);
  CHECK(axis.velocity() == 0.0);
  axis.advance(-20.1, 1e-3);
  CHECK(axis.velocity() == Approx(-0.1 / 100.0 * 1e-3).epsilon(1e-9));
}

TEST_CASE("An offset holds an axis only against friction, and its sign is that of growing position") {
  Effects<double> effects;
  effects.set(Effect::force_offset, 0, 3.0);
  MotorAxis<double> axis({.mass_kg = 10.0, .damping_nspm = 0.0}, effects);
  axis.reset(0.0, 0.0);
  axis.advance(0.0, 1.0);
  CHECK(axis.position() == Approx(0.15).epsilon(1e-12));
}

TEST_CASE("A pendulum's small swings have the period 2 pi sqrt(I/G), and energy stays") {
  RotaryJoint<double> joint({.inertia_kgm2 = 0.2, .gravity_torque_nm = 3.7, .damping_nmspr = 0.0});
  joint.reset(0.01, 0.0);
  const double period = 2.0 * std::numbers::pi * std::sqrt(0.2 / 3.7);
  const int steps = 2000;
  for (int n = 0; n < steps; ++n) joint.advance(0.0, 10.0 * period / steps);
  CHECK(joint.position() == Approx(0.01).epsilon(1e-4));
}

TEST_CASE("A large swing keeps its energy to the step's third order") {
  const auto drift = [](double step) {
    RotaryJoint<double> joint({.inertia_kgm2 = 0.2, .gravity_torque_nm = 3.7, .damping_nmspr = 0.0});
    joint.reset(2.5, 0.0);
    const double start = -3.7 * std::cos(2.5);
    double worst = 0.0;
    for (double t = 0.0; t < 5.0; t += step) {
      joint.advance(0.0, step);
      worst = std::max(worst, std::abs(0.1 * joint.velocity() * joint.velocity() -
                                       3.7 * std::cos(joint.position()) - start));
    }
    return worst;
  };
  CHECK(drift(1e-3) < 1e-4);
  CHECK(drift(5e-4) < 0.3 * drift(1e-3));
}

TEST_CASE("A joint held by friction stays where gravity's torque is below it") {
  Effects<double> effects;
  effects.set(Effect::coulomb_friction, 0, 0.5);
  RotaryJoint<double> joint({.inertia_kgm2 = 0.2, .gravity_torque_nm = 3.7, .damping_nmspr = 0.0}, effects);
  joint.reset(0.13, 0.0);  // 3.7 sin(0.13) = 0.48
  for (int n = 0; n < 100; ++n) joint.advance(0.0, 2e-3);
  CHECK(joint.position() == 0.13);
  joint.reset(0.14, 0.0);  // 0.516
  joint.advance(0.0, 2e-3);
  CHECK(joint.velocity() < 0.0);
}

TEST_CASE("A carriage's fall approaches m g / d exponentially, whatever the step") {
  constexpr double kMass = 1.6, kDamping = 2.3, kGravity = 9.81;
  constexpr double kTerminal = kMass * kGravity / kDamping, kRate = kDamping / kMass;
  for (const double thrown : {0.0, 3.2})
    for (const double step : {1e-3, 0.0173, 0.4}) {
      RailCarriage<double> carriage({.mass_kg = kMass, .damping_nspm = kDamping, .gravity_mps2 = kGravity});
      carriage.reset(0.7, thrown);
      double t = 0.0;
      for (; t < 0.9; t += step) carriage.advance(0.0, step);
      CAPTURE(thrown, step);
      // v = -vt + (v0 + vt) exp(-d t / m), and its integral
      const double gone = -std::expm1(-kRate * t);
      CHECK(carriage.velocity() == Approx(-kTerminal + (thrown + kTerminal) * (1.0 - gone)).epsilon(1e-11));
      CHECK(carriage.position() ==
            Approx(0.7 - kTerminal * t + (thrown + kTerminal) * gone / kRate).epsilon(1e-11));
    }
}

TEST_CASE("A carriage thrown up against dry friction turns after v / (g + Fc/m) and falls with g - Fc/m") {
  Effects<double> effects;
  effects.set(Effect::coulomb_friction, 0, 3.0);
  RailCarriage<double> carriage({.mass_kg = 1.5, .damping_nspm = 0.0, .gravity_mps2 = 9.81}, effects);
  carriage.reset(0.0, 2.0);
  const double up = 2.0 / 11.81, top = 4.0 / (2.0 * 11.81), down = 0.5 - up;
  for (int n = 0; n < 500; ++n) carriage.advance(0.0, 1e-3);
  CHECK(carriage.velocity() == Approx(-7.81 * down).epsilon(1e-9));
  CHECK(carriage.position() == Approx(top - 0.5 * 7.81 * down * down).epsilon(1e-9));
}

TEST_CASE("On a rail tilt scales gravity, and a heavier carriage is slowed less by the same damping") {
  Effects<double> tilt, heavier;
  tilt.set(Effect::guide_tilt, 0, 0.6);
  heavier.set(Effect::mass_error, 0, 3.0);
  RailCarriage<double> tilted({.mass_kg = 1.5, .damping_nspm = 0.0, .gravity_mps2 = 9.81}, tilt);
  tilted.reset(0.0, 0.0);
  tilted.advance(0.0, 0.3);
  CHECK(tilted.velocity() == Approx(-9.81 * std::cos(0.6) * 0.3).epsilon(1e-12));
  RailCarriage<double> heavy({.mass_kg = 1.5, .damping_nspm = 2.0, .gravity_mps2 = 9.81}, heavier);
  heavy.reset(0.0, 0.0);
  heavy.advance(0.0, 0.3);
  CHECK(heavy.velocity() == Approx(3.0 * 9.81 / 2.0 * std::expm1(-2.0 / 3.0 * 0.3)).epsilon(1e-12));
}
