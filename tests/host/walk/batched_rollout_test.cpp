// Rollouts: the same in any lane and on any number of threads; their energy counted a second time; how they end.
#include "host/walk/batched_rollout.hpp"

#include <catch2/catch.hpp>
#include <limits>

#include "host/walk/search.hpp"
#include "tests/host/walk/walks.hpp"

using namespace furcula;
using namespace furcula::walk;

namespace {

const dynamics::biped::Description& robot() {
  static const dynamics::biped::Description d = dynamics::biped::design();
  return d;
}
RolloutOptions in(WalkMode mode) {
  RolloutOptions o;
  o.mode = mode;
  return o;
}
bool same(const Rollout& a, const Rollout& b) {
  return a.ending == b.ending && a.time_s == b.time_s && a.torque_nm == b.torque_nm &&
         a.speed_radps == b.speed_radps && a.moment_nm == b.moment_nm && a.work_j == b.work_j &&
         a.positive_work_j == b.positive_work_j && a.copper_j == b.copper_j && a.distance_m == b.distance_m &&
         a.landings == b.landings && a.steps == b.steps;
}
template <class F>
Rollout watched(const RolloutOptions& options, const Parameters& walk, const F& watch) {
  BatchedRollout<double> rollouts(robot(), robot(), options);
  rollouts.watch = watch;
  return rollouts.run_one(walk);
}

}  // namespace

TEST_CASE("what a robot does hangs on no lane, no neighbour and no thread") {
  auto walks = test::walks_about_the_start(20);
  walks.push_back(test::found_walk().parameters);
  for (const WalkMode mode :
       {WalkMode::active, WalkMode::semi_passive, WalkMode::knee_passive, WalkMode::knee_braked}) {
    const auto together = run_walks(robot(), in(mode), walks, 1);
    const auto threads = run_walks(robot(), in(mode), walks, 3);
    std::size_t fallen = 0;
    for (std::size_t i = 0; i < walks.size(); ++i) {
      CHECK(same(together[i], threads[i]));
      CHECK(same(together[i], run_walks(robot(), in(mode), {walks[i]}, 1)[0]));
      if (together[i].ending != Ending::stands) ++fallen;
    }
    CHECK(fallen > 5);  // lanes were filled again
  }
}

TEST_CASE("energy is that of the motors, summed a second time, a passive hip's motor follows its link") {
  for (const WalkMode mode : {WalkMode::active, WalkMode::semi_passive}) {
    RolloutOptions options = in(mode);
    options.step_s = 1e-3;
    options.steps_a_tick = 1;
    options.time_s = 4.0;
    options.hips_follow = true;
    using namespace dynamics::biped;
    std::array<double, kJoints> speed{};
    double work = 0.0, positive = 0.0, squares = 0.0, followed = 0.0;
    const auto add = [&](double nm, double by) {
      work += nm * by * 1e-3;
      positive += std::max(nm * by, 0.0) * 1e-3;
      squares += nm * nm * 1e-3;
    };
    const Rollout r =
        watched(options, test::found_walk(mode == WalkMode::active ? "active" : "semi_passive").parameters,
                [&](const WalkMoment<double>& m) {
                  for (std::size_t i = 0; i < kJoints; ++i) {
                    const double link = joint<double>(m.state.q_rad, i);
                    if (mode == WalkMode::semi_passive && i % kLegJoints == kHipPitch) {
                      const auto side = i / kLegJoints;
                      const double q = m.state.rotors_rad[0][kHipClutch][side],
                                   qd = m.state.rotors_radps[0][kHipClutch][side];
                      add(std::clamp(3000.0 * (link - q) - 80.0 * qd, -220.0, 220.0), qd);
                      followed = std::max(followed, std::abs(link - q));
                    } else {
                      add(joint<double>(m.report.torque.motor_nm, i), speed[i]);
                    }
                    speed[i] = joint<double>(m.state.qd_radps, i);
                  }
                });
    REQUIRE(r.ending == Ending::stands);
    CHECK(r.constant_j == Approx(400.0));
    CHECK(r.work_j == Approx(work).epsilon(1e-9));
    CHECK(r.positive_work_j == Approx(positive).epsilon(1e-9));
    CHECK(r.copper_j == Approx(0.386 * squares / (160.0 * 0.0276 * 160.0 * 0.0276)).epsilon(1e-9));
    CHECK((followed > 1e-4) == (mode == WalkMode::semi_passive));
    CHECK(followed < 0.1);
  }
}

