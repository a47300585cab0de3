// Gaits of the biped by gradients, against the forward dynamics, kinematics and energies of dynamics/biped/, which the search for them does not use.
#include "host/walk/gait.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "furcula/dynamics/biped/design.hpp"
#include "furcula/dynamics/biped/energy.hpp"
#include "furcula/dynamics/biped/forward_dynamics.hpp"
#include "host/walk/gait_json.hpp"
#include "host/walk/gait_walk.hpp"
#include "host/walk/search.hpp"

using namespace furcula;
using namespace furcula::dynamics::biped;
using walk::GaitPhase;
using walk::GaitResult;
using walk::GaitTask;
using walk::Stance;
using walk::WalkMode;

namespace {

GaitTask task_of(WalkMode mode, std::optional<double> speed_mps, double double_support_s = 0.0) {
  GaitTask task;
  task.mode = mode;
  task.speed_mps = speed_mps;
  task.double_support_s = double_support_s;
  return task;
}

/// Found once for all cases.
const GaitResult& active() {
  static const GaitResult found = walk::find_gait(design(), task_of(WalkMode::active, 0.3));
  return found;
}
const GaitResult& semi_passive() {
  static const GaitResult found = walk::find_gait(design(), task_of(WalkMode::semi_passive, 0.3));
  return found;
}
const GaitResult& on_both_feet() {
  static const GaitResult found = [] {
    GaitTask task = task_of(WalkMode::active, 0.3, 0.15);
    task.yaw_held = false;
    return walk::find_gait(design(), task);
  }();
  return found;
}

struct Moment {
  GaitPhase::At at;
  Stance<double> stance;
  walk::JointNumbers<double> motor_nm, joint_nm;
  State<double> state;
  bool both;
};

/// 5 N m and 2 N m s/rad of the gear, whose jump is rounded over 0.05 rad/s.
double gear_nm(double qd) {
  return 2.0 * qd + 5.0 * (qd / 0.05) / std::sqrt(1.0 + (qd / 0.05) * (qd / 0.05));
}

Moment moment(const GaitPhase& phase, double time_s, WalkMode mode) {
  const Description robot = design();
  Moment m;
  m.both = phase.both;
  m.at = phase.at(time_s);
  m.stance = walk::StanceDynamics<double>(robot)(m.at.q, m.at.qd, m.at.qdd, m.at.other);
  m.motor_nm = walk::motor_torques(robot, mode, m.at, m.stance);
  m.state = walk::state_of(robot, m.at, m.stance);
  for (std::size_t i = 0; i < kJoints; ++i)
    m.joint_nm[i] = mode == WalkMode::semi_passive && i % kLegJoints == kHipPitch
                        ? -60.0 * m.at.q[i] - 0.05 * m.at.qd[i]
                        : m.motor_nm[i] - gear_nm(m.at.qd[i]);
  return m;
}

/// All along the step.
template <class F>
void along(const GaitResult& found, WalkMode mode, int moments, F f) {
  for (const GaitPhase& phase : found.gait.phases)
    for (int k = 0; k <= moments; ++k) f(moment(phase, phase.duration_s * k / moments, mode));
}

/// The most that forward dynamics under the gait's torques and wrenches differ from its accelerations by, rad/s^2 and m/s^2.
double accelerations_off(const GaitResult& found, WalkMode mode) {
  const Description robot = design();
  const Parameters<double> p(robot);
  double most = 0.0;
  along(found, mode, 30, [&](const Moment& m) {
    Actions<double> act{};
    act.gravity_mps2 = p.gravity_mps2;
    for (std::size_t i = 0; i < kJoints; ++i) {
      const bool joined = !(mode == WalkMode::semi_passive && i % kLegJoints == kHipPitch);
      set_joint<double>(act.torque_nm, i, m.joint_nm[i]);
      set_joint<double>(act.armature_kgm2, i, joined ? 1.28 : 0.0);
    }
    const std::array<Force<double>, 2> wrench{m.stance.foot, m.at.other};
    auto& foot = act.foot[0];
    foot.n.x.set(0, wrench[0].n.x), foot.n.y.set(0, wrench[0].n.y), foot.n.z.set(0, wrench[0].n.z);
    foot.f.x.set(0, wrench[0].f.x), foot.f.y.set(0, wrench[0].f.y), foot.f.z.set(0, wrench[0].f.z);
    foot.n.x.set(1, wrench[1].n.x), foot.n.y.set(1, wrench[1].n.y), foot.n.z.set(1, wrench[1].n.z);
    foot.f.x.set(1, wrench[1].f.x), foot.f.y.set(1, wrench[1].f.y), foot.f.z.set(1, wrench[1].f.z);
    const Accelerations<double> a = accelerations(p, m.state, act);
    const auto& pelvis = m.stance.pelvis;
    const auto vd = pelvis.a_mps2 + transposed_times(pelvis.rotation, p.gravity_mps2) -
                    cross(pelvis.w_radps, pelvis.v_mps);
    const auto off = [&](const Vec3<double>& x, const Vec3<double>& y) {
      most = std::max({most, std::abs(x.x - y.x), std::abs(x.y - y.y), std::abs(x.z - y.z)});
    };
    off(a.wd_radps2, pelvis.wd_radps2);
    off(a.vd_mps2, vd);
    for (std::size_t i = 0; i < kJoints; ++i)
      most = std::max(most, std::abs(joint<double>(a.qdd_radps2, i) - m.at.qdd[i]));
  });
  return most;
}

struct Foot {
  Vec3<double> at_m, v_mps, w_radps;
  Mat3<double> rotation;
};
Foot foot_of(const Moment& m, std::size_t side) {
  const Parameters<double> p(design());
  Kinematics<double> k;
  kinematics<DesignTopology>(p, m.state, k);
  const auto& leg = k.legs[0];
  const auto one = [&](const auto& v) { return Vec3<double>{v.x[side], v.y[side], v.z[side]}; };
  return {one(leg.foot_position_m),
          one(leg.foot_v_mps),
          one(leg.w_radps[kAnkleRoll]),
          {one(leg.foot_rotation.x), one(leg.foot_rotation.y), one(leg.foot_rotation.z)}};
}
double most_of(const Vec3<double>& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

}  // namespace

TEST_CASE("a gait's torques and foot wrenches give its accelerations in the forward dynamics") {
  REQUIRE(active().found);
  CHECK(accelerations_off(active(), WalkMode::active) < 1e-6);
  REQUIRE(on_both_feet().found);
  CHECK(on_both_feet().gait.phases.size() == 2);
  CHECK(accelerations_off(on_both_feet(), WalkMode::active) < 1e-6);
}

TEST_CASE("a passive hip of a gait has the torque of its spring alone") {
  REQUIRE(semi_passive().found);
  // What its spline lacks of a spring's torque between the moments that hold it, against a body torque of some 10 N m.
  CHECK(semi_passive().figures.spring_off_nm < 0.5);
  along(semi_passive(), WalkMode::semi_passive, 30, [](const Moment& m) {
    for (const std::size_t side : {kLeft, kRight}) {
      const std::size_t i = side * kLegJoints + kHipPitch;
      CHECK(m.stance.body_nm[i] == Approx(-60.0 * m.at.q[i] - 0.05 * m.at.qd[i]).margin(0.5));
      CHECK(m.motor_nm[i] == Approx(1.28 * m.at.qdd[i] + gear_nm(m.at.qd[i])));
    }
  });
}

TEST_CASE("the standing foot of a gait stays put, the other one lands flat and at rest") {
  along(active(), WalkMode::active, 30, [](const Moment& m) {
    const Foot stands = foot_of(m, kLeft);
    CHECK(std::hypot(stands.at_m.x, stands.at_m.y) < 1e-12);
    CHECK(stands.at_m.z == Approx(0.09).margin(1e-12));
    CHECK(most_of(stands.v_mps) < 1e-12);
    CHECK(most_of(stands.w_radps) < 1e-12);
    CHECK(stands.rotation.z.z == Approx(1.0).margin(1e-12));
    CHECK(stands.rotation.x.x == Approx(1.0).margin(1e-12));
  });
  const GaitPhase& step = active().gait.phases.back();
  const Foot lands = foot_of(moment(step, step.duration_s, WalkMode::active), kRight);
  CHECK(lands.at_m.x == Approx(active().gait.step_m).margin(1e-7));
  CHECK(lands.at_m.y == Approx(-active().gait.step_width_m).margin(1e-7));
  CHECK(lands.at_m.z == Approx(0.09).margin(1e-7));
  CHECK(lands.rotation.z.z == Approx(1.0).margin(1e-9));
  CHECK(most_of(lands.v_mps) < 1e-6);
  CHECK(most_of(lands.w_radps) < 1e-6);
  const Foot swings = foot_of(moment(step, 0.5 * step.duration_s, WalkMode::active), kRight);
  CHECK(swings.at_m.z > 0.105);
}

TEST_CASE("both feet of a gait stay where they are while both stand") {
  const GaitPhase& both = on_both_feet().gait.phases.back();
  REQUIRE(both.both);
  CHECK(both.duration_s >= 0.15 - 1e-9);
  for (int k = 0; k <= 20; ++k) {
    const Foot f = foot_of(moment(both, both.duration_s * k / 20, WalkMode::active), kRight);
    CHECK(f.at_m.x == Approx(on_both_feet().gait.step_m).margin(2e-4));
    CHECK(f.at_m.y == Approx(-on_both_feet().gait.step_width_m).margin(2e-4));
    CHECK(f.at_m.z == Approx(0.09).margin(2e-4));
    CHECK(most_of(f.v_mps) < 5e-3);
  }
}

TEST_CASE("a gait's end is its beginning in a mirror, a step further") {
  for (const GaitResult* found : {&active(), &on_both_feet()}) {
    const auto& phases = found->gait.phases;
    const Moment begin = moment(phases.front(), 0.0, WalkMode::active),
                 end = moment(phases.back(), phases.back().duration_s, WalkMode::active);
    const auto mirror = [](const Vec3<double>& v) { return Vec3<double>{v.x, -v.y, v.z}; };
    const Vec3<double> foot{found->gait.step_m, -found->gait.step_width_m, 0.0};
    CHECK(most_of(mirror(end.state.position_m - foot) - begin.state.position_m) < 1e-6);
    CHECK(most_of(mirror(end.state.v_mps) - begin.state.v_mps) < 1e-6);
    // Angular velocities are mirrored the other way.
    CHECK(most_of(mirror(end.state.w_radps) * -1.0 - begin.state.w_radps) < 1e-6);
    const std::array<double, kLegJoints> sign{-1.0, -1.0, 1.0, 1.0, 1.0, -1.0};
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      CHECK(end.at.q[kLegJoints + j] == Approx(sign[j] * begin.at.q[j]).margin(1e-7));
      CHECK(end.at.q[j] == Approx(sign[j] * begin.at.q[kLegJoints + j]).margin(1e-7));
      CHECK(end.at.qd[kLegJoints + j] == Approx(sign[j] * begin.at.qd[j]).margin(1e-6));
    }
    CHECK(found->gait.step_m == Approx(0.3 * found->gait.duration_s()).epsilon(1e-6));
  }
}

