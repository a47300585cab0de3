// The controller's step.
#include "furcula/control/controller.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace furcula;
using namespace furcula::control;

namespace {

constexpr float kDt = 0.001f;
constexpr float kTouchdown = 0.2819f;
constexpr std::uint32_t kHome = 0xfffffff0u;  // the counter wraps a little above the homing place

Config constant_torque() {
  Config config;
  config.torque = {ProfileShape::constant, 2.0f, 0.3f};
  return config;
}

Inputs at(double height_m, bool contact) {
  Inputs inputs;
  inputs.sample.home_count = kHome;
  inputs.sample.home_height_m = 0.28f;
  inputs.sample.height_count = kHome + static_cast<std::uint32_t>(std::lround((height_m - 0.28) / 0.00009));
  inputs.sample.leg_angle_rad =
      static_cast<float>(std::acos(std::min(height_m, static_cast<double>(kTouchdown)) / 0.3));
  inputs.sample.contact = contact ? 1 : 0;
  inputs.sample_valid = true;
  inputs.tick_interval_us = 1000;
  return inputs;
}

/// Falls at 1 m/s from 0.33 m into stance, down to 0.25 m.
Outputs fall_into_stance(const Config& config, State& state) {
  Outputs out;
  for (double z = 0.33; z > 0.25; z -= 0.001) out = step(config, state, at(z, z < 0.2819), kDt);
  return out;
}

}  // namespace

TEST_CASE(
    "in stance the controller drives the profile, and height and velocity come across the counter's wrap") {
  const Config config = constant_torque();
  State state = begin(config);
  const Outputs out = fall_into_stance(config, state);
  CHECK(out.fault == Fault::none);
  CHECK(out.phase.phase == Phase::stance);
  CHECK(out.height.height_m == Approx(0.251).margin(1.1e-3));
  CHECK(out.height.velocity_mps == Approx(-1.0).margin(0.02));
  CHECK(out.command.torque_nm == 2.0f);
  CHECK(out.command.coil_duty == 0.0f);
}

TEST_CASE("the same inputs give the same outputs: the controller has no memory but its state") {
  const Config config = constant_torque();
  State a = begin(config), b = begin(config);
  fall_into_stance(config, a);
  fall_into_stance(config, b);
  const Outputs x = step(config, a, at(0.2499, true), kDt);
  const Outputs y = step(config, b, at(0.2499, true), kDt);
  CHECK(x.command.torque_nm == y.command.torque_nm);
  CHECK(x.height.velocity_mps == y.height.velocity_mps);
}

TEST_CASE("a fault makes torque zero and the solenoid off on the same tick, past the rate limit") {
  Config config = constant_torque();
  config.limits.torque_rate_nmps = 100.0f;  // 0.1 N m a tick
  State state = begin(config);
  REQUIRE(fall_into_stance(config, state).command.torque_nm == 2.0f);
  Inputs bad = at(0.249, true);
  bad.sample.leg_angle_rad = std::numeric_limits<float>::quiet_NaN();
  const Outputs out = step(config, state, bad, kDt);
  CHECK(out.fault == Fault::non_finite_input);
  CHECK(out.command.torque_nm == 0.0f);
  CHECK(out.command.coil_duty == 0.0f);
  // It stays so on sound inputs, until a reset; then the torque comes back at its limited rate.
  CHECK(step(config, state, at(0.248, true), kDt).command.torque_nm == 0.0f);
  Inputs reset = at(0.247, true);
  reset.reset = true;
  const Outputs back = step(config, state, reset, kDt);
  CHECK(back.fault == Fault::none);
  CHECK(back.command.torque_nm == Approx(0.1f));
}

TEST_CASE("one lost sample is bridged with the last one, the second running is a lost peer") {
  const Config config = constant_torque();
  State state = begin(config);
  fall_into_stance(config, state);
  Inputs missing;
  missing.tick_interval_us = 1000;
  const Outputs bridged = step(config, state, missing, kDt);
  CHECK(bridged.fault == Fault::none);
  CHECK(bridged.command.torque_nm == 2.0f);
  const Outputs lost = step(config, state, missing, kDt);
  CHECK(lost.fault == Fault::peer_lost);
  CHECK(lost.command.torque_nm == 0.0f);
}

TEST_CASE("a controller that never got a sample is in the safe state") {
  const Config config = constant_torque();
  State state = begin(config);
  Inputs missing;
  missing.tick_interval_us = 1000;
  CHECK(step(config, state, missing, kDt).fault == Fault::peer_lost);
}

