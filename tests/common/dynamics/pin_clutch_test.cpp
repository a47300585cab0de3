// The joint with a pin clutch.
#include "furcula/dynamics/pin_clutch.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using furcula::dynamics::biped_hip;
using furcula::dynamics::PinClutchJoint;

TEST_CASE("A passive link is a pendulum that feels nothing of the gear") {
  auto p = biped_hip<double>();
  p.link_damping_nmspr = 0.0;
  PinClutchJoint<double> joint(p);
  joint.reset(0.02, 0.0);
  // Small swings: 2 pi sqrt(I / m g l).
  const double period_s = 2.0 * 3.14159265358979 * std::sqrt(p.link_inertia_kgm2 / p.link_gravity_nm);
  for (int n = 0; n < 1000; ++n) joint.advance(0.0, 0.0, period_s / 1000);
  CHECK(joint.link_rad() == Approx(0.02).epsilon(1e-4));
  joint.reset(1.0, 0.0);
  const double before = joint.energy();
  for (int n = 0; n < 2000; ++n) joint.advance(0.0, 0.0, 1e-3);
  CHECK(joint.energy() == Approx(before).epsilon(1e-9));
  CHECK(joint.rotor_radps() == 0.0);
}

TEST_CASE("A link that is joined to its motor takes the motor's torque less the gear's friction") {
  auto p = biped_hip<double>();
  p.link_gravity_nm = p.link_damping_nmspr = p.gear_damping_nmspr = 0.0;
  PinClutchJoint<double> joint(p);
  for (int n = 0; n < 100; ++n) joint.advance(0.0, 1.0, 1e-3);
  CHECK(joint.pin() == 1.0);
  for (int n = 0; n < 500; ++n) joint.advance(30.0, 1.0, 1e-3);
  const double acceleration = (30.0 - p.gear_friction_nm) / (p.rotor_inertia_kgm2 + p.link_inertia_kgm2);
  CHECK(joint.link_radps() == Approx(acceleration * 0.5).epsilon(0.02));  // the play is passed first
  CHECK(joint.contact_nm() == Approx(p.link_inertia_kgm2 * acceleration).epsilon(0.01));
  // Beyond the limit there is no more.
  joint.reset(0.0, 0.0);
  PinClutchJoint<double> limited(p);
  for (int n = 0; n < 100; ++n) limited.advance(1e6, 0.0, 1e-3);
  CHECK(limited.rotor_radps() ==
        Approx(0.1 * (p.torque_limit_nm - p.gear_friction_nm) / p.rotor_inertia_kgm2).epsilon(1e-3));
}

TEST_CASE("A pin does not enter a rotator whose hole is not there, and is not pulled out under load") {
  const auto p = biped_hip<double>();
  PinClutchJoint<double> joint(p);
  joint.reset(0.5, 0.0);  // the spring's rotator stands at 0.1
  for (int n = 0; n < 20; ++n) joint.advance(0.0, -1.0, 1e-3);
  CHECK(joint.pin() >= -PinClutchJoint<double>::kEnters - 1e-9);
  CHECK_FALSE(joint.in_spring());
  joint.reset(0.0, 0.0);
  for (int n = 0; n < 100; ++n) joint.advance(0.0, 1.0, 1e-3);
  for (int n = 0; n < 50; ++n) joint.advance(150.0, 1.0, 1e-3);
  REQUIRE(std::abs(joint.contact_nm()) > p.pull_nm);
  joint.advance(150.0, 0.0, 1e-3);
  CHECK(joint.pin() == 1.0);
}

TEST_CASE("Over its chamfer a pin turns the rotators towards each other, with the servo's force at most") {
  auto p = biped_hip<double>();
  p.link_gravity_nm = 0.0;
  p.spring_rest_rad = 0.02;  // within play and chamfer of a link at 0
  PinClutchJoint<double> joint(p);
  double most = 0.0;
  for (int n = 0; n < 2000; ++n) {
    joint.advance(0.0, -1.0, 1e-3);
    most = std::max(most, std::abs(joint.contact_nm()));
  }
  CHECK(joint.pin() == -1.0);
  CHECK(std::abs(joint.link_rad() - joint.spring_rad()) <= p.play_rad + 1e-3);
  CHECK(most < 2.0 * p.wedge_nm);
}
