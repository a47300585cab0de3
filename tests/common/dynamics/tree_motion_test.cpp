// Trees in motion: what is conserved, with what order, and drives with springs in closed form.
#include <catch2/catch.hpp>

#include "furcula/dynamics/tree/plant.hpp"
#include "tests/common/dynamics/tree_examples.hpp"

using namespace furcula;
using namespace furcula::test;

namespace {

using Shape = DynamicTopology<10>;
using Tree = Model<double, Shape>;
using Joints = Tree::Joints;

constexpr double kPi = 3.14159265358979323846;

/// One body on a prismatic joint along x, or a revolute one about it, without gravity.
Tree one_joint(JointKind kind, double inertia) {
  Tree m;
  m.gravity_mps2 = {0.0, 0.0, 0.0};
  add(m, -1, kind, at(0, 0, 0), {1, 0, 0},
      inertia_of(inertia, Vec3<double>{0.0, 0.0, 0.0}, {inertia, 0, 0, 1, 0, 1}));
  return m;
}

}  // namespace

TEST_CASE("Energy is kept with an error of the fourth order in the step") {
  Random r(11);
  auto m = random_tree<10>(r, 5);
  for (auto& law : m.laws) law.damping_nmspr = 0.0;
  const Joints q = random_joints(r, m, 1), w = random_joints(r, m, 2);
  double drift[3];
  for (int k = 0; k < 3; ++k) {
    const double step = 4e-3 / (1 << k);
    Plant<double, Shape> plant(m, step);
    plant.reset(q, w);
    const double before = plant.energy_j();
    for (int n = 0; n < 250 << k; ++n) plant.advance({}, step);
    drift[k] = std::abs(plant.energy_j() - before);
  }
  std::printf("tree: energy drift in 1 s at 4, 2, 1 ms: %.2e %.2e %.2e J\n", drift[0], drift[1], drift[2]);
  // Halved steps: at least 2^4 = 16 times less (the drift of the energy is often of the fifth order), rounding aside.
  CHECK(drift[0] / drift[1] > 13.0);
  CHECK(drift[1] / drift[2] > 13.0);
  CHECK(drift[2] < 1e-6);
}

TEST_CASE("A free base of six joints keeps its momentum, and falls as a stone does") {
  Random r(12);
  Tree m;
  m.gravity_mps2 = {0.0, 0.0, 0.0};
  const Inertia<double> none{};
  const Vec3<double> axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 3; ++i) add(m, i - 1, JointKind::prismatic, at(0, 0, 0), axes[i], none);
  for (int i = 0; i < 3; ++i)
    add(m, i + 2, JointKind::revolute, at(0, 0, 0), axes[i], i == 2 ? r.body() : none);
  for (int i = 0; i < 2; ++i)
    add(m, 5 + i, JointKind::revolute, {r.turn(), r.vector(0.4)}, r.vector(1), r.body());
  Plant<double, Shape> plant(m, 5e-4);
  const Joints q{0, 0, 0, 0.1, 0.2, -0.1, 0.5, 0.3}, w{0.3, -0.2, 0.1, 0.5, -0.7, 0.4, 2.0, -3.0};
  plant.reset(q, w);
  const auto before = momentum(m, plant.positions(), plant.velocities());
  for (int n = 0; n < 400; ++n) plant.advance({0, 0, 0, 0, 0, 0, 0.2, -0.1}, 1e-3);
  const auto after = momentum(m, plant.positions(), plant.velocities());
  CHECK(dot(before.n, before.n) > 0.01);
  CHECK(std::abs(after.n.x - before.n.x) < 1e-9);
  CHECK(std::abs(after.n.y - before.n.y) < 1e-9);
  CHECK(std::abs(after.n.z - before.n.z) < 1e-9);
  CHECK(std::abs(after.f.x - before.f.x) < 1e-9);
  CHECK(std::abs(after.f.z - before.f.z) < 1e-9);

  m.gravity_mps2 = {0.0, 0.0, -9.81};
  Plant<double, Shape> stone(m, 5e-4);
  stone.reset(q, w);
  for (int n = 0; n < 400; ++n) stone.advance({}, 1e-3);
  double mass = 0.0;
  for (std::size_t i = 0; i < m.count(); ++i) mass += m.body(i).mass_kg;
  CHECK(momentum(m, stone.positions(), stone.velocities()).f.z ==
        Approx(before.f.z - mass * 9.81 * 0.4).epsilon(1e-9));
}

