// How high and how fast the robot may get, against closed forms.
#include "furcula/control/envelope.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula;
using namespace furcula::control;

namespace {

constexpr float kTick = 0.001f;
constexpr float kTouchdownM = 0.2819f;

EnvelopeView flying(float height_m, float velocity_mps) {
  EnvelopeView view;
  view.height_m = height_m;
  view.velocity_mps = velocity_mps;
  view.leg_angle_rad = 0.349f;
  view.leg_m = kTouchdownM;
  view.lever_m = 0.1026f;  // 2 * 0.15 * sin(0.349)
  view.touchdown_height_m = kTouchdownM;
  return view;
}

EnvelopeView standing(float leg_angle_rad, float velocity_mps) {
  EnvelopeView view = flying(0.3f * std::cos(leg_angle_rad), velocity_mps);
  view.leg_angle_rad = leg_angle_rad;
  view.leg_m = view.height_m;
  view.lever_m = 0.3f * std::sin(leg_angle_rad);
  view.contact_reading = true;
  return view;
}

/// A hop from the ground with 1.2 m/s, as a height encoder sees it whose counts are taken for `scale` of what they
/// are; the switch is open for `open_ms`.
Fault hop(EnvelopeState& state, float scale, int open_ms = 245) {
  const EnvelopeConfig config;
  Fault found = Fault::none;
  const auto tick = [&](const EnvelopeView& view) {
    const Fault one = watch_envelope(config, state, view, kTick);
    if (found == Fault::none) found = one;
    hold_back(config, state, view, false, 0.0f);
  };
  for (int i = 0; i < 5; ++i) tick(standing(0.349f, scale * 1.2f));
  for (int i = 0; i < open_ms; ++i) {
    const float t = static_cast<float>(i) * kTick;
    tick(flying(kTouchdownM + scale * (1.2f * t - 4.905f * t * t), scale * (1.2f - 9.81f * t)));
  }
  tick(standing(0.349f, scale * (1.2f - 0.00981f * static_cast<float>(open_ms))));
  return found;
}

}  // namespace

TEST_CASE("the apex of a thrown body is its height and the square of its speed over twice gravity") {
  const EnvelopeConfig config;
  CHECK(ballistic_apex_m(config, 0.3f, 0.0f) == 0.3f);
  CHECK(ballistic_apex_m(config, 0.3f, 2.0f) == Approx(0.3 + 4.0 / 19.62));
  CHECK(ballistic_apex_m(config, 0.3f, -2.0f) == Approx(0.3 + 4.0 / 19.62));
  // 2.6 m/s is the fall from 0.3445 m above the touch-down height; a long leg's hop ends at the rail's share.
  CHECK(highest_m(config, kTouchdownM, 2.6f, 0.7f) == Approx(0.2819 + 2.6 * 2.6 / 19.62));
  CHECK(highest_m(config, 0.5f, 2.6f, 0.7f) == 0.7f);
}

TEST_CASE("the motor's work since the last apex, with nothing lost, is height still to come") {
  const EnvelopeConfig config;
  EnvelopeState state;
  CHECK(watch_envelope(config, state, flying(0.35f, 0.0f), kTick) == Fault::none);
  CHECK(predicted_apex_m(config, state, flying(0.35f, 0.0f)) == Approx(0.35));
  watch_envelope(config, state, standing(0.4f, -0.5f), kTick);
  // 4 N m over 0.2 rad are 0.8 J: 0.8 / (1.5 * 9.81) = 5.4 cm.
  for (int i = 0; i <= 50; ++i) {
    const EnvelopeView view = standing(0.4f + 0.004f * static_cast<float>(i), -0.5f);
    watch_envelope(config, state, view, kTick);
    hold_back(config, state, view, false, i < 50 ? 4.0f : 0.0f);
  }
  CHECK(state.work_j == Approx(0.8).epsilon(1e-3));
  CHECK(predicted_apex_m(config, state, standing(0.6f, -0.5f)) == Approx(0.35 + 0.8 / (1.5 * 9.81)));
}

