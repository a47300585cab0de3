// The clutch's sequencer against a belt that lets go and holds after given times.
#include "furcula/control/clutch_sequencer.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

using namespace furcula::control;

namespace {

constexpr float kDt = 0.001f;

ClutchConfig config_with(float contraction_m) {
  ClutchConfig config;
  config.fitted = config.release_in_flight = 1;
  config.contraction_m = contraction_m;
  return config;
}

/// A leg that follows its path, and a belt that is free from `releases_s` after the coil went on until
/// `catches_s` after it went off. A free cable moves with the fold beyond 3 mm; a held one stays.
struct Rig {
  explicit Rig(const ClutchConfig& c) : config(c), state(begin_clutch(c)) {}

  ClutchConfig config;
  ClutchState state;
  float releases_s = 0.024f, catches_s = 0.011f;
  bool works = true;
  float fold_m = 0.0f, travel_m = 0.0f, coil_s = 0.0f;
  bool coil = false, held = true;
  std::vector<ClutchStage> stages;
  float longest_s[2] = {};  ///< that the coil was on and off

  ClutchEstimate tick(Phase phase, float since_s, float left_s, bool edge) {
    coil_s += kDt;
    if (coil && works && coil_s > releases_s) held = false;
    if (!coil && !held && coil_s > catches_s) held = true;
    if (!held) travel_m = std::max(0.0f, fold_m - 0.003f);
    ClutchView view;
    view.phase.phase = phase;
    view.phase.since_liftoff_s = since_s;
    view.phase.liftoff = edge && phase == Phase::flight;
    view.phase.touchdown = edge && phase == Phase::stance;
    view.time_left_s = left_s;
    view.leg_fold_m = fold_m;
    view.cable_count = static_cast<std::int32_t>(std::lround(travel_m / config.metres_per_count));
    const ClutchEstimate out = sequence_clutch(config, state, view, kDt);
    if (out.coil != coil) coil_s = 0.0f;
    coil = out.coil;
    fold_m = out.drives_leg ? out.path.fold_m : 0.0f;
    if (stages.empty() || stages.back() != out.stage) stages.push_back(out.stage);
    return out;
  }

  void fly(float time_s) {
    const int ticks = static_cast<int>(std::lround(time_s / kDt));
    for (int n = 0; n < ticks; ++n)
      tick(Phase::flight, static_cast<float>(n) * kDt, time_s - static_cast<float>(n) * kDt, n == 0);
  }
  void stand(bool leg_yields = true) {
    for (int n = 0; n < 200; ++n) {
      fold_m = leg_yields ? std::min(0.03f, 0.001f * static_cast<float>(n)) : 0.0f;
      tick(Phase::stance, 1.0f, 0.0f, n == 0);
    }
    fold_m = 0.0f;
  }
  void hop(float flight_s = 0.24f) {
    stages.clear();
    fly(flight_s);
    stand();
  }
};

using S = ClutchStage;

}  // namespace

TEST_CASE("a flight goes release, fold, home, catch, test, and ends caught with the coil off") {
  Rig rig(config_with(0.05f));
  rig.fly(0.24f);
  CHECK(rig.stages ==
        std::vector{S::caught, S::releasing, S::folding, S::homing, S::catching, S::testing, S::caught});
  CHECK(rig.held);
  CHECK_FALSE(rig.coil);
  CHECK(rig.travel_m == 0.0f);
  CHECK(rig.state.counts.releases == 1);
  CHECK(rig.state.counts.catches == 1);
  rig.stand();
  CHECK(rig.state.counts.missed == 0);
}

TEST_CASE("the delays are learned from the cable alone, and followed when they change") {
  Rig rig(config_with(0.05f));
  const auto learned = [&](float releases_s, float catches_s, int hops) {
    rig.releases_s = releases_s;
    rig.catches_s = catches_s;
    for (int n = 0; n < hops; ++n) rig.hop();
    CHECK(rig.state.release_delay_s > releases_s - 0.008f);  // it creeps below until the leg has to wait
    CHECK(rig.state.release_delay_s < releases_s + 0.003f);
    // The test pulls on the cable some milliseconds after it begins: so much shorter a wait holds.
    CHECK(rig.state.held_after_s < catches_s + config_with(0.0f).resolution_s + 0.001f);
    CHECK(rig.state.held_after_s > catches_s - 0.010f);
  };
  learned(0.024f, 0.011f, 30);
  learned(0.034f, 0.018f, 30);
}

TEST_CASE("a catch that comes too late is found by the pull, and waited for longer") {
  Rig rig(config_with(0.05f));
  rig.catches_s = 0.045f;
  rig.hop();
  CHECK(rig.state.counts.slipped == 1);
  CHECK(rig.state.counts.catches == 0);
  rig.hop();
  rig.hop(0.30f);
  rig.hop(0.30f);
  rig.hop(0.30f);
  CHECK(rig.state.held_after_s > 0.030f);
  CHECK(rig.state.counts.catches >= 1);
}

