// The supervisor.
#include "furcula/control/supervisor.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace furcula::control;

namespace {

constexpr float kDt = 0.001f;
constexpr float kTouchdown = 0.2819f;

/// A sound tick: in flight at `height_m` with the switch open, or in stance with the leg at the height.
Observation sound(float height_m) {
  Observation seen;
  seen.tick_interval_us = 1000;
  seen.height_m = height_m;
  seen.above_touchdown_m = height_m - kTouchdown;
  seen.leg_height_m = height_m < kTouchdown ? height_m : kTouchdown;
  seen.leg_angle_rad = std::acos(seen.leg_height_m / 0.3f);
  seen.contact_reading = height_m < kTouchdown;
  return seen;
}

struct Fixture {
  SupervisorConfig config;
  SupervisorState state;
  Fault after(const Observation& seen, int ticks = 1) {
    Fault last = Fault::none;
    for (int i = 0; i < ticks; ++i) last = supervise(config, state, seen, false, kDt);
    return last;
  }
};

}  // namespace

TEST_CASE_METHOD(Fixture, "sound flight and stance raise no fault") {
  CHECK(after(sound(0.35f), 1000) == Fault::none);
  CHECK(after(sound(0.22f), 1000) == Fault::none);
}

TEST_CASE_METHOD(Fixture, "a tick later than 1.5 ms after the last is a fault, one of 1.4 ms is not") {
  auto seen = sound(0.35f);
  seen.tick_interval_us = 1400;
  CHECK(after(seen) == Fault::none);
  seen.tick_interval_us = 1600;
  CHECK(after(seen) == Fault::late_tick);
}

TEST_CASE_METHOD(Fixture, "one missing sample is bridged, the second running is a lost peer") {
  auto seen = sound(0.35f);
  seen.missed_samples = 1;
  CHECK(after(seen) == Fault::none);
  seen.missed_samples = 2;
  CHECK(after(seen) == Fault::peer_lost);
}

TEST_CASE_METHOD(Fixture, "a sample older than 1.5 ms is stale") {
  auto seen = sound(0.35f);
  seen.sample_age_us = 1400;
  CHECK(after(seen) == Fault::none);
  seen.sample_age_us = 2000;
  CHECK(after(seen) == Fault::stale_input);
}

TEST_CASE_METHOD(Fixture, "a height or a leg angle that is not a number is a fault") {
  auto seen = sound(0.35f);
  SECTION("NaN height") { seen.height_m = std::numeric_limits<float>::quiet_NaN(); }
  SECTION("infinite height") { seen.height_m = std::numeric_limits<float>::infinity(); }
  SECTION("NaN angle") { seen.leg_angle_rad = std::numeric_limits<float>::quiet_NaN(); }
  CHECK(after(seen) == Fault::non_finite_input);
}

TEST_CASE_METHOD(Fixture, "a height off the rail and a leg angle beyond the stops are faults") {
  auto seen = sound(0.35f);
  SECTION("above") {
    seen.height_m = 1.6f;
    CHECK(after(seen) == Fault::height_out_of_range);
  }
  SECTION("below") {
    seen.height_m = 0.02f;
    CHECK(after(seen) == Fault::height_out_of_range);
  }
  SECTION("leg stretched") {
    seen.leg_angle_rad = 0.2f;
    CHECK(after(seen) == Fault::leg_angle_out_of_range);
  }
  SECTION("leg folded") {
    seen.leg_angle_rad = 1.5f;
    CHECK(after(seen) == Fault::leg_angle_out_of_range);
  }
}

TEST_CASE_METHOD(Fixture, "an encoder that stands still while the leg folds on the ground is a fault") {
  auto seen = sound(0.22f);
  seen.height_m = 0.25f;
  seen.above_touchdown_m = 0.25f - kTouchdown;
  CHECK(after(seen, 100) == Fault::none);
  seen.height_m = 0.26f;
  seen.above_touchdown_m = 0.26f - kTouchdown;
  CHECK(after(seen) == Fault::encoder_implausible);
}

TEST_CASE_METHOD(Fixture, "a switch that reports a fast toe on raised ground 10 ms early is no fault") {
  // The body floats at 0.297 m, its leg stretches by 2.4 m/s, and the ground is 2.5 cm high.
  const float ground_m = 0.025f, height_m = 0.297f;
  float leg_m = 0.22f;
  while (leg_m < height_m - ground_m) {
    auto seen = sound(height_m);
    seen.leg_height_m = leg_m;
    seen.leg_angle_rad = std::acos(leg_m / 0.3f);
    seen.contact_reading = height_m - ground_m - leg_m < 2.4f * 0.010f;
    REQUIRE(after(seen) == Fault::none);
    leg_m += 2.4f * kDt;
  }
  // It stands there, and goes on sinking.
  for (float sunk_m = 0.0f; sunk_m < 0.05f; sunk_m += 0.001f) {
    auto seen = sound(height_m - sunk_m);
    seen.leg_height_m = height_m - ground_m - sunk_m;
    seen.leg_angle_rad = std::acos(seen.leg_height_m / 0.3f);
    seen.contact_reading = true;
    REQUIRE(after(seen) == Fault::none);
  }
}