TEST_CASE("torque that adds energy fades to nothing below the highest apex, torque that takes it out stays") {
  const EnvelopeConfig config;
  const float cap_m = kTouchdownM + 2.6f * 2.6f / 19.62f;
  EnvelopeState state;
  state.running = state.proven = true;
  state.rate_radps = -2.0f;  // the leg stretches
  const EnvelopeView view = standing(0.6f, 0.3f);
  const auto torque = [&](float reference_m, float wanted_nm) {
    state.reference_m = reference_m;
    return hold_back(config, state, view, false, wanted_nm);
  };
  CHECK(torque(cap_m - 0.06f, -5.0f) == -5.0f);
  CHECK(torque(cap_m - 0.025f, -5.0f) == Approx(-2.5).epsilon(1e-3));
  CHECK(torque(cap_m, -5.0f) == 0.0f);
  CHECK(torque(cap_m + 0.1f, -5.0f) == 0.0f);
  CHECK(torque(cap_m + 0.1f, 5.0f) == 5.0f);
}

TEST_CASE("before a flight has shown the height's scale a hop gets 2.5 J") {
  const EnvelopeConfig config;
  EnvelopeState state;
  state.running = true;
  state.rate_radps = 2.0f;
  state.reference_m = 0.3f;
  state.work_j = 2.6f;
  CHECK(hold_back(config, state, standing(0.6f, -0.3f), false, 3.0f) == 0.0f);
  state.proven = true;
  CHECK(hold_back(config, state, standing(0.6f, -0.3f), false, 3.0f) == 3.0f);
}

TEST_CASE("a body that flies faster or higher than it may is beyond the envelope after three ticks") {
  const EnvelopeConfig config;
  EnvelopeState state;
  // 2.85 m/s at the touch-down height; the same with 0.3 m to go.
  const float fast_mps = 2.86f, high_mps = std::sqrt(2.86f * 2.86f - 19.62f * 0.3f);
  for (const EnvelopeView& view : {flying(kTouchdownM, -fast_mps), flying(kTouchdownM + 0.3f, high_mps)}) {
    state = {};
    CHECK(watch_envelope(config, state, view, kTick) == Fault::none);
    CHECK(watch_envelope(config, state, view, kTick) == Fault::none);
    CHECK(watch_envelope(config, state, view, kTick) == Fault::beyond_envelope);
  }
  state = {};
  for (int i = 0; i < 10; ++i)
    CHECK(watch_envelope(config, state, flying(kTouchdownM, -2.8f), kTick) == Fault::none);
}

TEST_CASE("a flight tells whether heights are what they are taken for") {
  EnvelopeState state;
  CHECK(hop(state, 1.0f) == Fault::none);
  CHECK(state.proven);
  for (const float scale : {0.5f, 0.65f, 1.5f, 2.0f, 0.0f}) {
    CAPTURE(scale);
    state = {};
    CHECK(hop(state, scale) == Fault::parameters_implausible);
  }
  for (const float scale : {0.85f, 1.15f}) {
    CAPTURE(scale);
    state = {};
    CHECK(hop(state, scale) == Fault::none);
  }
  state = {};
  CHECK(hop(state, 0.5f, 170) == Fault::none);  // too short to tell
  CHECK_FALSE(state.proven);
}

TEST_CASE("a stance tells whether the spring is the one of the parameters") {
  // A fall from 0.36 m onto 600 N/m from 0.289 m, without losses: the leg's length at rest below.
  const float k = 600.0f, rest_m = 0.289f, apex_m = 0.36f, weight_n = 1.5f * 9.81f;
  // k/2 (rest - z)^2 = m g (apex - z), the lower root.
  const float b = rest_m - weight_n / k;
  const float lowest_m = b - std::sqrt(b * b - rest_m * rest_m + 2.0f * weight_n * apex_m / k);
  const auto land = [&](float spring_npm, float spring_rest_m) {
    const EnvelopeConfig config;
    EnvelopeState state;
    const float landing_mps = -std::sqrt(19.62f * (apex_m - kTouchdownM));
    watch_envelope(config, state, flying(0.283f, landing_mps), kTick);
    watch_envelope(config, state, standing(0.349f, landing_mps), kTick);
    EnvelopeView view = standing(std::acos(lowest_m / 0.3f), 0.06f);
    view.spring_npm = spring_npm;
    view.spring_rest_m = spring_rest_m;
    return watch_envelope(config, state, view, kTick);
  };
  CHECK(land(k, rest_m) == Fault::none);
  CHECK(land(0.6f * k, rest_m) == Fault::none);
  CHECK(land(1.7f * k, rest_m) == Fault::none);
  CHECK(land(0.4f * k, rest_m) == Fault::parameters_implausible);
  CHECK(land(2.2f * k, rest_m) == Fault::parameters_implausible);
  CHECK(land(k, rest_m + 0.06f) == Fault::parameters_implausible);
  CHECK(land(0.0f, rest_m) == Fault::none);  // not known
}

