// The biped's accelerations against inverse dynamics of a tree, against MuJoCo's, and what free flight leaves as it is.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/common/dynamics/biped_examples.hpp"
#include "tests/common/dynamics/biped_mjcf.hpp"
#include "tests/host/model/mujoco_peer.hpp"
#include "tests/skip.hpp"

using namespace furcula;
using namespace furcula::test;

namespace {

/// The largest error of the torques that inverse dynamics asks for at the biped's accelerations, over the largest term.
template <class Topology, class P>
double inverse_dynamics_error(Random& r, const biped::Description& d, const Tree18& tree, const P& p) {
  const Coordinates c = random_coordinates(r);
  const auto torque = random_torques(r, 200.0);
  const auto a = biped::accelerations<Topology>(p, state_of(c), in_flight(d, torque));
  const auto asked = inverse_dynamics(tree, c.q, c.qd, second_derivatives(c, a));
  double worst = 0.0, scale = 0.0;
  for (std::size_t i = 0; i < 18; ++i) {
    const double given = i < 6 ? 0.0 : torque[i - 6];
    worst = std::max(worst, std::abs(asked[i] - given));
    scale = std::max(scale, std::abs(given));
  }
  return worst / scale;
}

/// No motor, no friction: only the bodies, with armatures.
biped::JointLaws<double> limp(const biped::Parameters<double>& p) {
  auto laws = biped::active_laws(p);
  for (auto& l : laws[0])
    l.kp_nmprad = l.kd_nmsprad = l.damping_nmspr = l.friction_nm = dynamics::SimdBatch<double, 2>(0.0);
  return laws;
}

/// The design with other links, their joints anywhere in their parents.
biped::Description any_robot(Random& r) {
  biped::Description d = biped::design();
  for (auto& leg : d.legs)
    for (auto& l : leg) {
      const Vec3<double> aside = r.vector(0.1), c = r.vector(0.1);
      l.offset_m += aside;
      l.centre_m += c;
      l.mass_kg *= r.within(0.5, 2.0);
    }
  return d;
}

struct Flight {
  double energy_j, linear_ns, spin_nms;  ///< what half a second changed that should not have
};

Flight fly(double h_s, int rule) {
  const biped::Description d = biped::design();
  const biped::Parameters<double> p(d);
  const auto laws = limp(p);
  const biped::Commands<double> none;
  Coordinates c{};
  c.q = {0.0, 0.0, 5.0, 0.3, 0.4, -0.2, 0.1, -0.2, -0.4, 0.8, -0.3, 0.1, -0.1, 0.3, -0.5, 0.6, -0.1, 0.05};
  c.qd = {0.3, -0.2, 0.5, 0.0, 0.0, 0.0, 2.0, -1.5, 3.0, -2.5, 1.0, -2.0, -3.0, 1.0, -2.0, 3.0, 1.5, 2.5};
  biped::State<double> s = state_of(c);
  s.w_radps = {1.2, -1.2, 1.06};  // 2 rad/s
  const auto energy = [&] {
    const auto t = biped::totals(p, s);
    return t.kinetic_j + biped::motors_kinetic_j(p, laws, s) + biped::height_energy_j(p, t);
  };
  const double before = energy();
  const auto start = biped::totals(p, s);
  biped::StepReport<double> report;
  const int steps = static_cast<int>(std::lround(0.5 / h_s));
  for (int n = 0; n < steps; ++n) {
    if (rule == 1) biped::step(p, laws, none, h_s, s, report);
    if (rule == 2) biped::check_step<biped::Rule::midpoint>(p, laws, none, h_s, s);
    if (rule == 4) biped::check_step<biped::Rule::runge_kutta>(p, laws, none, h_s, s);
  }
  const auto end = biped::totals(p, s);
  const Vec3<double> fallen = p.gravity_mps2 * (start.mass_kg * 0.5);
  const Vec3<double> linear = end.linear_ns - start.linear_ns - fallen,
                     spin = end.spin_nms() - start.spin_nms();
  return {std::abs(energy() - before), std::sqrt(dot(linear, linear)), std::sqrt(dot(spin, spin))};
}

}  // namespace