TEST_CASE("a gait keeps document 000's limits between its moments too") {
  for (const GaitResult* found : {&active(), &semi_passive(), &on_both_feet()}) {
    const walk::GaitFigures& f = found->figures;
    // The short phase on both feet has six moments: 0.3 % over between them was seen.
    CHECK(f.torque_nm <= 80.0 * (found == &on_both_feet() ? 1.005 : 1.0));
    CHECK(f.speed_radps <= 1.5);
    CHECK(f.moment_nm <= 50.0);
    CHECK(f.range_rad <= 1.57);
    CHECK(f.height_m >= 0.8);
    CHECK(f.apart_m >= 0.13);
    CHECK(f.least_knee_rad >= 0.1 - 1e-9);
    CHECK(f.load_n > 0.0);
    CHECK(f.friction <= 0.8);
    CHECK(f.pressure_m >= 0.0);
    CHECK(f.sole_m >= -1e-4);
  }
}

TEST_CASE("what motors do in a gait goes into motion, height and the gears") {
  const Parameters<double> p(design());
  const auto laws = active_laws(p);
  const auto energy_j = [&](const Moment& m) {
    const auto sums = totals(p, m.state);
    return sums.kinetic_j + motors_kinetic_j(p, laws, m.state) + height_energy_j(p, sums);
  };
  const GaitPhase& step = active().gait.phases.front();
  constexpr int kMoments = 2000;
  const double dt = step.duration_s / kMoments;
  const double begin_j = energy_j(moment(step, 0.0, WalkMode::active));
  double sum_j = 0.0, motors_j = 0.0, copper_j = 0.0, most_j = 0.0;
  for (int k = 0; k < kMoments; ++k) {
    const Moment m = moment(step, dt * (k + 0.5), WalkMode::active);
    for (std::size_t i = 0; i < kJoints; ++i) {
      sum_j += m.joint_nm[i] * m.at.qd[i] * dt;
      motors_j += m.motor_nm[i] * m.at.qd[i] * dt;
      copper_j += 0.386 * std::pow(m.motor_nm[i] / (160.0 * 0.0276), 2) * dt;
    }
    if (k % 200 != 199) continue;
    const double now_j = energy_j(moment(step, dt * (k + 1), WalkMode::active)) - begin_j;
    CHECK(sum_j == Approx(now_j).margin(1e-3));
    most_j = std::max(most_j, std::abs(now_j));
  }
  CHECK(most_j > 0.5);                       // so the above says something
  CHECK(sum_j == Approx(0.0).margin(1e-3));  // a period
  const walk::GaitFigures& f = active().figures;
  CHECK(f.work_j == Approx(motors_j).epsilon(2e-3));
  CHECK(f.copper_j == Approx(copper_j).epsilon(2e-3));
  CHECK(f.constant_j == Approx(100.0 * step.duration_s));
  CHECK(f.cot == Approx((motors_j + copper_j + 100.0 * step.duration_s) / (49.8 * 9.8 * active().gait.step_m))
                     .epsilon(2e-3));
}

