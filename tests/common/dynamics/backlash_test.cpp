// The rotor in the backlash: closed forms, and an independent run in fine steps of rotor and leg as two
// bodies.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "furcula/dynamics/axis.hpp"
#include "furcula/dynamics/hopper.hpp"
#include "tests/common/dynamics/example.hpp"
#include "tests/common/dynamics/jet.hpp"

using namespace furcula::dynamics;
using furcula::test::example_hopper;

namespace {

constexpr double kRotor = 4e-4;  // docs/contracts.md

Effects<double> gap_of(double gap) {
  Effects<double> e;
  e.set(Effect::backlash, 0, gap);
  return e;
}

/// Rotor and leg in steps of a microsecond: the contact of the rotor with an end of the gap pushes and does
/// not pull, and what it gains on the way it gives to the leg. z = 0 is a joint; else the leg's height.
struct TwoBodies {
  double gap, angle, speed = 0.0;  // of the rotor against the leg
  int end;
  /// `free_turning`: the leg's angular acceleration without the motor. Returns the impulse on the leg, and
  /// whether the torque acts on it during the step.
  struct Acts {
    bool torque;
    double impulse;
  };
  Acts step(double torque, double free_turning, double h) {
    if (end != 0 && end * (torque / kRotor - free_turning) < 0.0) end = 0;
    if (end != 0) return {true, 0.0};
    speed += (torque / kRotor - free_turning) * h;
    angle += speed * h;
    if (std::abs(angle) < gap / 2 || angle * speed < 0.0) return {false, 0.0};
    const double impulse = kRotor * speed;
    end = angle > 0.0 ? 1 : -1;
    angle = end * gap / 2;
    speed = 0.0;
    return {false, impulse};
  }
};

}  // namespace

TEST_CASE("A torque that changes its sign finds the joint again after the rotor's free flight") {
  const double gap = 0.06, torque = -1.5, inertia = 0.02;
  RotaryJoint<double> joint({.inertia_kgm2 = inertia, .gravity_torque_nm = 0.0, .damping_nmspr = 0.0},
                            gap_of(gap));
  joint.reset(0.0, 0.0);
  CHECK(joint.motor_angle_rad() == Approx(gap / 2));
  const double crossing = std::sqrt(2 * gap * kRotor / -torque);  // 5.66 ms
  for (int n = 0; n < 5; ++n) joint.advance(torque, 1e-3);
  CHECK(joint.position() == 0.0);
  CHECK(joint.motor_angle_rad() == Approx(gap / 2 + 0.5 * torque / kRotor * 25e-6).epsilon(1e-12));
  for (int n = 5; n < 20; ++n) joint.advance(torque, 1e-3);
  CHECK(joint.motor_angle_rad() - joint.position() == Approx(-gap / 2).epsilon(1e-12));
  // All of the impulse has come to the joint; it is behind by what the rotor has moved, by the inertias.
  CHECK(joint.velocity() == Approx(torque / inertia * 20e-3).epsilon(1e-12));
  const double t = 20e-3 - crossing;
  CHECK(joint.position() == Approx(torque / inertia * (crossing * t + 0.5 * t * t)).epsilon(1e-12));
  CHECK(joint.position() == Approx(torque / inertia * 2e-4 + kRotor / inertia * gap).epsilon(1e-12));
}

TEST_CASE("The last torque before a start tells where the rotor is") {
  RotaryJoint<double> joint({.inertia_kgm2 = 0.02, .gravity_torque_nm = 0.0, .damping_nmspr = 0.0},
                            gap_of(0.06));
  joint.reset(0.0, 0.0);
  joint.press_rotor(-0.7);
  CHECK(joint.motor_angle_rad() == Approx(-0.03));
  joint.advance(-1.0, 1e-3);  // held against that end it acts at once
  CHECK(joint.velocity() == Approx(-1.0 / 0.02 * 1e-3).epsilon(1e-12));
  Hopper<double> hopper(example_hopper(), gap_of(0.06));
  hopper.reset(0.34, 0.0);
  hopper.press_rotor(-0.7);
  CHECK(hopper.leg_angle_rad() == Approx(20.0 * std::numbers::pi / 180.0 - 0.03));
}

