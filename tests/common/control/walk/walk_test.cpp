// The state machine of a walk: when its phases end, how its targets move, what the feedback adds, and that left is right in a mirror.
#include "furcula/control/walk/walk.hpp"

#include <catch2/catch.hpp>
#include <vector>

#include "furcula/dynamics/biped/design.hpp"

using namespace furcula;
using namespace furcula::control;
using namespace furcula::dynamics::biped;

namespace {

constexpr double kTick = 1e-3;

WalkParameters<double> example() {
  std::array<double, WalkParameters<double>::kCount> values;
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = kWalkParameters[i].start;
  WalkParameters<double> w = WalkParameters<double>::of(values);
  w.gains.fill(0.0);
  w.stop_d_radpm = w.stop_v_radspm = 0.0;
  w.start_s = 0.4, w.up_s = 0.3, w.down_s = 0.25, w.up_blend_s = 0.2, w.down_blend_s = 0.25;
  w.up_stance = {-0.05, 0.02, 0.03, -0.12, 0.1};
  w.down_swing = {-0.2, 0.1, 0.05, 0.04, -0.02};
  return w;
}

/// Standing in the design's zero posture, upright.
template <class T>
WalkSample<T> upright(double left_carries, double right_carries) {
  using V = dynamics::ValueOf<T>;
  const T zero = T(V(0));
  WalkSample<T> s;
  State<T> rest;
  s.q_rad = rest.q_rad;
  s.qd_radps = rest.qd_radps;
  s.gyro_radps = {zero, zero, zero};
  s.attitude = rest.attitude;
  s.left_carries = T(static_cast<V>(left_carries));
  s.right_carries = T(static_cast<V>(right_carries));
  return s;
}

struct Tick {
  double time_s;
  WalkPhase phase;
  bool on_left;
  std::array<double, kJoints> target;
};
/// `carries(time, phase, on_left)`: whether the swing foot is on the ground.
template <class F>
std::vector<Tick> played(const WalkParameters<double>& w, double seconds, const F& carries) {
  const WalkConfig<double> config(w, Parameters<double>(design()));
  WalkState<double> s = begin_walk(config);
  WalkOutputs<double> out;
  std::vector<Tick> ticks;
  for (int i = 1; i <= std::lround(seconds / kTick); ++i) {
    const double swing = carries(kTick * i, s.phase[0], s.on_left[0]) ? 1.0 : 0.0;
    step_walk(config, upright<double>(s.on_left[0] ? 1.0 : swing, s.on_left[0] ? swing : 1.0), kTick, s, out);
    Tick t{kTick * i, s.phase[0], s.on_left[0], {}};
    for (std::size_t j = 0; j < kJoints; ++j) t.target[j] = joint<double>(out.target_rad, j);
    ticks.push_back(t);
  }
  return ticks;
}
const auto kNever = [](double, WalkPhase, bool) { return false; };

/// When phases begin.
std::vector<Tick> changes(const std::vector<Tick>& ticks) {
  std::vector<Tick> out;
  for (std::size_t i = 0; i < ticks.size(); ++i)
    if (i == 0 || ticks[i].phase != ticks[i - 1].phase || ticks[i].on_left != ticks[i - 1].on_left)
      out.push_back(ticks[i]);
  return out;
}

}  // namespace

TEST_CASE(
    "phases end after their times where no foot lands, legs take turns, and the last landing stops the walk") {
  const auto at = changes(played(example(), 7.0, kNever));
  REQUIRE(at.size() > 4);
  CHECK(at[0].phase == WalkPhase::start);
  double expected = 0.4;
  bool on_left = true;
  std::size_t i = 1;
  for (; at[i].phase != WalkPhase::stop; ++i) {
    const bool up = i % 2 == 1;
    CHECK(at[i].phase == (up ? WalkPhase::up : WalkPhase::down));
    CHECK(at[i].on_left == on_left);
    CHECK(at[i].time_s == Approx(expected).margin(2.5e-3 + 1e-3 * static_cast<double>(i)));
    expected += up ? 0.3 : 0.25;
    if (!up) on_left = !on_left;
  }
  // The first swap after 5 s.
  CHECK(at[i].time_s > 5.0);
  CHECK(at[i].time_s < 5.0 + 0.55 + 0.05);
  CHECK(i + 1 == at.size());
}

