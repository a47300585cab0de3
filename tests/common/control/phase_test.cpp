// The phase estimate.
#include "furcula/control/phase.hpp"

#include <catch2/catch.hpp>

using namespace furcula::control;

namespace {

constexpr float kDt = 0.001f;

struct Fixture {
  PhaseConfig config;
  PhaseState state;
  PhaseEstimate at(bool closed, float above_touchdown_m, float velocity_mps) {
    const float leg_m = config.touchdown_height_m + (above_touchdown_m < 0.0f ? above_touchdown_m : 0.0f);
    return estimate_phase(config, state, closed,
                          {config.touchdown_height_m + above_touchdown_m, velocity_mps}, leg_m, kDt);
  }
  PhaseEstimate many(int ticks, bool closed, float above_touchdown_m, float velocity_mps) {
    PhaseEstimate last;
    for (int i = 0; i < ticks; ++i) last = at(closed, above_touchdown_m, velocity_mps);
    return last;
  }
};

}  // namespace

TEST_CASE_METHOD(Fixture, "a closed contact near the touch-down height is a touch-down, once") {
  CHECK(many(50, false, 0.05f, -1.0f).phase == Phase::flight);
  const auto touchdown = at(true, 0.0f, -1.0f);
  CHECK(touchdown.phase == Phase::stance);
  CHECK(touchdown.touchdown);
  CHECK(touchdown.since_touchdown_s == 0.0f);
  const auto next = at(true, -0.001f, -1.0f);
  CHECK_FALSE(next.touchdown);
  CHECK(next.since_touchdown_s == Approx(0.001f));
}

TEST_CASE_METHOD(Fixture,
                 "a switch that reports 10 ms early at 2 m/s is believed, one far above the ground is not") {
  many(50, false, 0.2f, -1.0f);
  CHECK(at(true, 0.1f, -2.0f).phase == Phase::flight);
  CHECK(at(true, 0.02f, -2.0f).touchdown);
}

TEST_CASE_METHOD(Fixture, "the time since touch-down begins where the body passed the touch-down height") {
  many(50, false, 0.05f, -1.0f);
  // Reported when the body is 5 mm below, at 1 m/s: 5 ms late.
  CHECK(at(true, -0.005f, -1.0f).since_touchdown_s == Approx(0.005f));
  CHECK(at(true, -0.006f, -1.0f).since_touchdown_s == Approx(0.006f));
}

TEST_CASE_METHOD(Fixture, "a body that stands deep in its spring at the start touched down now") {
  CHECK(at(true, -0.05f, -0.02f).since_touchdown_s == 0.0f);
}

TEST_CASE_METHOD(Fixture, "the touch-down's bounce is no lift-off") {
  many(50, false, 0.05f, -1.0f);
  at(true, 0.0f, -1.0f);
  CHECK(many(5, false, -0.005f, -1.0f).phase == Phase::stance);
  CHECK(many(20, true, -0.03f, 0.0f).phase == Phase::stance);
}

TEST_CASE_METHOD(Fixture, "lift-off is where the switch opens") {
  many(50, false, 0.05f, -1.0f);
  many(150, true, -0.03f, 0.0f);
  const auto liftoff = at(false, -0.002f, 1.0f);
  CHECK(liftoff.liftoff);
  CHECK(liftoff.phase == Phase::flight);
  CHECK(liftoff.since_liftoff_s == 0.0f);
  CHECK(many(10, false, 0.01f, 1.0f).since_liftoff_s == Approx(0.010f));
}

TEST_CASE_METHOD(
    Fixture,
    "a body out of the leg's reach flies, whatever the switch reads, and touches down no second time on it") {
  many(50, false, 0.05f, -1.0f);
  many(150, true, -0.03f, 0.0f);
  CHECK(at(true, 0.006f, 1.0f).liftoff);
  // The switch sticks closed: up, and down again.
  CHECK(many(50, true, 0.05f, 1.0f).phase == Phase::flight);
  CHECK(many(50, true, 0.0f, -1.0f).phase == Phase::flight);
  // It comes free.
  CHECK(many(5, false, 0.05f, -1.0f).phase == Phase::flight);
  CHECK(at(true, 0.0f, -1.0f).touchdown);
}

TEST_CASE_METHOD(Fixture, "a rising body does not touch down: lift-off's bounce is ignored") {
  many(50, false, 0.05f, -1.0f);
  many(150, true, -0.03f, 0.0f);
  at(false, 0.0f, 1.0f);
  CHECK(many(3, true, 0.001f, 1.0f).phase == Phase::flight);
}

TEST_CASE_METHOD(Fixture, "the apex is the highest point of the last flight, known at touch-down") {
  many(20, false, 0.02f, 0.5f);
  CHECK(many(1, false, 0.08f, 0.0f).apex_height_m == 0.0f);
  many(20, false, 0.02f, -0.5f);
  CHECK(at(true, 0.0f, -1.0f).apex_height_m == Approx(config.touchdown_height_m + 0.08f));
  many(150, true, -0.03f, 0.0f);
  many(30, false, 0.04f, 0.0f);
  CHECK(at(true, 0.0f, -1.0f).apex_height_m == Approx(config.touchdown_height_m + 0.04f));
}

TEST_CASE_METHOD(Fixture, "in flight the time since touch-down goes on") {
  many(50, false, 0.05f, -1.0f);
  at(true, 0.0f, -1.0f);
  many(100, true, -0.03f, 0.0f);
  CHECK(many(51, false, 0.03f, 0.0f).since_touchdown_s == Approx(0.151f));
}
