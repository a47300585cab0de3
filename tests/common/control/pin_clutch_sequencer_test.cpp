// The pin clutch's sequencer on a swinging link, with encoders in counts.
#include "furcula/control/pin_clutch_sequencer.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <vector>

#include "furcula/dynamics/pin_clutch.hpp"

using namespace furcula::control;
using furcula::dynamics::biped_hip;
using furcula::dynamics::PinClutchJoint;
using furcula::dynamics::PinClutchParameters;

namespace {

struct Rig {
  explicit Rig(const PinClutchParameters<double>& p = biped_hip<double>()) : joint(p) {}

  PinClutchJoint<double> joint;
  PinClutchConfig config;
  PinClutchState state;
  PinMode wanted = PinMode::passive;
  float told_nm = 0.0f;
  bool servo_works = true;
  PinClutchOutput out;
  double off_at_insertion_rad = 0.0, off_at_insertion_radps = 0.0, most_contact_nm = 0.0;

  void tick() {
    constexpr std::uint32_t kZero = 0xffffff00u;  // the counters wrap
    PinClutchView view;
    view.wanted = wanted;
    view.link_zero = view.rotor_zero = kZero;
    const auto count = [](double angle, float per_count) {
      return kZero + static_cast<std::uint32_t>(static_cast<std::int32_t>(std::lround(angle / per_count)));
    };
    view.link_count = count(joint.link_rad(), config.link_rad_per_count);
    view.rotor_count = count(joint.rotor_rad(), config.rotor_rad_per_count);
    view.pin = static_cast<float>(joint.pin());
    view.torque_nm = told_nm;
    out = sequence_pin_clutch(config, state, view, 0.001f);
    const bool was_in = joint.in_rotor();
    joint.advance(out.torque_nm, servo_works ? out.pin_target : joint.pin(), 1e-3);
    if (joint.in_rotor() && !was_in) {
      off_at_insertion_rad = std::abs(joint.link_rad() - joint.rotor_rad());
      off_at_insertion_radps = std::abs(joint.link_radps() - joint.rotor_radps());
    }
    most_contact_nm = std::max(most_contact_nm, std::abs(joint.contact_nm()));
  }
  /// Ticks until a stage, at most so long. @returns the time, or a negative number.
  double until(PinStage stage, double most_s) {
    for (int n = 0; n < static_cast<int>(most_s * 1e3); ++n) {
      tick();
      if (out.stage == stage) return 1e-3 * (n + 1);
    }
    return -1.0;
  }
};

/// From where a link of the hip swings through the bottom at this speed.
double amplitude_for(double speed_radps) {
  const auto p = biped_hip<double>();
  return std::acos(1.0 - 0.5 * p.link_inertia_kgm2 * speed_radps * speed_radps / p.link_gravity_nm);
}

}  // namespace

TEST_CASE("1,000 times a pin joins a link that swings at up to 3 rad/s to its motor") {
  int joined = 0;
  double longest_s = 0.0, most_off_rad = 0.0, most_off_radps = 0.0, most_step_nm = 0.0;
  std::vector<double> times_s, steps_nm;
  for (int n = 0; n < 1000; ++n) {
    Rig rig;
    // Speeds and phases spread evenly, by two irrational shares of n.
    const double speed = 3.0 * std::fmod(0.6180339887 * n, 1.0),
                 wait_s = 1.3 * std::fmod(0.7548776662 * n, 1.0);
    rig.joint.reset(amplitude_for(speed), 0.0);
    for (int k = 0; k < static_cast<int>(1e3 * wait_s); ++k) rig.tick();
    rig.most_contact_nm = 0.0;
    rig.wanted = PinMode::active;
    const double time_s = rig.until(PinStage::active, 5.0);
    if (time_s < 0.0) continue;
    ++joined;
    for (int k = 0; k < 20; ++k) rig.tick();
    times_s.push_back(time_s);
    steps_nm.push_back(rig.most_contact_nm);
    longest_s = std::max(longest_s, time_s);
    most_off_rad = std::max(most_off_rad, rig.off_at_insertion_rad);
    most_off_radps = std::max(most_off_radps, rig.off_at_insertion_radps);
    most_step_nm = std::max(most_step_nm, rig.most_contact_nm);
  }
  std::sort(times_s.begin(), times_s.end());
  std::sort(steps_nm.begin(), steps_nm.end());
  std::printf(
      "%d of 1,000 joined, after %.0f ms (median), %.0f ms (longest); %.1f mrad and %.2f rad/s off at most when "
      "the pin went in; torque on the link %.1f N m (median), %.1f N m (largest)\n",
      joined, 1e3 * times_s[times_s.size() / 2], 1e3 * longest_s, 1e3 * most_off_rad, most_off_radps,
      steps_nm[steps_nm.size() / 2], most_step_nm);
  CHECK(joined == 1000);
  CHECK(longest_s < 1.0);
  CHECK(most_off_rad < 0.036);  // play and chamfer
  CHECK(most_off_radps < 0.5);
  CHECK(most_step_nm < 30.0);
}