TEST_CASE("a foot that carries ends the way down, but not in its first 30 ms") {
  const auto early = changes(played(example(), 1.5, [](double, WalkPhase, bool) { return true; }));
  REQUIRE(early.size() > 3);
  CHECK(early[1].phase == WalkPhase::up);
  CHECK(early[2].phase == WalkPhase::down);
  CHECK(early[3].phase == WalkPhase::up);
  CHECK(early[3].time_s - early[2].time_s == Approx(0.031).margin(1.5e-3));
  CHECK(early[2].time_s - early[1].time_s == Approx(0.3).margin(2e-3));  // on the way up it is not asked
}

TEST_CASE("targets blend from where they are, without a jump, to what the parameters say") {
  const auto w = example();
  const auto ticks = played(w, 7.0, kNever);
  for (std::size_t i = 1; i < ticks.size(); ++i)
    for (std::size_t j = 0; j < kJoints; ++j)
      // The largest change of a target, 1.2 rad, in the shortest blend.
      CHECK(std::abs(ticks[i].target[j] - ticks[i - 1].target[j]) < 1.2 * kTick / 0.2);
  // At the end of the first way up, on the left foot: the right knee is flexed by what `up.swing` says.
  std::size_t last = 0;
  while (ticks[last].phase != WalkPhase::down) ++last;
  const auto& t = ticks[last - 1].target;
  CHECK(t[kLegJoints + kKnee] == Approx(w.knee_rad + w.up_swing.knee).margin(1e-12));
  CHECK(t[kLegJoints + kHipPitch] ==
        Approx(w.hip_rad - 0.5 * w.knee_rad + w.up_swing.hip_pitch).margin(1e-12));
  CHECK(t[kLegJoints + kHipRoll] == Approx(-w.up_swing.hip_roll).margin(1e-12));
  CHECK(t[kHipRoll] == Approx(w.up_stance.hip_roll).margin(1e-12));
  CHECK(t[kAnkleRoll] == Approx(w.up_stance.ankle_roll).margin(1e-12));
  CHECK(t[kHipYaw] == 0.0);
  // At the very end it stands in its posture.
  const auto& end = ticks.back();
  REQUIRE(end.phase == WalkPhase::stop);
  for (const std::size_t leg : {std::size_t{0}, kLegJoints}) {
    CHECK(end.target[leg + kKnee] == Approx(w.knee_rad).margin(1e-12));
    CHECK(end.target[leg + kHipPitch] == Approx(w.hip_rad - 0.5 * w.knee_rad).margin(1e-12));
    CHECK(end.target[leg + kHipRoll] == Approx(0.0).margin(1e-12));
  }
}

TEST_CASE("a step on the right foot is one on the left in a mirror") {
  const auto ticks = played(example(), 3.0, kNever);
  const auto at = changes(ticks);
  const auto index = [](double t) { return static_cast<std::size_t>(std::lround(t / kTick)) - 1; };
  // The ends of the second and of the first way up: the way there differs, the end does not.
  const auto& left = ticks[index(at[2].time_s) - 1].target;
  const auto& right = ticks[index(at[4].time_s) - 1].target;
  for (std::size_t j = 0; j < kLegJoints; ++j) {
    const double sign = j == kHipRoll || j == kAnkleRoll || j == kHipYaw ? -1.0 : 1.0;
    CHECK(right[kLegJoints + j] == Approx(sign * left[j]).margin(1e-12));
    CHECK(right[j] == Approx(sign * left[kLegJoints + j]).margin(1e-12));
  }
}

