// The controller that plays a gait of a planar leg: its table against functions, its phases against heights that are
// known, its faults.
#include "furcula/control/gait_player.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace furcula;
using namespace furcula::control;

namespace {

constexpr float kTick = 1e-3f;

/// A leg that bends and stretches as a sine of the time; torques of another.
GaitConfig config() {
  GaitConfig c;
  c.thigh_length_m = 0.3f;
  c.shank_length_m = 0.3f;
  c.fall.duration_s = 0.1f;
  c.stance.duration_s = 0.3f;
  c.rise.duration_s = 0.1f;
  for (GaitPath* p : {&c.fall, &c.stance, &c.rise})
    for (std::size_t i = 0; i < p->knots.size(); ++i) {
      const double t = p->duration_s * static_cast<double>(i) / GaitPath::kIntervals;
      const double w = 6.0;
      p->knots[i].angle = {-0.5f, static_cast<float>(1.0 + 0.2 * std::sin(w * t))};
      p->knots[i].rate = {0.0f, static_cast<float>(0.2 * w * std::cos(w * t))};
      p->knots[i].torque = {2.0f, static_cast<float>(5.0 * std::cos(20.0 * t))};
    }
  return c;
}

/// A sample with the toe so high, in the pose of the gait's fall.
GaitInputs sample(const GaitConfig& c, float toe_m, bool contact) {
  GaitInputs in;
  in.sample_valid = true;
  in.tick_interval_us = 1000;
  in.sample.angle_rad = c.fall.knots[0].angle;
  in.sample.height_m = toe_m - toe_below_hip_m(c, in.sample.angle_rad);
  in.sample.contact = contact ? 1 : 0;
  return in;
}

/// Falls from the hand until the phase is `fall`; returns the height of the toe.
float drop(const GaitConfig& c, GaitState& s, float from_m) {
  float speed = 0.0f, toe = from_m;
  for (int i = 0; i < 100; ++i) {
    const GaitOutputs out = step_gait(c, s, sample(c, toe, false), kTick);
    REQUIRE(out.fault == Fault::none);
    if (out.phase.phase == GaitPhase::fall) return toe;
    speed += 9.81f * kTick;
    toe -= speed * kTick;
  }
  FAIL("it did not fall");
  return 0.0f;
}

}  // namespace

TEST_CASE("a gait's table gives the functions that it was made of") {
  const GaitConfig c = config();
  for (float t = 0.0f; t < c.stance.duration_s; t += 0.0013f) {
    const GaitKnot m = motion_at(c.stance, t);
    CHECK(m.angle.knee == Approx(1.0 + 0.2 * std::sin(6.0 * t)).margin(1e-6));
    CHECK(m.rate.knee == Approx(1.2 * std::cos(6.0 * t)).margin(1e-4));
    CHECK(torque_at(c.stance, t).knee == Approx(5.0 * std::cos(20.0 * t)).margin(0.05));
    CHECK(torque_at(c.stance, t).hip == Approx(2.0));
  }
  // After its end the angle goes on at its last rate for 50 ms, and stands.
  const GaitKnot end = motion_at(c.stance, c.stance.duration_s);
  CHECK(motion_at(c.stance, 0.32f).angle.knee == Approx(end.angle.knee + 0.02f * end.rate.knee).margin(1e-5));
  CHECK(motion_at(c.stance, 2.0f).angle.knee == Approx(end.angle.knee + 0.05f * end.rate.knee).margin(1e-5));
  CHECK(motion_at(c.stance, 2.0f).rate.knee == 0.0f);
  CHECK(torque_at(c.stance, 2.0f).knee == Approx(5.0 * std::cos(6.0)).margin(1e-4));
}

TEST_CASE("a configuration of a gait that makes no sense is refused, and gives no torque") {
  CHECK(check(config()) == Status::ok);
  CHECK(check(GaitConfig{}) == Status::invalid);
  const auto refused = [](auto change) {
    GaitConfig c = config();
    change(c);
    return check(c) == Status::invalid;
  };
  CHECK(refused([](GaitConfig& c) { c.stance.duration_s = 0.0f; }));
  CHECK(refused([](GaitConfig& c) { c.rise.knots[7].torque.hip = std::numeric_limits<float>::quiet_NaN(); }));
  CHECK(refused([](GaitConfig& c) { c.thigh_length_m = -0.3f; }));
  CHECK(refused([](GaitConfig& c) { c.stance_kd_nmsprad = -1.0f; }));
  CHECK(refused([](GaitConfig& c) { c.height_max_m = c.height_min_m; }));
  CHECK(refused([](GaitConfig& c) { c.yields_from_m = c.yields_m; }));
  const GaitConfig wrong{};
  GaitState s = begin_gait(wrong);
  const GaitOutputs out = step_gait(wrong, s, sample(config(), 0.1f, false), kTick);
  CHECK(out.fault == Fault::bad_configuration);
  CHECK(out.torque_nm.hip == 0.0f);
  GaitState none;  // not made by begin_gait()
  CHECK(step_gait(config(), none, sample(config(), 0.1f, false), kTick).fault == Fault::bad_configuration);
}

