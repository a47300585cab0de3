// A foot that stands: random trees against the principle of least constraint, and the planar leg's own equations.
#include <Eigen/Dense>
#include <catch2/catch.hpp>

#include "furcula/dynamics/planar_leg.hpp"
#include "furcula/dynamics/tree/plant.hpp"
#include "tests/common/dynamics/tree_examples.hpp"

using namespace furcula;
using namespace furcula::test;

namespace {

using Shape = DynamicTopology<10>;
using Tree = Model<double, Shape>;
using Joints = Tree::Joints;

const dynamics::PlanarLegParameters<double> kLeg{.mass_kg = 6.71,
                                                 .thigh_mass_kg = 2.43,
                                                 .shank_mass_kg = 0.73,
                                                 .thigh_inertia_kgm2 = 0.06,
                                                 .shank_inertia_kgm2 = 0.02,
                                                 .thigh_length_m = 0.32,
                                                 .shank_length_m = 0.327,
                                                 .thigh_com_m = 0.092,
                                                 .shank_com_m = 0.097,
                                                 .hip_damping_nmspr = 0.31,
                                                 .knee_damping_nmspr = 0.06,
                                                 .stiffness_nmprad = 60.67,
                                                 .rest_angle_rad = 0.0,
                                                 .gravity_mps2 = 9.81};

/// The planar leg as a tree: a torso on two slides, thigh and shank (x forward, z up).
Tree planar_leg() {
  Tree m;
  const auto& p = kLeg;
  const Inertia<double> none{};
  add(m, -1, JointKind::prismatic, at(0, 0, 0), {1, 0, 0}, none);
  add(m, 0, JointKind::prismatic, at(0, 0, 0), {0, 0, 1},
      inertia_of(p.mass_kg - p.thigh_mass_kg - p.shank_mass_kg, Vec3<double>{0, 0, 0}, Sym3<double>{}));
  const double a = p.thigh_inertia_kgm2, b = p.shank_inertia_kgm2;
  add(m, 1, JointKind::revolute, at(0, 0, 0), {0, -1, 0},
      inertia_of(p.thigh_mass_kg, Vec3<double>{0, 0, -p.thigh_com_m}, Sym3<double>{a, 0, 0, a, 0, a}));
  add(m, 2, JointKind::revolute, at(0, 0, -p.thigh_length_m), {0, -1, 0},
      inertia_of(p.shank_mass_kg, Vec3<double>{0, 0, -p.shank_com_m}, Sym3<double>{b, 0, 0, b, 0, b}));
  m.laws[2].damping_nmspr = p.hip_damping_nmspr;
  m.laws[3].damping_nmspr = p.knee_damping_nmspr;
  return m;
}
const Foothold<double> kToe{3, {0.0, 0.0, -kLeg.shank_length_m}};

}  // namespace

TEST_CASE("A point moves as its Jacobian says, and its drift is the Jacobian's change") {
  Random r(31);
  for (int k = 0; k < 30; ++k) {
    const auto m = random_tree<10>(r, 1 + r.up_to(8));
    const Foothold<double> point{r.below(static_cast<int>(m.count())), r.vector(0.4)};
    const Joints q = random_joints(r, m, 1.5), v = random_joints(r, m, 2.0);
    const auto here = point_motion(m, point, q, v);
    const double h = 1e-5;
    Joints after = q, before = q;
    for (std::size_t i = 0; i < m.count(); ++i) after[i] += h * v[i], before[i] -= h * v[i];
    const auto next = point_motion(m, point, after, v), last = point_motion(m, point, before, v);
    const Vec3<double> velocity = (next.place_m - last.place_m) * (0.5 / h),
                       drift = (next.times(v, m.count()) - last.times(v, m.count())) * (0.5 / h);
    const Vec3<double> off = velocity - here.times(v, m.count()), wrong = drift - here.drift_mps2;
    CHECK(std::sqrt(dot(off, off)) < 1e-7);
    CHECK(std::sqrt(dot(wrong, wrong)) < 1e-6);
  }
}