TEST_CASE("feedback is the law's, on the joints that it names, and limited") {
  auto w = example();
  const Parameters<double> body(design());
  const auto run = [&](double pitch) {
    const WalkConfig<double> config(w, body);
    WalkState<double> s = begin_walk(config);
    WalkOutputs<double> out;
    auto sample = upright<double>(1.0, 0.0);
    sample.attitude = normalised(Quaternion<double>{1.0, 0.02, pitch / 2, 0.0});
    for (int i = 0; i < 600; ++i) step_walk(config, sample, kTick, s, out);
    REQUIRE(s.phase[0] == WalkPhase::up);
    REQUIRE(s.on_left[0]);
    return out;
  };
  const WalkOutputs<double> without = run(0.05);
  const double d = without.balance.forward_m, y = -without.balance.left_m - w.side_m;
  CHECK(d > 0.02);  // leaning forward, and to the right
  CHECK(y > 0.02);
  w.gains = {0.5, 0.0, 0.7, 0.0, 0.9, 0.0, -1.1, 0.0, 0.2, 0.0, 0.3, 0.0};
  const WalkOutputs<double> with = run(0.05);
  const auto change = [&](std::size_t j) {
    return joint<double>(with.target_rad, j) - joint<double>(without.target_rad, j);
  };
  CHECK(change(kLegJoints + kHipPitch) == Approx(-0.5 * d));
  CHECK(change(kAnklePitch) == Approx(0.7 * d));
  CHECK(change(kLegJoints + kHipRoll) == Approx(-0.9 * y));  // outwards is negative on the right
  CHECK(change(kAnkleRoll) == Approx(-1.1 * y));
  CHECK(change(kHipPitch) == Approx(0.2 * d));
  CHECK(change(kHipRoll) == Approx(0.3 * y));
  for (const std::size_t j : {std::size_t{kHipYaw}, std::size_t{kKnee}, kLegJoints + kKnee,
                              kLegJoints + kAnklePitch, kLegJoints + kAnkleRoll})
    CHECK(change(j) == 0.0);
  w.gains[0] = 1000.0;
  CHECK(joint<double>(run(0.05).target_rad, kLegJoints + kHipPitch) -
            joint<double>(without.target_rad, kLegJoints + kHipPitch) ==
        Approx(-0.3));
}

TEST_CASE("robots in lanes have the bits that each has by itself") {
  using Lane = dynamics::SimdBatch<float, 8>;
  const Parameters<float> one_body(design());
  const Parameters<Lane> body(design());
  std::array<WalkParameters<float>, 8> walks;
  WalkConfig<Lane> config({}, body);
  auto values = config.walk.values();
  for (std::size_t lane = 0; lane < 8; ++lane) {
    std::array<float, WalkParameters<float>::kCount> mine{};
    for (std::size_t i = 0; i < mine.size(); ++i) {
      const auto& p = kWalkParameters[i];
      const double share =
          0.5 + 0.4 * std::sin(1.7 * static_cast<double>(i) + 0.9 * static_cast<double>(lane));
      mine[i] = static_cast<float>(p.least + share * (p.most - p.least));
      values[i].set(lane, mine[i]);
    }
    walks[lane] = WalkParameters<float>::of(mine);
  }
  config.walk = WalkParameters<Lane>::of(values);
  WalkState<Lane> all = begin_walk(config);
  std::vector<WalkConfig<float>> configs;
  std::vector<WalkState<float>> states;
  for (const auto& w : walks) configs.emplace_back(w, one_body), states.push_back(begin_walk(configs.back()));
  WalkOutputs<Lane> out;
  for (int i = 0; i < 2500; ++i) {
    // Every robot somewhere else, and its feet come and go.
    WalkSample<Lane> sample = upright<Lane>(1.0, 1.0);
    std::vector<WalkSample<float>> single(8, upright<float>(1.0, 1.0));
    for (std::size_t lane = 0; lane < 8; ++lane) {
      for (std::size_t j = 0; j < kJoints; ++j) {
        const float q = 0.3f * std::sin(0.004f * static_cast<float>(i) + static_cast<float>(j + 3 * lane));
        Lane v = joint<Lane>(sample.q_rad, j);
        v.set(lane, q);
        set_joint<Lane>(sample.q_rad, j, v);
        set_joint<float>(single[lane].q_rad, j, q);
      }
      const float left = (i / 100 + static_cast<int>(lane)) % 3 == 0 ? 0.0f : 1.0f,
                  right = (i / 130) % 2 == 0 ? 0.0f : 1.0f;
      sample.left_carries.set(lane, left), sample.right_carries.set(lane, right);
      single[lane].left_carries = left, single[lane].right_carries = right;
    }
    step_walk(config, sample, 1e-3f, all, out);
    for (std::size_t lane = 0; lane < 8; ++lane) {
      WalkOutputs<float> mine;
      step_walk(configs[lane], single[lane], 1e-3f, states[lane], mine);
      bool same = all.phase[lane] == states[lane].phase[0] && all.on_left[lane] == states[lane].on_left[0];
      for (std::size_t j = 0; j < kJoints; ++j)
        same = same && joint<Lane>(out.target_rad, j)[lane] == joint<float>(mine.target_rad, j);
      if (!same) FAIL("lane " << lane << ", tick " << i);
    }
  }
  std::uint32_t landings = 0;
  for (const auto& s : states) landings += s.steps[0];
  CHECK(landings > 16);
}

