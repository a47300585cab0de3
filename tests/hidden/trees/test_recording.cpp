// Recordings of robots: what happened follows from state and input, a delay is one, paths are smooth.
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/hidden/trees/recording.hpp"

namespace furcula::hidden::trees {
namespace {

Robot bar() {
  Robot robot;
  Joint j;
  j.name = "j1";
  robot.joints.push_back(j);
  Body b;
  b.name = "link1";
  b.moments = {0.1, 0.1, 0.1};
  robot.bodies.push_back(b);
  return robot;
}

Lab lab_of(std::size_t joints) {
  Lab lab;
  for (std::size_t j = 0; j < joints; ++j) {
    lab.kp[j] = 5;
    lab.kd[j] = 1;
    lab.effort[j] = 100;
    lab.rms_nm[j] = 1;
    lab.disturbance_nm[j] = 0.02;
    lab.disturbance_s[j] = 0.02;
  }
  return lab;
}

// Angles of rows begin + 1 .. end.
double furthest(const std::vector<Values>& predicted, const Recording& r, std::size_t begin,
                std::size_t joints) {
  double out = 0.0;
  for (std::size_t i = 0; i < predicted.size(); ++i)
    for (std::size_t j = 0; j < joints; ++j)
      out = std::max(out, std::fabs(predicted[i][j] - r.state[begin + 1 + i].q[j]));
  return out;
}

}  // namespace

TEST_CASE("A torque command reaches the joint after the delay, between rows too", "[trees]") {
  const Machine m(bar(), {{}}, false, {{"actuator_delay", {"j1"}, {{"delay_s", 0.013}}}});
  Recording r;
  for (std::size_t row = 0; row <= 20; ++row) {
    r.time_s.push_back(0.005 * static_cast<double>(row));
    r.input.push_back({row >= 4 ? 2.0 : 0.0});
    r.state.emplace_back();
  }
  const auto q = restarted(m, m, r, 0, 20);
  // The step at 20 ms acts from 33 ms on.
  const double since = 0.1 - 0.033;
  CHECK(q.at(5)[0] == 0.0);
  CHECK(q.at(19)[0] == Approx(2.0 / 0.1 * since * since / 2).epsilon(1e-9));
}

TEST_CASE("Without disturbance the true robot, restarted, does what it did", "[trees]") {
  const std::vector<std::vector<Cause>> sets = {
      {},
      {{"coulomb_friction", {"j1"}, {{"torque_nm", 0.2}}}, {"actuator_delay", {"j1"}, {{"delay_s", 0.007}}}},
      {{"actuator_lag", {"j1"}, {{"time_constant_s", 0.02}}},
       {"encoder_offset", {"j1"}, {{"offset_rad", 0.05}}}},
      {{"joint_elasticity", {"j1"}, {{"stiffness_nmprad", 300}}}}};
  for (const auto& causes : sets) {
    const Machine m(bar(), {{.rotor_kgm2 = 0.02, .damping_nmspr = 0.1}}, false, causes);
    Random random(4);
    const Experiment e = draw_experiment(random, m.robot(), 2.0, 0.8);
    const Recording r = record(m, m.dynamics(), lab_of(1), e, false, random);
    REQUIRE(sound(r, m.robot(), 1, 1.0));
    REQUIRE(r.time_s.size() == 500);
    const double offset = m.act(0).encoder_rad;
    const Recording disturbed = record(m, m.dynamics(), lab_of(1), e, true, random);
    double quiet = 0.0, moved = 0.0;
    for (std::size_t row = 75; row + 75 < r.time_s.size(); row += 75) {
      auto q = restarted(m, m, r, row, row + 75), other = restarted(m, m, disturbed, row, row + 75);
      for (std::size_t i = 0; i < q.size(); ++i) {
        q[i][0] -= offset;
        other[i][0] -= offset;
      }
      quiet = std::max(quiet, furthest(q, r, row, 1));
      moved = std::max(moved, furthest(other, disturbed, row, 1));
    }
    CHECK(quiet < 1e-6);
    CHECK(moved > 1e-4);
  }
}

TEST_CASE("The computer, and a restart, go by what the encoder reads", "[trees]") {
  const Machine truth(bar(), {{}}, false, {{"encoder_offset", {"j1"}, {{"offset_rad", 0.05}}}});
  Experiment e;
  e.duration_s = 6;
  e.paths.emplace_back();
  const Recording r = record(truth, truth.dynamics(), lab_of(1), e, false, Random(3));
  CHECK(r.state.back().q[0] == Approx(-0.05).margin(1e-3));
  // A model without the offset starts from the angle that was read.
  Recording still = r;
  for (State& s : still.state) s = {};
  for (Values& u : still.input) u = {};
  const Machine plain(bar(), {{}}, false, {});
  CHECK(restarted(plain, truth, still, 10, 20).back()[0] == Approx(0.05));
  CHECK(restarted(truth, plain, still, 10, 20).back()[0] == Approx(0.0).margin(1e-12));
}

TEST_CASE("The disturbance has the size that the laboratory says", "[trees]") {
  // A mass with damping d, held by nothing: v' = (w - d v) / J with w of size s and correlation T has the variance
  // s^2 T / (d (d T + J)).
  Robot robot = bar();
  const double inertia = 0.01, damping = 0.2, size = 0.05, seconds = 0.02;
  robot.bodies[0].moments = {inertia, inertia, inertia};
  const Machine m(robot, {{.damping_nmspr = damping}}, false, {});
  Lab lab = lab_of(1);
  lab.kp[0] = lab.kd[0] = 0;
  lab.disturbance_nm[0] = size;
  lab.disturbance_s[0] = seconds;
  Experiment e;
  e.duration_s = 120;
  e.paths.emplace_back();
  const Recording r = record(m, m.dynamics(), lab, e, true, Random(8));
  double sum = 0.0;
  for (const State& s : r.state) sum += s.v[0] * s.v[0];
  const double expected = size * size * seconds / (damping * (damping * seconds + inertia));
  // 120 s are some 2000 correlation times: 5 % at twice the standard deviation.
  CHECK(sum / static_cast<double>(r.state.size()) == Approx(expected).epsilon(0.08));
}

TEST_CASE("Jittered rows are early and late by up to a third of a period, and do not drift", "[trees]") {
  const Machine m(bar(), {{}}, false, {});
  Lab lab = lab_of(1);
  lab.jitter = true;
  Experiment e;
  e.duration_s = 2;
  e.paths.emplace_back();
  const Recording r = record(m, m.dynamics(), lab, e, false, Random(3));
  double early = 0.0, late = 0.0;
  for (std::size_t row = 0; row < r.time_s.size(); ++row) {
    const double by = (r.time_s[row] - 0.004 * static_cast<double>(row)) / 0.004;
    early = std::min(early, by);
    late = std::max(late, by);
  }
  CHECK(early > -0.31);
  CHECK(early < -0.2);
  CHECK(late < 0.31);
  CHECK(late > 0.2);
}

TEST_CASE("A path's rate is its slope", "[trees]") {
  Random random(2);
  Robot robot = bar();
  for (int i = 0; i < 12; ++i) {
    const Experiment e = draw_experiment(random, robot, 4.0, 1.0);
    const Path& p = e.paths.front();
    for (double t = 0.05; t < 3.9; t += 0.31) {
      CHECK(p.rate(t) == Approx((p.at(t + 1e-6) - p.at(t - 1e-6)) / 2e-6).margin(1e-6));
      CHECK(std::fabs(p.at(t) - robot.joints[0].centre) <= robot.joints[0].range + 1e-9);
    }
  }
}

}  // namespace furcula::hidden::trees