TEST_CASE_METHOD(Fixture, "an encoder below what the leg's length allows is a fault even in flight") {
  auto seen = sound(0.35f);  // the leg on its stop
  seen.height_m = 0.24f;
  seen.above_touchdown_m = 0.24f - kTouchdown;
  CHECK(after(seen) == Fault::encoder_implausible);
}

TEST_CASE_METHOD(Fixture, "a switch closed high above the ground is a fault after 20 ms") {
  auto seen = sound(0.35f);
  seen.contact_reading = true;
  CHECK(after(seen, 19) == Fault::none);
  CHECK(after(seen, 2) == Fault::contact_implausible);
}

TEST_CASE_METHOD(
    Fixture, "a switch open while the leg is compressed is a fault after 50 ms running, chatter is none") {
  auto open = sound(0.22f);
  open.contact_reading = false;
  for (int i = 0; i < 10; ++i) {
    CHECK(after(open, 45) == Fault::none);
    CHECK(after(sound(0.22f)) == Fault::none);
  }
  CHECK(after(open, 51) == Fault::contact_implausible);
}

TEST_CASE_METHOD(Fixture, "a switch open with the body low and the leg folded in the air is none") {
  auto folded = sound(0.23f);
  folded.contact_reading = false;
  folded.leg_height_m = 0.18f;
  folded.leg_angle_rad = std::acos(folded.leg_height_m / 0.3f);
  CHECK(after(folded, 200) == Fault::none);
}

TEST_CASE_METHOD(Fixture, "a cable beyond its ends, or several stances on a free spring, are faults") {
  auto seen = sound(0.35f);
  seen.cable_travel_m = 0.12f;
  CHECK(after(seen) == Fault::cable_implausible);
  state = {};
  seen.cable_travel_m = -0.004f;
  CHECK(after(seen) == Fault::cable_implausible);
  state = {};
  seen.cable_travel_m = 0.05f;
  seen.missed_catches = 4;
  CHECK(after(seen) == Fault::none);
  seen.missed_catches = 5;
  CHECK(after(seen) == Fault::clutch_not_caught);
}

TEST_CASE_METHOD(Fixture, "a fault latches until a reset, and latches again at once if it is still there") {
  auto late = sound(0.35f);
  late.tick_interval_us = 5000;
  CHECK(after(late) == Fault::late_tick);
  CHECK(after(sound(0.35f), 100) == Fault::late_tick);
  CHECK(supervise(config, state, late, true, kDt) == Fault::late_tick);
  CHECK(supervise(config, state, sound(0.35f), true, kDt) == Fault::none);
  CHECK(after(sound(0.35f), 100) == Fault::none);
}

TEST_CASE_METHOD(Fixture, "the first fault is kept, not the last") {
  auto stale = sound(0.35f);
  stale.sample_age_us = 3000;
  after(stale);
  auto late = sound(0.35f);
  late.tick_interval_us = 5000;
  CHECK(after(late) == Fault::stale_input);
}

TEST_CASE_METHOD(Fixture, "a height that moves faster than a body can fall has jumped") {
  auto seen = sound(0.35f);
  // 5.5 m/s is 5.5 mm a tick, and 2 mm for noise; twice the ticks, twice the way.
  seen.height_step_m = -0.0074f;
  CHECK(after(seen) == Fault::none);
  seen.height_step_m = 0.0129f;
  seen.step_ticks = 2;
  CHECK(after(seen) == Fault::none);
  seen.step_ticks = 1;
  CHECK(after(seen) == Fault::encoder_jump);
}

TEST_CASE_METHOD(Fixture, "a switch that changes on each tick is found within 30, one that bounces is not") {
  for (int stride = 0; stride < 20; ++stride)
    for (int tick = 0; tick < 400; ++tick) {
      auto seen = sound(kTouchdown - 0.005f);
      seen.contact_reading = tick < 5 ? tick % 2 == 0 : tick < 200;
      REQUIRE(after(seen) == Fault::none);
    }
  int ticks = 0;
  auto seen = sound(kTouchdown - 0.005f);
  for (; ticks < 100; ++ticks) {
    seen.contact_reading = ticks % 2 == 0;
    if (after(seen) != Fault::none) break;
  }
  CHECK(state.fault == Fault::contact_implausible);
  CHECK(ticks < 30);
}

TEST_CASE_METHOD(Fixture,
                 "a fault that a device reports is the fault, one that is none of the table a lost peer") {
  auto seen = sound(0.35f);
  SECTION("its own") {
    seen.reported_fault = 12;
    CHECK(after(seen) == Fault::drive_fault);
  }
  SECTION("none of the table") {
    seen.reported_fault = 4711;
    CHECK(after(seen) == Fault::peer_lost);
  }
}