TEST_CASE("A swinging joint with backlash follows rotor and joint in fine steps") {
  const double inertia = 0.012, gravity = 0.9, damping = 0.01;
  for (const double gap : {0.01, 0.05, 0.2}) {
    RotaryJoint<double> joint(
        {.inertia_kgm2 = inertia, .gravity_torque_nm = gravity, .damping_nmspr = damping}, gap_of(gap));
    joint.reset(0.3, 0.0);
    TwoBodies rotor{gap, gap / 2, 0.0, 1};
    double x = 0.3, v = 0.0, most = 0.0, most_motor = 0.0;
    int crossings = 0, before = 1;
    for (int n = 0; n < 1500; ++n) {
      const double torque = 0.6 * std::sin(2 * std::numbers::pi * 1.7 * n * 1e-3);
      joint.advance(torque, 1e-3);
      const double h = 1e-6;
      for (int i = 0; i < 1000; ++i) {
        // The contact is judged where a held command begins, as the drive's steps are.
        const double turning = (-gravity * std::sin(x) - damping * v) / inertia;
        TwoBodies::Acts acts{rotor.end != 0, 0.0};
        if (i == 0 || rotor.end == 0) acts = rotor.step(torque, turning, h);
        v += (turning + (acts.torque ? torque / inertia : 0.0)) * h;
        x += v * h;
        v += acts.impulse / inertia;
      }
      crossings += rotor.end != 0 && rotor.end != before ? 1 : 0;
      before = rotor.end != 0 ? rotor.end : before;
      most = std::max(most, std::abs(joint.position() - x));
      most_motor = std::max(most_motor, std::abs(joint.motor_angle_rad() - x - rotor.angle));
    }
    CAPTURE(gap, most, most_motor);
    CHECK(crossings >= 4);
    // The fine run takes arrivals up to 1 microsecond late and is of first order itself.
    CHECK(most < 2e-5);
    CHECK(most_motor < 1e-4);
  }
}

TEST_CASE("Friction that holds the joint lets the rotor cross under it and feels its blow") {
  auto effects = gap_of(0.05);
  effects.set(Effect::coulomb_friction, 0, 0.4);
  const double inertia = 0.02;
  RotaryJoint<double> joint({.inertia_kgm2 = inertia, .gravity_torque_nm = 0.0, .damping_nmspr = 0.0},
                            effects);
  joint.reset(0.1, 0.0);
  const double torque = -0.3;  // less than the friction
  const double crossing = std::sqrt(2 * 0.05 * kRotor / -torque);
  for (int n = 0; n < 60; ++n) joint.advance(torque, 1e-3);
  CHECK(crossing < 15e-3);
  CHECK(joint.velocity() == 0.0);
  CHECK(joint.motor_angle_rad() - joint.position() == Approx(-0.025).epsilon(1e-12));
  const double blow =
      torque * crossing / inertia;  // speed after it; friction less torque then stops the joint
  CHECK(joint.position() == Approx(0.1 - blow * blow * inertia / (2 * (0.4 + torque))).epsilon(1e-9));
}

TEST_CASE("A hopper with backlash follows rotor and leg in fine steps, on the motor's side as well") {
  auto p = example_hopper();
  p.rest_height_m = 0.289;
  const double gap = 0.05, td = 2 * p.link_length_m * std::cos(p.touchdown_angle_rad);
  Hopper<double> hopper(p, gap_of(gap));
  hopper.reset(0.34, 0.0);
  TwoBodies rotor{gap, gap / 2, 0.0, 1};
  double z = 0.34, v = 0.0, most = 0.0, most_angle = 0.0;
  bool stance = false;
  int crossings = 0, before = 1;
  for (int n = 0; n < 1000; ++n) {
    const double torque = hopper.in_stance() ? 1.6 * std::sin(2 * std::numbers::pi * n * 1e-3 / 0.2) : 0.0;
    hopper.advance(torque, 1e-3);
    const double h = 1e-6;
    for (int i = 0; i < 1000; ++i) {
      const double lever = 1.0 / std::sqrt(0.09 - std::min(z, td) * std::min(z, td));
      double a = -p.gravity_mps2 - p.damping_flight_nspm * v / p.mass_kg, turning = 0.0;
      const double push =
          p.stiffness_npm * (p.rest_height_m - z) - (p.damping_stance_nspm - p.damping_flight_nspm) * v;
      if (stance) {
        a += std::max(0.0, push) / p.mass_kg;
        turning = -lever * (a + z * lever * lever * v * v);
      }
      TwoBodies::Acts acts{rotor.end != 0, 0.0};
      if (i == 0 || rotor.end == 0) acts = rotor.step(torque, turning, h);
      const double motor = acts.torque ? torque : 0.0;
      // The ground does not pull.
      if (stance) a += (std::max(0.0, push - motor * lever) - std::max(0.0, push)) / p.mass_kg;
      v += a * h;
      z += v * h;
      if (stance) v -= acts.impulse * lever / p.mass_kg;
      if (!stance && v < 0 && z <= td)
        stance = true;
      else if (stance && v > 0 && (z >= td || push - motor * lever <= 0))
        stance = false;
    }
    crossings += rotor.end != 0 && rotor.end != before ? 1 : 0;
    before = rotor.end != 0 ? rotor.end : before;
    most = std::max(most, std::abs(hopper.height_m() - z));
    const double angle = stance ? std::acos(z / 0.3) : p.touchdown_angle_rad;
    if (stance == hopper.in_stance())
      most_angle = std::max(most_angle, std::abs(hopper.leg_angle_rad() - angle - rotor.angle));
  }
  CAPTURE(most, most_angle, crossings);
  CHECK(crossings >= 6);
  CHECK(most < 2e-5);
  CHECK(most_angle < 5e-4);
}