TEST_CASE(
    "A standing foot's accelerations are the nearest to the free ones by the mass matrix, held joints too") {
  Random r(32);
  for (int k = 0; k < 40; ++k) {
    auto m = random_tree<10>(r, 3 + r.up_to(6));
    const std::size_t n = m.count();
    m.foothold = {static_cast<int>(n) - 1, r.vector(0.4)};
    Joints q = random_joints(r, m, 1.5), v = random_joints(r, m, 2.0);
    const Joints tau = random_joints(r, m, 5.0);
    Tree::Flags held{};
    if (k % 2 == 1) held[0] = true, v[0] = 0.0;
    Accelerations<Tree> out;
    forward_dynamics(m, q, v, tau, held, out);
    const Accelerations<Tree> free = out;
    const Vec3<double> force = stand(m, q, v, held, out);
    const auto point = point_motion(m, m.foothold, q, v);
    // Gauss: minimise (a - free)' M (a - free) over those a that keep the point still, as one linear system.
    const auto mass = mass_matrix(m, q);
    const auto size = static_cast<Eigen::Index>(n);
    Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(size + 3, size + 3);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(size + 3);
    const auto p = [](const Vec3<double>& x, Eigen::Index d) { return d == 0 ? x.x : d == 1 ? x.y : x.z; };
    for (std::size_t i = 0; i < n; ++i) {
      const auto a = static_cast<Eigen::Index>(i);
      for (std::size_t j = 0; j < n; ++j)
        if (!held[i] && !held[j]) {
          kkt(a, static_cast<Eigen::Index>(j)) = mass[i][j];
          right(a) += mass[i][j] * free.joint_radps2[j];
        }
      if (held[i]) kkt(a, a) = 1.0;
      for (Eigen::Index d = 0; d < 3 && !held[i]; ++d)
        kkt(a, size + d) = kkt(size + d, a) = p(point.by_joint[i], d);
    }
    for (Eigen::Index d = 0; d < 3; ++d) right(size + d) = -p(point.drift_mps2, d);
    const Eigen::VectorXd best = kkt.completeOrthogonalDecomposition().solve(right);
    if ((kkt * best - right).norm() > 1e-9) continue;  // the point cannot be kept still with that joint held
    for (std::size_t i = 0; i < n; ++i)
      CHECK(out.joint_radps2[i] ==
            Approx(held[i] ? 0.0 : best(static_cast<Eigen::Index>(i))).epsilon(1e-6).margin(1e-7));
    // What holds the joint, by the equations of motion turned round: with it and the ground's force, all is in balance.
    const auto needed = inverse_dynamics(m, q, v, out.joint_radps2);
    for (std::size_t i = 0; i < n; ++i) {
      const double ground = dot(point.by_joint[i], force);
      if (held[i])
        CHECK(out.holding_nm[i] == Approx(needed[i] - tau[i] - ground).epsilon(1e-6).margin(1e-6));
      else
        CHECK(needed[i] == Approx(tau[i] + ground).epsilon(1e-6).margin(1e-6));
    }
  }
}