TEST_CASE("the cheapest gait is a local optimum that others are hardly cheaper than") {
  const GaitResult best = walk::find_gait(design(), task_of(WalkMode::active, std::nullopt));
  REQUIRE(best.found);
  CHECK(best.figures.cot < active().figures.cot);
  const GaitResult slower =
      walk::find_gait(design(), task_of(WalkMode::active, 0.9 * best.gait.step_m / best.gait.duration_s()));
  REQUIRE(slower.found);
  CHECK(slower.figures.cot > 0.97 * best.figures.cot);  // 0.986 against 0.999 was seen
}

TEST_CASE("where there is no gait, what stands against it is said") {
  GaitTask task = task_of(WalkMode::active, 0.3);
  task.limits.torque_nm = 20.0;  // a hip that carries the robot on one leg needs more
  task.cpu_s = 3.0;
  const GaitResult found = walk::find_gait(design(), task);
  CHECK_FALSE(found.found);
  CHECK_THAT(walk::against_gait(found, task),
             Catch::Contains("no gait was found at 0.3 m/s") && Catch::Contains("limiting constraint: "));
}

TEST_CASE("a robot that stands still gives targets that its drives hold it with") {
  // Both legs for ever in a posture, as if it were a step.
  const Description robot = design();
  walk::Gait still;
  still.step_width_m = 0.18;
  GaitPhase phase;
  phase.duration_s = 1.0;
  for (std::size_t i = 0; i < kJoints; ++i) {
    const std::size_t j = i % kLegJoints;
    phase.joints[i].assign(11, j == kKnee ? 0.5 : j == kHipPitch || j == kAnklePitch ? -0.25 : 0.0);
  }
  still.phases.push_back(phase);
  const Moment m = moment(phase, 0.5, WalkMode::active);
  const walk::GaitWalk found = walk::walk_of(robot, WalkMode::active, still);
  const walk::Parameters& w = found.walk;
  // The gear does not move: what a motor holds makes the droop, 3000 N m/rad.
  CHECK(w.knee_rad + w.down_swing.knee == Approx(0.5 + m.joint_nm[kLegJoints + kKnee] / 3000.0).margin(6e-3));
  CHECK(w.knee_rad + w.up_stance.knee == Approx(0.5 + m.joint_nm[kKnee] / 3000.0).margin(6e-3));
  const auto& values = w.values();
  for (std::size_t i = 0; i < values.size(); ++i) {
    CHECK(values[i] >= control::kWalkParameters[i].least);
    CHECK(values[i] <= control::kWalkParameters[i].most);
  }
}

TEST_CASE("a gait as targets is near to what its drives need, and a search may start from it") {
  const Description robot = design();
  const walk::GaitWalk w = walk::walk_of(robot, WalkMode::active, active().gait);
  CHECK(w.error_rad < 0.05);
  CHECK(w.walk.up_s < active().gait.duration_s());
  CHECK(w.walk.up_s + w.walk.down_s > active().gait.duration_s());
  walk::SearchOptions o;
  o.steps = 1;  // a generation
  o.start = w.walk;
  const walk::SearchResult from = walk::search_walk(robot, o);
  o.start.reset();
  const walk::SearchResult plain = walk::search_walk(robot, o);
  // A generation's walks lie about the start.
  const auto far = [&](const walk::Parameters& a) {
    double sum = 0.0;
    const auto is = a.values(), at = w.walk.values();
    for (std::size_t i = 0; i < is.size(); ++i)
      sum += std::pow(
          (is[i] - at[i]) / (control::kWalkParameters[i].most - control::kWalkParameters[i].least), 2);
    return sum;
  };
  CHECK(far(from.walk) < far(plain.walk));
}