TEST_CASE("the leg is held in its pose until it falls, and the fall is dated back to its beginning") {
  const GaitConfig c = config();
  GaitState s = begin_gait(c);
  GaitInputs held = sample(c, 0.2f, false);
  held.sample.angle_rad.knee += 0.01f;
  held.sample.height_m = 0.2f - toe_below_hip_m(c, held.sample.angle_rad);
  for (int i = 0; i < 20; ++i) {
    const GaitOutputs out = step_gait(c, s, held, kTick);
    CHECK(out.phase.phase == GaitPhase::ready);
    CHECK(out.torque_nm.knee == Approx(-2.0f).margin(1e-3));  // 200 N m/rad
  }
  s = begin_gait(c);
  drop(c, s, 0.2f);
  // From rest: 0.1 m/s after 10 ms.
  CHECK(s.phase.since_s == Approx(0.0105).margin(0.001));
}

TEST_CASE("a switch that is late tells when the toe landed, and so does the jump of a joint's rate") {
  const GaitConfig c = config();
  for (const int late : {0, 3, 8, 12}) {
    GaitState s = begin_gait(c);
    float toe = drop(c, s, 0.08f), speed = 1.0f;
    // It comes down with 1 m/s and then stands on ground that is 4 mm high.
    int stood = 0;
    for (int i = 0; i < 200 && s.phase.phase == GaitPhase::fall; ++i) {
      toe = std::max(toe - speed * kTick, 0.004f);
      stood += toe == 0.004f ? 1 : 0;
      REQUIRE(step_gait(c, s, sample(c, toe, stood > late), kTick).fault == Fault::none);
    }
    REQUIRE(s.phase.phase == GaitPhase::stance);
    CHECK(stood == late + 2);  // two readings
    CHECK(s.phase.since_s == Approx(1e-3 * (stood - 1)).margin(1.1e-3));
    CHECK(s.phase.ground_m == Approx(0.004f).margin(1e-6));
  }
  GaitState s = begin_gait(c);
  float toe = drop(c, s, 0.08f);
  while (toe > 0.01f) {
    toe -= 1e-3f;
    step_gait(c, s, sample(c, toe, false), kTick);
  }
  REQUIRE(s.phase.phase == GaitPhase::fall);
  GaitInputs struck = sample(c, toe, false);
  struck.sample.rate_radps.knee = 3.0f;
  CHECK(step_gait(c, s, struck, kTick).phase.phase == GaitPhase::stance);
}

TEST_CASE("a toe that bounces early in stance stops its clock, one that leaves late rises") {
  const GaitConfig c = config();
  GaitState s = begin_gait(c);
  float toe = drop(c, s, 0.05f);
  while (s.phase.phase == GaitPhase::fall) {
    toe = std::max(toe - 1e-3f, 0.0f);
    step_gait(c, s, sample(c, toe, toe == 0.0f), kTick);
  }
  for (int i = 0; i < 20; ++i) step_gait(c, s, sample(c, 0.0f, true), kTick);
  const float at = s.phase.since_s;
  const GaitOutputs off = step_gait(c, s, sample(c, 0.003f, false), kTick);
  CHECK(off.phase.bounced);
  CHECK(s.phase.since_s == Approx(at).margin(1e-6));
  while (s.phase.since_s < 0.2f) step_gait(c, s, sample(c, 0.0f, true), kTick);
  CHECK(s.phase.phase == GaitPhase::stance);
  step_gait(c, s, sample(c, 0.0f, false), kTick);
  CHECK(step_gait(c, s, sample(c, 0.0f, false), kTick).phase.liftoff);
  CHECK(s.phase.phase == GaitPhase::rise);
}

TEST_CASE("a stance that does not end goes on to rise") {
  const GaitConfig c = config();
  GaitState s = begin_gait(c);
  float toe = drop(c, s, 0.05f);
  int ticks = 0;
  for (; ticks < 1000 && s.phase.phase != GaitPhase::rise; ++ticks) {
    toe = std::max(toe - 1e-3f, 0.0f);
    step_gait(c, s, sample(c, toe, toe == 0.0f), kTick);
  }
  CHECK(ticks > 300);
  CHECK(ticks < 400);
}