TEST_CASE("The biped's accelerations ask for the torques that made them") {
  Random r(11);
  for (int n = 0; n < 200; ++n) {
    CAPTURE(n);
    const biped::Description d = biped::design();
    const biped::Parameters<double> p(d);
    REQUIRE(inverse_dynamics_error<biped::DesignTopology>(r, d, as_tree(d), p) < 1e-9);
  }
}

TEST_CASE("On a stand that holds the pelvis it stays, and the joints ask for the torques that made them") {
  Random r(13);
  for (int n = 0; n < 200; ++n) {
    CAPTURE(n);
    const biped::Description d = any_robot(r);
    const biped::JointFrames frames = random_frames(r);
    const biped::TurnedParameters<double> turned(d, frames);
    Coordinates c = random_coordinates(r);
    for (std::size_t i = 0; i < 6; ++i) c.qd[i] = 0.0;
    const auto torque = random_torques(r, 200.0);
    const auto a =
        biped::accelerations<biped::AnywhereTopology, true>(turned, state_of(c), in_flight(d, torque));
    for (const double x :
         {a.wd_radps2.x, a.wd_radps2.y, a.wd_radps2.z, a.vd_mps2.x, a.vd_mps2.y, a.vd_mps2.z})
      REQUIRE(std::abs(x) < 1e-12);
    const auto asked = inverse_dynamics(as_tree(d, frames), c.q, c.qd, second_derivatives(c, a));
    for (std::size_t i = 6; i < 18; ++i) REQUIRE(asked[i] == Approx(torque[i - 6]).margin(1e-7));
  }
}

TEST_CASE("Links of any inertia on joints anywhere, and turned, ask for the torques that made them") {
  Random r(12);
  for (int n = 0; n < 200; ++n) {
    const biped::Description d = any_robot(r);
    CAPTURE(n);
    const biped::Parameters<double> p(d);
    REQUIRE(inverse_dynamics_error<biped::AnywhereTopology>(r, d, as_tree(d), p) < 1e-9);
    const biped::JointFrames frames = random_frames(r);
    const biped::TurnedParameters<double> turned(d, frames);
    REQUIRE(inverse_dynamics_error<biped::AnywhereTopology>(r, d, as_tree(d, frames), turned) < 1e-9);
  }
}

TEST_CASE("Joints that are turned by nothing move as those that are not") {
  const biped::Description d = biped::design();
  const biped::Parameters<double> p(d);
  const biped::TurnedParameters<double> turned(d, straight_frames());
  Random r(15);
  for (int n = 0; n < 20; ++n) {
    const biped::State<double> s = state_of(random_coordinates(r));
    const auto act = in_flight(d, random_torques(r, 100.0));
    const auto a = biped::accelerations(p, s, act);
    const auto b = biped::accelerations<biped::AnywhereTopology>(turned, s, act);
    for (std::size_t i = 0; i < biped::kJoints; ++i)
      CHECK(biped::joint<double>(b.qdd_radps2, i) ==
            Approx(biped::joint<double>(a.qdd_radps2, i)).epsilon(1e-9).margin(1e-9));
  }
}