TEST_CASE("a foot's switch closes at once and opens after 10 ms below half of its threshold") {
  FootSwitch<float> foot;
  foot.step(29.0f, 30.0f, 1e-3f);
  CHECK(foot.carries == 0.0f);
  foot.step(31.0f, 30.0f, 1e-3f);
  CHECK(foot.carries == 1.0f);
  for (int i = 0; i < 100; ++i) foot.step(16.0f, 30.0f, 1e-3f);
  CHECK(foot.carries == 1.0f);
  for (int i = 0; i < 9; ++i) foot.step(14.0f, 30.0f, 1e-3f);
  CHECK(foot.carries == 1.0f);
  foot.step(16.0f, 30.0f, 1e-3f);  // and again from the start
  for (int i = 0; i < 9; ++i) foot.step(14.0f, 30.0f, 1e-3f);
  CHECK(foot.carries == 1.0f);
  foot.step(14.0f, 30.0f, 1e-3f);
  CHECK(foot.carries == 0.0f);
}

TEST_CASE("the table of names stands in the parameters' order") {
  WalkParameters<double> w{};
  w.knee_rad = 1, w.start_s = 2, w.sway_rad = 3, w.lean_rad = 4, w.up_s = 5, w.up_blend_s = 6, w.down_s = 7,
  w.down_blend_s = 8;
  w.up_swing.hip_pitch = 9, w.up_swing.ankle_roll = 10, w.up_stance.knee = 11, w.down_swing.hip_roll = 12,
  w.down_stance.ankle_pitch = 13;
  w.gains[0] = 14, w.gains[5] = 15, w.gains[11] = 16, w.side_m = 17, w.stop_blend_s = 18, w.stop_d_radpm = 19,
  w.stop_v_radspm = 20;
  const auto values = w.values();
  const auto named = [&](std::string_view name) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (kWalkParameters[i].name == name) return values[i];
    return -1.0;
  };
  double expected = 0.0;
  for (const char* name : {"posture.knee_rad",
                           "start.time_s",
                           "start.sway_rad",
                           "start.lean_rad",
                           "up.time_s",
                           "up.blend_s",
                           "down.time_s",
                           "down.blend_s",
                           "up.swing.hip_pitch_rad",
                           "up.swing.ankle_roll_rad",
                           "up.stance.knee_rad",
                           "down.swing.hip_roll_rad",
                           "down.stance.ankle_pitch_rad",
                           "gain.swing_hip_pitch_d_radpm",
                           "gain.swing_hip_roll_vy_radspm",
                           "gain.stance_hip_roll_vy_radspm",
                           "gain.side_m",
                           "stop.blend_s",
                           "stop.ankle_pitch_d_radpm",
                           "stop.ankle_pitch_v_radspm"}) {
    INFO(name);
    CHECK(named(name) == ++expected);
  }
}