TEST_CASE("late drives act on the targets of so many ticks before, at first on the posture") {
  using namespace dynamics::biped;
  constexpr std::size_t kTicks = 12;
  RolloutOptions options = in(WalkMode::active);
  options.step_s = 1e-3;
  options.steps_a_tick = 1;
  options.time_s = 2.0;
  options.command_delay_s = 12e-3;
  std::vector<std::array<double, kJoints>> targets;
  std::array<double, kJoints> q{}, qd{};
  std::size_t compared = 0;
  watched(options, test::found_walk().parameters, [&](const WalkMoment<double>& m) {
    std::array<double, kJoints> now{};
    for (std::size_t i = 0; i < kJoints; ++i) {
      now[i] = joint<double>(m.out.target_rad, i);
      if (targets.size() > kTicks) {
        const auto& drive = robot().drives[i / kLegJoints][i % kLegJoints];
        const double law =
            drive.kp_nmprad * (targets[targets.size() - kTicks][i] - q[i]) - drive.kd_nmsprad * qd[i];
        CHECK(joint<double>(m.report.torque.motor_nm, i) ==
              Approx(std::clamp(law, -drive.limit_nm, drive.limit_nm)).margin(1e-9));
        ++compared;
      }
      q[i] = joint<double>(m.state.q_rad, i), qd[i] = joint<double>(m.state.qd_radps, i);
    }
    targets.push_back(now);
  });
  CHECK(compared > 1000);
  // In lanes each robot begins with its own posture, whoever was there before.
  auto walks = test::walks_about_the_start(20);
  const auto together = run_walks(robot(), options, walks, 1);
  for (std::size_t i = 0; i < walks.size(); ++i)
    CHECK(same(together[i], run_walks(robot(), options, {walks[i]}, 1)[0]));
}

TEST_CASE("a free knee feels its damper alone, a braked one stays, and each only in its time") {
  using namespace dynamics::biped;
  const walk::Parameters walk = test::found_walk().parameters;
  std::size_t free = 0, driven = 0;
  watched(in(WalkMode::knee_passive), walk, [&](const WalkMoment<double>& m) {
    if (m.time_s > 6.0) return;
    for (const std::size_t side : {kLeft, kRight}) {
      const double nm = joint<double>(m.report.torque.motor_nm, side * kLegJoints + kKnee);
      const double all = joint<double>(m.report.torque.joint_nm, side * kLegJoints + kKnee);
      // The step ends with a joint rate that its torque has changed already, by no more than 1 rad/s.
      const bool is_free = nm == 0.0 && std::abs(all) < 0.05 * 10.0;
      const bool swings = m.walk.on_left[0] == (side == kRight);
      const bool asked = m.walk.phase[0] == control::WalkPhase::up && swings && m.walk.since_s > 0.06;
      CHECK(is_free == asked);
      (is_free ? free : driven) += 1;
    }
  });
  CHECK(free > 500);
  CHECK(driven > 3000);

  std::array<double, 2> held{};
  std::array<bool, 2> holds{};
  double most = 0.0;
  std::size_t stances = 0;
  const RolloutOptions braked = in(WalkMode::knee_braked);
  watched(braked, walk, [&](const WalkMoment<double>& m) {
    if (m.time_s > 5.0) return;
    for (const std::size_t side : {kLeft, kRight}) {
      const bool stands = m.walk.on_left[0] == (side == kLeft);
      const bool up = m.walk.phase[0] == control::WalkPhase::up,
                 down = m.walk.phase[0] == control::WalkPhase::down;
      const bool now = stands && (down || (up && m.walk.since_s > braked.pin_s + 0.02));
      const double q = joint<double>(m.state.q_rad, side * kLegJoints + kKnee);
      if (now && !std::exchange(holds[side], true)) held[side] = q, ++stances;
      if (!now) holds[side] = false;
      if (now) most = std::max(most, std::abs(q - held[side]));
    }
  });
  CHECK(stances > 10);
  CHECK(most < 0.02);  // 220 N m over 2e4 N m/rad, and what is left of its speed
}