TEST_CASE("the faults of a leg's sensors take the torque away on their tick, and stay until a reset") {
  const GaitConfig c = config();
  // Where drop() leaves it.
  GaitState dropped = begin_gait(c);
  const float toe = drop(c, dropped, 0.2f);
  const auto found = [&](const GaitInputs& in) {
    GaitState s = begin_gait(c);
    drop(c, s, 0.2f);
    const GaitOutputs out = step_gait(c, s, in, kTick);
    if (out.fault != Fault::none) {
      CHECK(out.torque_nm.hip == 0.0f);
      CHECK(out.torque_nm.knee == 0.0f);
      CHECK(step_gait(c, s, sample(c, toe, false), kTick).fault == out.fault);
      GaitInputs reset = sample(c, toe, false);
      reset.reset = true;
      CHECK(step_gait(c, s, reset, kTick).fault == Fault::none);
    }
    return out.fault;
  };
  const GaitInputs good = sample(c, toe, false);
  CHECK(found(good) == Fault::none);
  const auto with = [&](auto change) {
    GaitInputs in = good;
    change(in);
    return found(in);
  };
  CHECK(with([](GaitInputs& in) { in.tick_interval_us = 2000; }) == Fault::late_tick);
  CHECK(with([](GaitInputs& in) { in.sample.age_us = 2000; }) == Fault::stale_input);
  CHECK(with([](GaitInputs& in) { in.sample.height_m = std::nanf(""); }) == Fault::non_finite_input);
  CHECK(with([](GaitInputs& in) { in.sample.rate_radps.hip = INFINITY; }) == Fault::non_finite_input);
  CHECK(with([](GaitInputs& in) { in.sample.height_m += 0.05f; }) == Fault::encoder_jump);
  CHECK(with([](GaitInputs& in) { in.sample.angle_rad.knee += 0.5f; }) == Fault::encoder_jump);
  CHECK(with([](GaitInputs& in) { in.sample.reported_fault = 13; }) == Fault::drive_silent);
  CHECK(with([](GaitInputs& in) { in.sample.reported_fault = 4000; }) == Fault::drive_fault);
  // One lost sample is bridged, two are not.
  GaitState s = begin_gait(c);
  drop(c, s, 0.2f);
  GaitInputs lost = good;
  lost.sample_valid = false;
  CHECK(step_gait(c, s, lost, kTick).fault == Fault::none);
  CHECK(step_gait(c, s, lost, kTick).fault == Fault::peer_lost);
}

TEST_CASE("a sample that is no number is not bridged, although its tick had another fault") {
  const GaitConfig c = config();
  GaitState s = begin_gait(c);
  float toe = drop(c, s, 0.1f);
  GaitInputs late = sample(c, toe, false);
  late.sample.rate_radps.knee = std::numeric_limits<float>::quiet_NaN();
  late.tick_interval_us = c.tick_interval_max_us + 1;
  CHECK(step_gait(c, s, late, kTick).fault == Fault::late_tick);
  GaitInputs missed;
  missed.tick_interval_us = 1000;
  missed.reset = true;
  for (int i = 0; i < 3; ++i) {
    const GaitOutputs out = step_gait(c, s, missed, kTick);
    CHECK(std::isfinite(out.torque_nm.hip));
    CHECK(std::isfinite(out.torque_nm.knee));
    CHECK(std::isfinite(out.toe_m));
    missed.reset = false;
  }
}

TEST_CASE("a switch that contradicts the toe's height, and a leg that does not follow, are found in time") {
  const GaitConfig c = config();
  GaitState s = begin_gait(c);
  float toe = drop(c, s, 0.3f);
  int ticks = 0;
  while (ticks < 100 && step_gait(c, s, sample(c, toe, true), kTick).fault == Fault::none) ++ticks;
  CHECK(s.fault == Fault::contact_implausible);
  CHECK(ticks >= 20);
  CHECK(ticks <= 23);

  s = begin_gait(c);
  toe = drop(c, s, 0.05f);
  ticks = 0;
  for (; ticks < 300 && s.fault == Fault::none; ++ticks) {
    toe = std::max(toe - 1e-3f, 0.0f);
    step_gait(c, s, sample(c, toe, false), kTick);
  }
  CHECK(s.fault == Fault::contact_implausible);
  CHECK(ticks < 130);

  s = begin_gait(c);
  toe = drop(c, s, 0.3f);
  GaitInputs astray = sample(c, toe, false);
  for (ticks = 0; ticks < 200 && s.fault == Fault::none; ++ticks) {
    // It folds away, no faster than a leg can.
    astray.sample.angle_rad.knee = std::min(astray.sample.angle_rad.knee + 0.015f, 2.2f);
    astray.sample.height_m = toe - toe_below_hip_m(c, astray.sample.angle_rad);
    step_gait(c, s, astray, kTick);
  }
  CHECK(s.fault == Fault::leg_astray);
}

TEST_CASE("torques stay within their limits, and a robot that is not told to run gets none") {
  GaitConfig c = config();
  c.torque_most_nm = {3.0f, 4.0f};
  GaitState s = begin_gait(c);
  GaitInputs in = sample(c, 0.2f, false);
  in.sample.angle_rad = {0.2f, 0.4f};
  in.sample.height_m = 0.2f - toe_below_hip_m(c, in.sample.angle_rad);
  GaitOutputs out = step_gait(c, s, in, kTick);
  CHECK(out.torque_nm.hip == -3.0f);
  CHECK(out.torque_nm.knee == 4.0f);
  in.run = false;
  out = step_gait(c, s, in, kTick);
  CHECK(out.torque_nm.hip == 0.0f);
  CHECK(out.fault == Fault::none);
}