TEST_CASE("a configuration that makes no sense is a fault that no reset clears") {
  Config config = constant_torque();
  SECTION("zero metres a count") { config.height.metres_per_count = 0.0f; }
  SECTION("a settling time of zero") { config.debounce.open_settle_s = 0.0f; }
  SECTION("no torque limit") { config.limits.torque_nm = std::numeric_limits<float>::infinity(); }
  SECTION("an amplitude that is no number") { config.torque.amplitude_nm = std::nanf(""); }
  SECTION("a period below ten ticks") { config.torque.period_s = 0.005f; }
  SECTION("a margin that is no number") { config.phase.touchdown_margin_m = std::nanf(""); }
  CHECK(check(config) == Status::invalid);
  State state = begin(config);
  Inputs inputs = at(0.25, true);
  inputs.reset = true;
  for (int i = 0; i < 10; ++i) {
    const Outputs out = step(config, state, inputs, kDt);
    CHECK(out.fault == Fault::bad_configuration);
    CHECK(out.command.torque_nm == 0.0f);
  }
}

TEST_CASE("no parameter may be no number, or have a sign that its bounds have not") {
  for (const Parameter& p : kParameters) {
    if (p.whole) continue;
    CAPTURE(p.name);
    Config config;
    REQUIRE(check(config) == Status::ok);
    p.put(config, std::numeric_limits<float>::quiet_NaN());
    CHECK(check(config) == Status::invalid);
    p.put(config, -1e-3f);
    CHECK((check(config) == Status::invalid) == (p.least >= 0.0f));
    p.put(config, 0.0f);
    if (p.least > 0.0f) CHECK(check(config) == Status::invalid);
  }
}

TEST_CASE("a state that was not begun is in the safe state") {
  const Config config = constant_torque();
  State state;
  CHECK(step(config, state, at(0.25, true), kDt).fault == Fault::bad_configuration);
}

TEST_CASE("the leg's height is 2 L cos of its angle") {
  for (float angle = 0.3f; angle < 1.5f; angle += 0.01f)
    REQUIRE(leg_height_m(0.15f, angle) == Approx(0.3 * std::cos(static_cast<double>(angle))).margin(2e-7));
}

namespace {

Config with_clutch() {
  Config config;
  config.clutch.fitted = config.clutch.release_in_flight = 1;
  config.clutch.contraction_m = 0.05f;
  return config;
}

}  // namespace

TEST_CASE(
    "a robot that hangs in the air does not release and does not move its leg, at the start and after a reset") {
  const Config config = with_clutch();
  State state = begin(config);
  for (int n = 0; n < 1000; ++n) {
    Inputs inputs = at(0.6, false);
    inputs.reset = n == 500;
    const Outputs out = step(config, state, inputs, kDt);
    REQUIRE(out.fault == Fault::none);
    REQUIRE(out.command.coil_duty == 0.0f);
    REQUIRE(out.command.torque_nm == 0.0f);
  }
}

TEST_CASE("with a leg that has no lever, and with numbers that are none, the torque stays a number") {
  LegPositionState leg;
  const LegPath path{0.01f, 0.5f, 100.0f};
  CHECK(std::isfinite(follow_path(LegPositionConfig{}, leg, path, 0.0f, 0.0f, 0.0f, 5.0f, kDt)));
  LimitsState limits;
  CHECK(limit_torque(LimitsConfig{}, limits, std::numeric_limits<float>::quiet_NaN(), kDt) == 0.0f);
  Config config = with_clutch();
  CHECK(check(config) == Status::ok);
  config.supervisor.leg_angle_min_rad = -0.05f;
  CHECK(check(config) == Status::invalid);
}

TEST_CASE("a clutch's configuration with a number that makes no sense is refused") {
  const auto refused = [](auto member, float value) {
    Config config = with_clutch();
    config.clutch.*member = value;
    return check(config) == Status::invalid;
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  CHECK(refused(&ClutchConfig::tooth_pitch_m, 0.0f));
  CHECK(refused(&ClutchConfig::tooth_play_m, 0.01f));
  CHECK(refused(&ClutchConfig::onset_m, nan));
  CHECK(refused(&ClutchConfig::creep_s, -1.0f));
  CHECK(refused(&ClutchConfig::resolution_s, 0.0f));
  CHECK(refused(&ClutchConfig::release_delay_s, 0.2f));
  CHECK(refused(&ClutchConfig::contraction_m, nan));
  // 1.5 kg bend 2,943 N/m by 5 mm.
  CHECK_FALSE(refused(&ClutchConfig::spring_npm, 2900.0f));
  CHECK(refused(&ClutchConfig::spring_npm, 3000.0f));
}