TEST_CASE("A damped spring at a joint swings as its closed form says") {
  auto m = one_joint(JointKind::revolute, 0.02);
  m.laws[0] = {.armature_kgm2 = 0.03, .damping_nmspr = 0.1, .stiffness_nmprad = 5.0, .rest_rad = 0.2};
  Plant<double, Shape> plant(m);
  plant.reset({0.7}, {});
  for (int n = 0; n < 500; ++n) plant.advance({}, 1e-3);
  const double delta = 0.1 / (2 * 0.05), omega = std::sqrt(5.0 / 0.05 - delta * delta), t = 0.5;
  const double expected =
      0.2 + 0.5 * std::exp(-delta * t) * (std::cos(omega * t) + delta / omega * std::sin(omega * t));
  CHECK(plant.positions()[0] == Approx(expected).epsilon(1e-9));
}

TEST_CASE("An elastic drive swings against its joint at the frequency of two inertias on a spring") {
  const double rotor = 0.01, link = 0.04, stiffness = 50.0;
  auto m = one_joint(JointKind::revolute, link);
  m.laws[0] = {.armature_kgm2 = rotor, .elastic = true, .drive_stiffness_nmprad = stiffness};
  Plant<double, Shape> plant(m);
  plant.reset({0.0}, {0.0});
  plant.place_rotor(0, 0.1, 0.0);
  const double energy = plant.energy_j();
  CHECK(energy == Approx(0.5 * stiffness * 0.01));
  const double period = 2 * kPi / std::sqrt(stiffness * (1 / rotor + 1 / link));
  for (int n = 0; n < 100; ++n) plant.advance({}, period / 100);
  CHECK(plant.rotor_angle(0) == Approx(0.1).epsilon(1e-6));
  CHECK(std::abs(plant.positions()[0]) < 1e-6);
  for (int n = 0; n < 50; ++n) plant.advance({}, period / 100);
  // Half a period later both are mirrored at the centre of inertia, 0.1 rotor / (rotor + link).
  CHECK(plant.positions()[0] == Approx(2 * 0.1 * rotor / (rotor + link)).epsilon(1e-6));
  CHECK(plant.energy_j() == Approx(energy).epsilon(2e-7));
}

TEST_CASE("A stiff elastic drive moves as a rigid one does, in steps that stay stable") {
  auto rigid = one_joint(JointKind::prismatic, 2.0);
  rigid.laws[0].armature_kgm2 = 0.5;
  auto stiff = rigid;
  stiff.laws[0].elastic = true;
  stiff.laws[0].drive_stiffness_nmprad = 1e7;
  stiff.laws[0].drive_damping_nmspr = 1e3;
  Plant<double, Shape> a(rigid), b(stiff);
  a.reset({}, {});
  b.reset({}, {});
  for (int n = 0; n < 200; ++n) {
    a.advance({3.0}, 1e-3);
    b.advance({3.0}, 1e-3);
  }
  CHECK(a.positions()[0] == Approx(0.5 * 3.0 / 2.5 * 0.04).epsilon(1e-12));
  CHECK(b.positions()[0] == Approx(a.positions()[0]).epsilon(1e-4));
}

TEST_CASE("A slanted gravity is a vector like any other") {
  Tree m = one_joint(JointKind::prismatic, 3.0);
  m.gravity_mps2 = {9.81 * std::sin(0.1), 0.0, -9.81 * std::cos(0.1)};
  Plant<double, Shape> plant(m);
  plant.reset({}, {});
  for (int n = 0; n < 100; ++n) plant.advance({}, 0.01);
  CHECK(plant.positions()[0] == Approx(0.5 * 9.81 * std::sin(0.1)).epsilon(1e-12));
}