TEST_CASE("a robot that is told to stand stands, and gets nowhere") {
  const Rollout r = run_walk(robot(), in(WalkMode::active), test::standing_walk());
  CHECK(r.ending == Ending::stands);
  CHECK(r.time_s == Approx(10.0));
  CHECK(r.steps == 20000);
  CHECK(r.landings == 0);
  CHECK(std::abs(r.distance_m) < 0.02);
  CHECK(r.objective(10.0) > 0.99);
  CHECK(r.objective(10.0) <= 1.0);
}

TEST_CASE(
    "a fall, a joint beyond its range and a target that is no number end a run, a limit makes it worse") {
  Parameters w = test::standing_walk();
  w.lean_rad = 0.3;
  w.start_s = 1.0;
  w.up_s = 1e3;
  const Rollout fell = run_walk(robot(), in(WalkMode::active), w);
  CHECK(fell.ending == Ending::fell);
  CHECK(fell.time_s < 5.0);
  CHECK(fell.objective(10.0) == Approx(1.0 + 10.0 / fell.time_s));

  w = test::standing_walk();
  w.knee_rad = std::numeric_limits<double>::quiet_NaN();
  const Rollout none = run_walk(robot(), in(WalkMode::active), w);
  CHECK(none.ending == Ending::fell);
  CHECK(none.time_s < 0.01);

  RolloutOptions narrow = in(WalkMode::active);
  narrow.limits.range_rad = 0.45;
  CHECK(run_walk(robot(), narrow, test::standing_walk()).ending == Ending::range);  // the knee stands at 0.5

  RolloutOptions wide = in(WalkMode::active);
  wide.limits.apart_m = 0.3;
  CHECK(run_walk(robot(), wide, test::standing_walk()).ending == Ending::collision);

  RolloutOptions weak = in(WalkMode::active);
  const Parameters walk = test::found_walk().parameters;
  const Rollout whole = run_walk(robot(), weak, walk);
  REQUIRE(whole.keeps_limits());
  weak.limits.torque_nm = 0.8 * whole.torque_nm;
  const Rollout over = run_walk(robot(), weak, walk);
  CHECK(over.over == Approx(0.25));
  CHECK(over.objective(10.0) == Approx(1.0 + 0.3 * 0.25));
  CHECK_FALSE(over.keeps_limits());

  // A fall that has begun is seen before the pelvis is low: with the ankles turned it tips over its toes.
  Parameters tips = test::standing_walk();
  tips.start_s = 1.0;
  tips.up_s = 1e3;
  tips.lean_rad = 0.3;
  RolloutOptions cut = in(WalkMode::active);
  cut.time_s = fell.time_s - 0.15;
  const Rollout falling = run_walk(robot(), cut, tips);
  CHECK(falling.ending == Ending::stands);
  CHECK(falling.outside_m > 0.05);
  CHECK(falling.over >= falling.outside_m / 0.1);
  CHECK(whole.outside_m < 0.0);
  // Standing, the capture point is the centre of mass, in front of the ankles and within the soles.
  const Rollout stands = run_walk(robot(), in(WalkMode::active), test::standing_walk());
  CHECK(stands.outside_m < -0.02);
  CHECK(stands.outside_m > -0.15);
}

TEST_CASE("walks that were found stand within all limits, in float and in double") {
  for (const char* mode : {"active", "semi_passive"}) {
    const Walk walk = test::found_walk(mode);
    const RolloutOptions options = in(walk.mode);
    const Rollout plain = run_walk(robot(), options, walk.parameters),
                  lane = run_walks(robot(), options, {walk.parameters}, 1)[0];
    for (const Rollout& r : {plain, lane}) {
      CHECK(r.keeps_limits());
      CHECK(r.landings >= 8);
      CHECK(r.distance_m > 0.4);
    }
    CHECK(lane.cot == Approx(plain.cot).epsilon(0.03));
    CHECK(lane.landings == plain.landings);
  }
}