TEST_CASE("A robot of turned joints keeps its energy and momentum in free flight") {
  Random r(16);
  const biped::Description d = any_robot(r);
  const biped::TurnedParameters<double> p(d, random_frames(r));
  const auto laws = limp(p);
  const biped::Commands<double> none;
  biped::State<double> s = state_of(random_coordinates(r, 2.0));
  const auto energy = [&] {
    const auto t = biped::totals(p, s);
    return t.kinetic_j + biped::motors_kinetic_j(p, laws, s) + biped::height_energy_j(p, t);
  };
  s.position_m.z = 5.0;
  const double before = energy();
  const auto start = biped::totals(p, s);
  for (int n = 0; n < 400; ++n)
    biped::check_step<biped::Rule::runge_kutta, biped::AnywhereTopology>(p, laws, none, 2.5e-4, s);
  CHECK(energy() == Approx(before).margin(1e-6));
  const auto end = biped::totals(p, s);
  const Vec3<double> linear = end.linear_ns - start.linear_ns - p.gravity_mps2 * (start.mass_kg * 0.1),
                     spin = end.spin_nms() - start.spin_nms();
  CHECK(std::sqrt(dot(linear, linear)) < 1e-7);
  CHECK(std::sqrt(dot(spin, spin)) < 1e-7);
}

TEST_CASE("A wrench at a foot and a torque in a joint see each other's motion (Maxwell's reciprocity)") {
  Random r(13);
  const biped::Description d = biped::design();
  const biped::Parameters<double> p(d);
  const auto laws = biped::active_laws(p);
  for (int n = 0; n < 20; ++n) {
    Coordinates c = random_coordinates(r, 0.0);
    const biped::State<double> s = state_of(c);
    biped::Actions<double> act = in_flight(d, {});
    act.gravity_mps2 = {0.0, 0.0, 0.0};
    const std::size_t foot = static_cast<std::size_t>(n % 2);
    const Force<double> wrench{r.vector(30.0), r.vector(300.0)};
    const auto lane = [&](dynamics::SimdBatch<double, 2>& x, double value) { x.set(foot, value); };
    lane(act.foot[0].n.x, wrench.n.x), lane(act.foot[0].n.y, wrench.n.y), lane(act.foot[0].n.z, wrench.n.z);
    lane(act.foot[0].f.x, wrench.f.x), lane(act.foot[0].f.y, wrench.f.y), lane(act.foot[0].f.z, wrench.f.z);
    const auto pushed = biped::accelerations(p, s, act);
    for (std::size_t j = 0; j < biped::kJoints; ++j) {
      const auto unit = biped::unit_response(p, laws, s, j / biped::kLegJoints, j % biped::kLegJoints);
      biped::State<double> moving = s;
      biped::kick(moving, unit, 1.0);  // from rest: the motion of a unit of impulse
      biped::Kinematics<double> k;
      biped::kinematics<biped::DesignTopology>(p, moving, k);
      const auto& leg = k.legs[0];
      const auto& w = leg.w_radps[biped::kAnkleRoll];
      const auto& v = leg.foot_v_mps;
      const double work = wrench.n.x * w.x[foot] + wrench.n.y * w.y[foot] + wrench.n.z * w.z[foot] +
                          wrench.f.x * v.x[foot] + wrench.f.y * v.y[foot] + wrench.f.z * v.z[foot];
      CHECK(biped::joint<double>(pushed.qdd_radps2, j) == Approx(work).epsilon(1e-9).margin(1e-9));
    }
  }
}

TEST_CASE("In free flight energy drifts by the step to the power 1, 2 and 4, and momentum stays") {
  const auto order = [](const Flight& coarse, const Flight& fine) {
    return std::log2(coarse.energy_j / fine.energy_j);
  };
  const Flight euler[3] = {fly(1e-3, 1), fly(5e-4, 1), fly(2.5e-4, 1)};
  const Flight midpoint[3] = {fly(1e-3, 2), fly(5e-4, 2), fly(2.5e-4, 2)};
  const Flight rk[3] = {fly(2e-3, 4), fly(1e-3, 4), fly(5e-4, 4)};
  CAPTURE(euler[0].energy_j, midpoint[0].energy_j, rk[0].energy_j);
  CHECK(order(euler[0], euler[1]) == Approx(1.0).margin(0.1));
  CHECK(order(euler[1], euler[2]) == Approx(1.0).margin(0.05));
  CHECK(order(midpoint[0], midpoint[1]) == Approx(2.0).margin(0.2));
  CHECK(order(midpoint[1], midpoint[2]) == Approx(2.0).margin(0.1));
  CHECK(order(rk[0], rk[1]) == Approx(4.0).margin(0.4));
  CHECK(order(rk[1], rk[2]) == Approx(4.0).margin(0.4));
  CHECK(rk[1].linear_ns < 1e-7);
  CHECK(rk[1].spin_nms < 1e-7);
  if (std::getenv("FURCULA_FIGURES") != nullptr)
    for (const auto* f : {&euler, &midpoint, &rk})
      for (const Flight& x : *f)
        std::printf("energy %.3e J  linear %.2e N s  spin %.2e N m s\n", x.energy_j, x.linear_ns, x.spin_nms);
}