TEST_CASE("a joint goes from passive to active, to its spring, and back, and carries what each mode should") {
  Rig rig;
  rig.joint.reset(0.4, 0.0);
  rig.tick();
  CHECK(rig.out.stage == PinStage::passive);
  rig.wanted = PinMode::active;
  REQUIRE(rig.until(PinStage::active, 3.0) > 0.0);
  // The motor moves the link: against its weight by a torque that holds it at an angle.
  for (int n = 0; n < 3000; ++n) {
    rig.told_nm = static_cast<float>(20.0 * std::sin(0.3) + 60.0 * (0.3 - rig.joint.link_rad()) -
                                     40.0 * rig.joint.link_radps());
    rig.tick();
  }
  CHECK(rig.joint.link_rad() == Approx(0.3).margin(0.15));  // within the gear's friction
  rig.wanted = PinMode::spring;
  REQUIRE(rig.until(PinStage::spring, 5.0) > 0.0);
  CHECK(rig.out.torque_nm == 0.0f);
  // It swings about where the spring and its weight agree, faster than as a pendulum.
  for (int n = 0; n < 8000; ++n) rig.tick();
  const auto p = biped_hip<double>();
  const double balance =
      p.spring_stiffness_nmprad * p.spring_rest_rad / (p.spring_stiffness_nmprad + p.link_gravity_nm);
  CHECK(rig.joint.link_rad() == Approx(balance).margin(0.02));
  CHECK(rig.joint.in_spring());
  rig.wanted = PinMode::passive;
  REQUIRE(rig.until(PinStage::passive, 3.0) > 0.0);
  CHECK_FALSE(rig.joint.in_spring());
  rig.wanted = PinMode::active;
  REQUIRE(rig.until(PinStage::active, 3.0) > 0.0);
  rig.wanted = PinMode::passive;
  REQUIRE(rig.until(PinStage::passive, 3.0) > 0.0);
  CHECK_FALSE(rig.joint.in_rotor());
}

TEST_CASE("what cannot be done is refused, with the motor off, and tried again when it is wanted again") {
  SECTION("a servo that does not move") {
    Rig rig;
    rig.servo_works = false;
    rig.joint.reset(0.2, 0.0);
    rig.wanted = PinMode::active;
    REQUIRE(rig.until(PinStage::refused, 5.0) > 0.0);
    for (int n = 0; n < 500; ++n) {
      rig.tick();
      REQUIRE(rig.out.torque_nm == 0.0f);
      REQUIRE(rig.out.stage == PinStage::refused);
    }
    rig.servo_works = true;
    rig.wanted = PinMode::passive;
    rig.tick();
    rig.wanted = PinMode::active;
    CHECK(rig.until(PinStage::active, 3.0) > 0.0);
  }
  SECTION("a link that swings faster than the motor follows") {
    auto p = biped_hip<double>();
    p.torque_limit_nm = 12.0;  // hardly more than the gear's friction
    Rig rig(p);
    rig.joint.reset(amplitude_for(6.0), 0.0);
    for (int n = 0; n < 400; ++n) rig.tick();  // through the bottom
    rig.wanted = PinMode::active;
    REQUIRE(rig.until(PinStage::refused, 5.0) > 0.0);
    CHECK(rig.joint.pin() == 0.0);
    CHECK(rig.out.torque_nm == 0.0f);
  }
  SECTION("a pin that its load holds") {
    auto p = biped_hip<double>();
    p.pull_nm = -1.0;  // stuck
    Rig rig(p);
    rig.joint.reset(0.1, 0.0);
    rig.wanted = PinMode::active;
    REQUIRE(rig.until(PinStage::active, 3.0) > 0.0);
    rig.wanted = PinMode::passive;
    rig.tick();
    CHECK(rig.until(PinStage::active, 4.0) > 0.0);  // stays in what it is
    for (int n = 0; n < 200; ++n) rig.tick();
    CHECK(rig.out.stage == PinStage::active);
  }
}

TEST_CASE("a time of zero in its configuration gives no torque that is not a number") {
  Rig rig;
  rig.config.fade_s = 0.0f;
  rig.wanted = PinMode::active;
  for (int n = 0; n < 1000; ++n) {
    rig.tick();
    REQUIRE(std::isfinite(rig.out.torque_nm));
  }
  CHECK(rig.out.stage == PinStage::active);
}