TEST_CASE(
    "a belt that is not let go is not pulled hard: the leg waits, goes back, and the coil rests after three") {
  Rig rig(config_with(0.05f));
  rig.works = false;
  rig.stages.clear();
  float most_m = 0.0f;
  for (int n = 0; n < 240; ++n) {
    rig.tick(Phase::flight, static_cast<float>(n) * kDt, 0.24f - static_cast<float>(n) * kDt, n == 0);
    most_m = std::max(most_m, rig.fold_m);
  }
  CHECK(most_m < 0.010f);  // 6 N of a spring of 605 N/m
  CHECK(std::count(rig.stages.begin(), rig.stages.end(), S::aborting) == 1);
  CHECK(rig.state.counts.failed_releases == 1);
  CHECK_FALSE(rig.coil);
  rig.stand();
  for (int n = 0; n < 12; ++n) rig.hop();
  CHECK(rig.state.counts.failed_releases == 4);  // three running, then one in ten flights
  CHECK(rig.state.counts.missed == 0);
  rig.works = true;
  for (int n = 0; n < 12; ++n) rig.hop();
  CHECK(rig.state.counts.releases > 0);
}

TEST_CASE(
    "touch-down in the middle of anything puts the coil off on the tick and leaves the leg to the stance") {
  for (const float at_s : {0.010f, 0.060f, 0.100f, 0.150f, 0.180f, 0.200f}) {
    Rig rig(config_with(0.05f));
    const int last = static_cast<int>(at_s / kDt);
    for (int n = 0; n < last; ++n)
      rig.tick(Phase::flight, static_cast<float>(n) * kDt, 0.24f - static_cast<float>(n) * kDt, n == 0);
    const ClutchEstimate out = rig.tick(Phase::stance, at_s, 0.0f, true);
    CHECK_FALSE(out.coil);
    CHECK_FALSE(out.drives_leg);
    CHECK(out.stage == S::caught);
  }
}

TEST_CASE(
    "a stance on a free spring is counted, and a cable caught astray is brought home in the next flight") {
  Rig rig(config_with(0.05f));
  rig.catches_s = 0.150f;  // holds in the middle of the stance, with the leg folded
  rig.hop();
  CHECK(rig.state.counts.missed == 1);
  CHECK(rig.state.missed_running == 1);
  CHECK(rig.travel_m > 0.02f);
  rig.catches_s = 0.011f;
  rig.hop();
  CHECK(rig.travel_m == 0.0f);
  CHECK(rig.state.counts.missed == 1);
  rig.hop();
  CHECK(rig.state.missed_running == 0);
}

TEST_CASE("flights that are too short, or legs off their stop, see no release") {
  Rig rig(config_with(0.05f));
  rig.hop(0.12f);
  CHECK(rig.stages == std::vector{S::caught});
  Rig folded(config_with(0.05f));
  folded.fold_m = 0.02f;
  folded.tick(Phase::flight, 0.01f, 0.24f, true);
  CHECK(folded.state.stage == S::caught);
}

TEST_CASE("a robot without a clutch folds its leg against the spring, if told so") {
  ClutchConfig config = config_with(0.05f);
  config.fitted = 0;
  Rig rig(config);
  rig.fly(0.24f);
  CHECK(rig.stages == std::vector{S::caught, S::folding, S::caught});
  CHECK_FALSE(rig.coil);
}

TEST_CASE("the time to touch-down is that of free fall") {
  // Thrown up at 1 m/s from the touch-down height; the velocity is that of 2.5 ms ago.
  HeightEstimate height{0.2819f + 1e-6f, 1.0f + 9.81f * 0.0025f};
  CHECK(time_to_touchdown_s(9.81f, height, 0.2819f, kDt) == Approx(2.0 / 9.81).epsilon(1e-3));
  CHECK(time_to_touchdown_s(9.81f, {0.27f, -1.0f}, 0.2819f, kDt) == 0.0f);
}

TEST_CASE("the motor replaces what a cable that has moved takes from the spring, and no more") {
  const ClutchConfig config;
  CHECK(lost_push_n(config, 0.25f, 0.0f) == 0.0f);
  CHECK(lost_push_n(config, 0.25f, 0.010f) == Approx(605.0f * 0.010f));
  CHECK(lost_push_n(config, 0.25f, 0.060f) == Approx(605.0f * 0.039f));  // all of it: the spring is slack
  CHECK(lost_push_n(config, 0.30f, 0.010f) == 0.0f);
}