TEST_CASE("A rotor is put where the leg's encoder sees it, and at the ends where that is beyond them") {
  const auto p = example_hopper();
  Hopper<double> hopper(p, gap_of(0.05));
  for (const auto& [seen, at] : {std::pair{0.01, 0.01}, {-0.015, -0.015}, {0.024, 0.025}, {-0.3, -0.025}}) {
    hopper.reset(0.34, 0.0);
    hopper.place_rotor(p.touchdown_angle_rad + seen, 0.0);
    // In flight nothing moves it.
    for (int n = 0; n < 20; ++n) {
      CHECK(hopper.leg_angle_rad() == Approx(p.touchdown_angle_rad + at));
      hopper.advance(0.0, 1e-3);
    }
  }
  // 20 ms at 0.5 rad/s, and on until it is at the end, where it stops.
  hopper.reset(0.34, 0.0);
  hopper.place_rotor(p.touchdown_angle_rad - 0.01, 0.5);
  for (int n = 0; n < 20; ++n) hopper.advance(0.0, 1e-3);
  CHECK(hopper.leg_angle_rad() == Approx(p.touchdown_angle_rad));
  for (int n = 0; n < 55; ++n) hopper.advance(0.0, 1e-3);
  CHECK(hopper.leg_angle_rad() == Approx(p.touchdown_angle_rad + 0.025));
}

TEST_CASE("A joint with backlash has the derivatives of finite differences, and is none without a gap") {
  using Jet = ceres::Jet<double, 2>;
  const auto run = [](auto gap, auto inertia, bool motor) {
    using T = decltype(gap);
    Effects<T> effects;
    effects.set(Effect::backlash, 0, gap);
    RotaryJoint<T> joint({inertia, T(0.9), T(0.01)}, effects);
    joint.reset(T(0.3), T(0.0));
    for (int n = 0; n < 900; ++n) joint.advance(T(0.6 * std::sin(11.0 * n * 1e-3)), 1e-3);
    return motor ? joint.motor_angle_rad() : joint.position();
  };
  for (const bool motor : {false, true})
    for (const double gap : {1e-3, 0.03, 0.2}) {
      const Jet out = run(Jet(gap, 0), Jet(0.012, 1), motor);
      CHECK(out.a == run(gap, 0.012, motor));
      const double dg = 1e-6 * gap, di = 1e-8;
      CAPTURE(gap, motor);
      CHECK(out.v[0] == Approx((run(gap + dg, 0.012, motor) - run(gap - dg, 0.012, motor)) / (2 * dg))
                            .epsilon(1e-4)
                            .margin(1e-6));
      CHECK(out.v[1] ==
            Approx((run(gap, 0.012 + di, motor) - run(gap, 0.012 - di, motor)) / (2 * di)).epsilon(1e-4));
    }
  // At the neutral value it is not there.
  const Jet none = run(Jet(0.0, 0), Jet(0.012, 1), false);
  CHECK(std::abs(none.v[0]) < 1.0);
  RotaryJoint<double> tight({0.012, 0.9, 0.01});
  tight.reset(0.3, 0.0);
  for (int n = 0; n < 900; ++n) tight.advance(0.6 * std::sin(11.0 * n * 1e-3), 1e-3);
  CHECK(none.a == tight.position());
}