TEST_CASE("The planar leg on its toe, and its touch-down, are those of its own equations") {
  Random r(33);
  Tree m = planar_leg();
  const dynamics::LegEquations<double> leg(kLeg);
  for (int k = 0; k < 50; ++k) {
    const Joints q{r.within(-1, 1), r.within(0.3, 0.8), r.within(-1.2, 1.2), r.within(0.0, 2.2)};
    Joints v{r.within(-2, 2), r.within(-2, 2), r.within(-6, 6), r.within(-6, 6)};
    const Joints tau{0, 0, r.within(-30, 30), r.within(-30, 30)};
    const auto pose = leg.pose({q[2], q[3]});
    m.foothold = {};
    Accelerations<Tree> a;
    forward_dynamics(m, q, v, tau, Tree::Flags{}, a);
    const auto flight = leg.in_flight(pose, {v[2], v[3]}, {tau[2], tau[3]});
    CHECK(a.joint_radps2[0] == Approx(flight.hip_acceleration.x).epsilon(1e-9).margin(1e-9));
    CHECK(a.joint_radps2[3] == Approx(flight.acceleration.knee).epsilon(1e-9).margin(1e-9));

    m.foothold = kToe;
    Joints after = v;
    const Vec3<double> impulse = stop_foot(m, q, after);
    const auto impact = leg.impact(pose, {v[0], v[1]}, {v[2], v[3]});
    CHECK(after[0] == Approx(impact.hip_velocity.x).epsilon(1e-8).margin(1e-9));
    CHECK(after[2] == Approx(impact.rate.hip).epsilon(1e-8).margin(1e-9));
    CHECK(after[3] == Approx(impact.rate.knee).epsilon(1e-8).margin(1e-9));
    CHECK(impulse.z == Approx(impact.impulse.y).epsilon(1e-8).margin(1e-9));

    forward_dynamics(m, q, after, tau, Tree::Flags{}, a);
    const Vec3<double> force = stand(m, q, after, Tree::Flags{}, a);
    const auto stance = leg.in_stance(pose, {after[2], after[3]}, {tau[2], tau[3]});
    CHECK(a.joint_radps2[1] == Approx(stance.hip_acceleration.y).epsilon(1e-8).margin(1e-8));
    CHECK(a.joint_radps2[2] == Approx(stance.acceleration.hip).epsilon(1e-8).margin(1e-8));
    CHECK(a.joint_radps2[3] == Approx(stance.acceleration.knee).epsilon(1e-8).margin(1e-8));
    CHECK(force.x == Approx(stance.ground_force.x).epsilon(1e-8).margin(1e-8));
    CHECK(force.z == Approx(stance.ground_force.y).epsilon(1e-8).margin(1e-8));
  }
}

TEST_CASE(
    "A stance keeps its toe and, without losses, its energy, a one-way spring is slack below its rest") {
  Tree m = planar_leg();
  for (auto& law : m.laws) law.damping_nmspr = 0.0;
  m.laws[3].one_way_nmprad = kLeg.stiffness_nmprad;
  m.laws[3].one_way_rest_rad = 1.3;
  CHECK(passive_torque(m.laws[3], 1.2, 0.0) == 0.0);
  CHECK(passive_torque(m.laws[3], 1.5, 0.0) == Approx(0.2 * kLeg.stiffness_nmprad));
  m.foothold = kToe;
  Plant<double, Shape> plant(m, 1e-3);
  plant.reset({0.0, 0.5, -0.6, 1.3}, {0.0, 0.0, 0.3, 2.0});
  const double before = plant.energy_j();
  const Vec3<double> toe = point_motion(m, kToe, plant.positions(), plant.velocities()).place_m;
  double lowest = plant.positions()[3], highest = lowest;
  for (int k = 0; k < 200; ++k) {
    plant.advance({}, 1e-3);
    lowest = std::min(lowest, plant.positions()[3]);
    highest = std::max(highest, plant.positions()[3]);
  }
  CHECK(highest > 1.35);
  const Vec3<double> off = point_motion(m, kToe, plant.positions(), plant.velocities()).place_m - toe;
  CHECK(std::sqrt(dot(off, off)) < 1e-7);
  CHECK(plant.energy_j() == Approx(before).margin(1e-5));
}

TEST_CASE("A stiff unilateral spring shortens the integrator's step as a two-sided one does") {
  Tree m = planar_leg();
  for (auto& law : m.laws) law.damping_nmspr = 0.0;
  m.laws[3].one_way_nmprad = 1e5;
  m.laws[3].one_way_rest_rad = 1.3;
  m.foothold = kToe;
  Plant<double, Shape> plant(m, 1e-2);
  plant.reset({0.0, 0.5, -0.6, 1.4}, {0.0, 0.0, 0.0, 0.0});
  const double before = plant.energy_j();
  plant.advance({}, 2e-3);
  CHECK(plant.energy_j() == Approx(before).epsilon(0.01));
}