#ifndef FURCULA_MUJOCO
TEST_CASE("The biped accelerates as MuJoCo's does, and so does one of turned joints") {
  test::skip("libmujoco-dev is not installed");
}
#else
namespace {

/// The largest difference of 1000 random states' accelerations over the largest of a state.
template <class Topology, class P>
double apart_from_mujoco(Random& r, const biped::Description& d, const P& p, const MujocoPeer& peer) {
  REQUIRE(peer.model().nv == 18);
  double worst = 0.0;
  for (int n = 0; n < 1000; ++n) {
    const Coordinates c = random_coordinates(r);
    const biped::State<double> s = state_of(c);
    const auto torque = random_torques(r, 200.0);
    const auto a = biped::accelerations<Topology>(p, s, in_flight(d, torque));
    const Mat3<double> rotation = biped::rotation(s.attitude);
    // MuJoCo's free joint: linear in world axes, angular in the body's.
    const Vec3<double> v = rotation * s.v_mps, linear = rotation * (a.vd_mps2 + cross(s.w_radps, s.v_mps));
    mjData& data = peer.data();
    const double qpos[7] = {c.q[0], c.q[1], c.q[2], s.attitude.w, s.attitude.x, s.attitude.y, s.attitude.z};
    const double qvel[6] = {v.x, v.y, v.z, s.w_radps.x, s.w_radps.y, s.w_radps.z};
    const double ours[6] = {linear.x, linear.y, linear.z, a.wd_radps2.x, a.wd_radps2.y, a.wd_radps2.z};
    std::copy(qpos, qpos + 7, data.qpos);
    std::copy(qvel, qvel + 6, data.qvel);
    for (std::size_t i = 0; i < biped::kJoints; ++i) {
      data.qpos[7 + i] = c.q[6 + i];
      data.qvel[6 + i] = c.qd[6 + i];
      data.qfrc_applied[6 + i] = torque[i];
    }
    peer.forward();
    double scale = 0.0, apart = 0.0;
    for (std::size_t i = 0; i < 18; ++i) {
      const double own = i < 6 ? ours[i] : biped::joint<double>(a.qdd_radps2, i - 6);
      scale = std::max(scale, std::abs(own));
      apart = std::max(apart, std::abs(own - data.qacc[i]));
    }
    worst = std::max(worst, apart / scale);
  }
  return worst;
}

}  // namespace

TEST_CASE("The biped accelerates as MuJoCo's does, and so does one of turned joints") {
  Random r(14);
  const biped::Description d = biped::design();
  const double worst =
      apart_from_mujoco<biped::DesignTopology>(r, d, biped::Parameters<double>(d), MujocoPeer(biped_mjcf(d)));
  CHECK(worst < 1e-9);
  const biped::JointFrames frames = random_frames(r);
  const double turned = apart_from_mujoco<biped::AnywhereTopology>(
      r, d, biped::TurnedParameters<double>(d, frames), MujocoPeer(biped_mjcf(d, &frames)));
  CHECK(turned < 1e-9);
  if (std::getenv("FURCULA_FIGURES") != nullptr)
    std::printf("MuJoCo: largest relative difference %.2e, of turned joints %.2e\n", worst, turned);
}
#endif