TEST_CASE_METHOD(
    Fixture, "a switch that closes now and then with the toe high in the air is found after 20 ms in all") {
  // The leg is folded by 5 cm, 7 cm above the touch-down height: the toe is 12 cm above the ground.
  auto seen = sound(kTouchdown + 0.07f);
  seen.leg_height_m = kTouchdown - 0.05f;
  int closed = 0;
  Fault found = Fault::none;
  for (int tick = 0; tick < 200 && found == Fault::none; ++tick) {
    seen.contact_reading = tick % 10 < 3;
    if (seen.contact_reading) ++closed;
    found = after(seen);
  }
  CHECK(found == Fault::contact_implausible);
  // A fiftieth of the time fades: 3 ms in 10 add up to 2.86.
  CHECK(closed == Approx(21).margin(1));
}

TEST_CASE_METHOD(Fixture,
                 "a toe above ground that is 3 cm high, reported 10 ms early, is no switch in the air") {
  auto seen = sound(kTouchdown + 0.02f);
  seen.leg_height_m = kTouchdown - 0.015f;
  seen.contact_reading = true;
  CHECK(after(seen, 20) == Fault::none);
}

TEST_CASE_METHOD(Fixture, "a leg that stays straight though the motor folds it is astray after 8 ms") {
  auto seen = sound(0.35f);
  seen.leg_fold_m = 0.001f;
  seen.leg_path_m = 0.006f;
  CHECK(after(seen, 8) == Fault::none);
  CHECK(after(seen) == Fault::leg_astray);
}

TEST_CASE_METHOD(Fixture, "a leg that is 4 cm beyond its path is astray, one that lags by 3 cm is not") {
  auto seen = sound(0.35f);
  seen.leg_fold_m = 0.02f;
  seen.leg_path_m = 0.05f;
  CHECK(after(seen, 100) == Fault::none);
  seen.leg_fold_m = 0.055f;
  seen.leg_path_m = 0.01f;
  CHECK(after(seen, 9) == Fault::leg_astray);
}

TEST_CASE_METHOD(Fixture, "a leg that is pushed straight and folds faster than it could fall is astray") {
  auto seen = sound(0.25f);
  seen.pushes = true;
  SECTION("at 40 m/s^2, after three spans of 5 ms") {
    int ticks = 0;
    for (Fault found = Fault::none; found == Fault::none && ticks < 100; ++ticks) {
      seen.leg_rate_mps = -0.040f * static_cast<float>(ticks);
      found = after(seen);
    }
    CHECK(state.fault == Fault::leg_astray);
    CHECK(ticks == 16);
  }
  SECTION("a body that falls freely does not") {
    for (int tick = 0; tick < 300; ++tick) {
      seen.leg_rate_mps = -0.00981f * static_cast<float>(tick);
      REQUIRE(after(seen) == Fault::none);
    }
  }
  SECTION("nor one whose toe meets the ground again at 1.2 m/s") {
    for (int tick = 0; tick < 100; ++tick) {
      seen.leg_rate_mps = tick < 33 ? 0.0f : tick < 36 ? -0.6f : -1.2f;
      REQUIRE(after(seen) == Fault::none);
    }
  }
  SECTION("nor one that the motor pulls down as it was told") {
    seen.pushes = false;
    for (int tick = 0; tick < 100; ++tick) {
      seen.leg_rate_mps = -0.040f * static_cast<float>(tick);
      REQUIRE(after(seen) == Fault::none);
    }
  }
}

TEST_CASE_METHOD(
    Fixture,
    "a spring that gives way by a tooth while the robot rests is found, one that has its play is not") {
  auto seen = sound(0.26f);
  seen.rests = true;
  seen.tooth_pitch_m = 0.0043f;
  seen.cable_travel_m = 0.0086f;  // caught at its second tooth
  CHECK(after(seen, 200) == Fault::none);
  seen.cable_travel_m = 0.0060f;
  CHECK(after(seen, 10) == Fault::none);
  seen.cable_travel_m = 0.0102f;
  CHECK(after(seen, 10) == Fault::none);
  seen.cable_travel_m = 0.0104f;
  CHECK(after(seen) == Fault::spring_loose);
}

TEST_CASE_METHOD(Fixture, "a key that falls in within 0.1 s of a landing without a run is no loose spring") {
  auto seen = sound(0.26f);
  seen.rests = true;
  seen.tooth_pitch_m = 0.0043f;
  for (int tick = 0; tick < 100; ++tick) {
    seen.cable_travel_m = 0.0005f * static_cast<float>(tick < 60 ? tick : 60);
    REQUIRE(after(seen) == Fault::none);
  }
  CHECK(after(seen, 200) == Fault::none);
}

TEST_CASE_METHOD(Fixture, "a cable that comes home beyond its home was not at home when it was homed") {
  auto seen = sound(0.35f);
  seen.cable_travel_m = -0.002f;
  CHECK(after(seen) == Fault::none);
  seen.cable_travel_m = -0.004f;
  CHECK(after(seen) == Fault::cable_implausible);
}