TEST_CASE("a leg longer than at touch-down is none of this robot, also of one that stands") {
  const EnvelopeConfig config;
  std::uint32_t ticks = 0;
  EnvelopeView view = standing(0.54f, 0.0f);
  CHECK(watch_leg(config, ticks, view) == Fault::none);
  view.touchdown_height_m = view.leg_m - 0.03f;
  CHECK(watch_leg(config, ticks, view) == Fault::none);
  CHECK(watch_leg(config, ticks, view) == Fault::none);
  CHECK(watch_leg(config, ticks, view) == Fault::parameters_implausible);
}

TEST_CASE("a torque that gives more in half a stance than the highest hop has does not fit") {
  const EnvelopeConfig config;
  // 1.5 kg at 2.6 m/s are 5.07 J; the leg folds from 0.349 to 1.22 rad.
  const double constant_nm = 0.5 * 1.5 * 2.6 * 2.6 / (1.22 - 0.349);
  CHECK(amplitude_max_nm(config, ProfileShape::constant) == Approx(constant_nm));
  CHECK(amplitude_max_nm(config, ProfileShape::harmonic) == Approx(constant_nm * 3.14159265 / 2.0));
  CHECK(fits(config, {ProfileShape::constant, 5.8f, 0.3f}, 20.0f));
  CHECK_FALSE(fits(config, {ProfileShape::constant, 5.9f, 0.3f}, 20.0f));
  CHECK_FALSE(fits(config, {ProfileShape::constant, -5.9f, 0.3f}, 20.0f));
  CHECK(fits(config, {ProfileShape::constant, 20.0f, 0.3f}, 5.0f));
  CHECK(fits(config, {ProfileShape::harmonic, 9.1f, 0.3f}, 20.0f));
  CHECK_FALSE(fits(config, {ProfileShape::harmonic, 9.2f, 0.3f}, 20.0f));
  CHECK(fits(config, {ProfileShape::zero, 20.0f, 0.3f}, 20.0f));
}

TEST_CASE("a leg in the air is not driven faster, and not pulled on when it is nearly folded") {
  const EnvelopeConfig config;
  EnvelopeState state;
  state.running = state.proven = true;
  state.reference_m = 0.3f;
  state.rate_radps = -17.0f;
  CHECK(hold_back(config, state, flying(0.35f, 0.0f), true, -5.0f) == 0.0f);
  CHECK(hold_back(config, state, flying(0.35f, 0.0f), true, 5.0f) == 5.0f);
  state.rate_radps = 0.0f;
  CHECK(hold_back(config, state, flying(0.35f, 0.0f), true, 30.0f) == 20.0f);
  state.open_ticks = 5;
  CHECK(hold_back(config, state, flying(0.35f, 0.0f), false, 30.0f) == 20.0f);  // it bounces
  state.open_ticks = 6;
  CHECK(hold_back(config, state, flying(0.35f, 0.0f), false, 30.0f) == 4.0f);
  state.open_ticks = 0;
  CHECK(hold_back(config, state, standing(0.6f, 0.0f), false, 30.0f) == 20.0f);
  CHECK(hold_back(config, state, standing(1.145f, 0.0f), false, 10.0f) == Approx(5.0).epsilon(1e-3));
  CHECK(hold_back(config, state, standing(1.23f, 0.0f), false, 10.0f) == 0.0f);
}

TEST_CASE("a bench whose leg, rail or toe moves is a robot") {
  EnvelopeState state;
  Sample sample;
  sample.height_count = 0xffffffc0u;  // close to where it wraps
  CHECK(watch_bench(state, sample) == Fault::none);
  sample.height_count += 199;
  CHECK(watch_bench(state, sample) == Fault::none);
  SECTION("the rail") { sample.height_count += 10; }
  SECTION("the leg") { sample.leg_angle_rad += 0.06f; }
  SECTION("the toe") { sample.contact = 1; }
  CHECK(watch_bench(state, sample) == Fault::parameters_implausible);
}
