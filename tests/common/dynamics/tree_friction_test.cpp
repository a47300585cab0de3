// Dry friction at several joints: the conditions of sticking and sliding, exactly, and when they change.
#include <catch2/catch.hpp>

#include "furcula/dynamics/tree/plant.hpp"
#include "host/identify/dual.hpp"
#include "tests/common/dynamics/tree_examples.hpp"

using namespace furcula;
using namespace furcula::test;

namespace {

using Shape = DynamicTopology<8>;
using Tree = Model<double, Shape>;
using Joints = Tree::Joints;

/// Two blocks, the second on the first, both along x; and a torque that pulls the first.
template <class T>
Model<T, Shape> blocks(const T& m1, const T& m2, const T& friction1, const T& friction2) {
  Model<T, Shape> m;
  const auto block = [](const T& mass) {
    return inertia_of(mass, Vec3<T>{T(0.0), T(0.0), T(0.0)},
                      Sym3<T>{T(1.0), T(0.0), T(0.0), T(1.0), T(0.0), T(1.0)});
  };
  add(m, -1, JointKind::prismatic, at(0, 0, 0), {1, 0, 0}, block(m1));
  add(m, 0, JointKind::prismatic, at(0, 0, 0.1), {1, 0, 0}, block(m2));
  m.laws[0].friction_nm = friction1;
  m.laws[1].friction_nm = friction2;
  return m;
}

}  // namespace

TEST_CASE("What settles keeps the conditions of dry friction on random trees") {
  Random r(21);
  int most_rounds = 0, held = 0, moving = 0;
  for (int n = 0; n < 3000; ++n) {
    auto m = random_tree<8>(r, r.up_to(8));
    const bool more_at_rest = n % 2 == 0;
    Joints q = random_joints(r, m, 3), w = random_joints(r, m, 2);
    for (std::size_t i = 0; i < m.count(); ++i) {
      m.laws[i].friction_nm = r.within(0.0, 4.0);
      m.laws[i].static_friction_nm = more_at_rest ? 1.3 * m.laws[i].friction_nm : 0.0;
      if (r.below(4) != 0) w[i] = 0.0;
    }
    FrictionMode<8> mode;
    Accelerations<Tree> out;
    const Joints tau = random_joints(r, m, 8);
    const int rounds = settle_friction(m, q, w, tau, mode, out);
    CAPTURE(n, m.count(), rounds);
    REQUIRE(rounds > 0);
    most_rounds = std::max(most_rounds, rounds);
    Joints total = tau;
    for (std::size_t i = 0; i < m.count(); ++i) {
      const auto& law = m.laws[i];
      const double s = mode.direction[i];
      total[i] += mode.held[i] ? out.holding_nm[i] : -s * law.friction_nm;
      if (mode.held[i]) {
        ++held;
        CHECK(w[i] == 0.0);
        CHECK(out.joint_radps2[i] == 0.0);
        CHECK(std::abs(out.holding_nm[i]) <= std::max(law.friction_nm, law.static_friction_nm));
      } else {
        ++moving;
        REQUIRE(s != 0.0);
        CHECK((w[i] != 0.0 ? s * w[i] > 0.0 : s * out.joint_radps2[i] >= 0.0));
      }
    }
    // By another algorithm: these torques, friction included, are those of these accelerations.
    const Joints inverse = inverse_dynamics(m, q, w, out.joint_radps2);
    for (std::size_t i = 0; i < m.count(); ++i)
      CHECK(inverse[i] == Approx(total[i]).epsilon(1e-7).margin(1e-7));
  }
  std::printf(
      "tree: dry friction settles, 3000 states of 1 to 8 joints: at most %d rounds; %d held, %d moving\n",
      most_rounds, held, moving);
  CHECK(held > 1000);
  CHECK(moving > 1000);
}

TEST_CASE("A joint that is held stays where it is, to the bit") {
  auto m = DoublePendulum<double>{}.model<Shape>();
  m.laws[0].friction_nm = 3.0;  // more than both bodies' weight and swing take
  Plant<double, Shape> plant(m);
  const double start = 0.3217;
  plant.reset({start, 0.4}, {0.0, 1.0});
  for (int n = 0; n < 2000; ++n) {
    plant.advance({}, 1e-3);
    REQUIRE(plant.positions()[0] == start);
    REQUIRE(plant.velocities()[0] == 0.0);
    REQUIRE(plant.held(0));
  }
  CHECK(plant.positions()[1] != 0.4);
}

TEST_CASE("Static friction holds what the friction of motion would not, until it is exceeded") {
  auto m = blocks(2.0, 1.0, 5.0, 50.0);
  m.laws[0].static_friction_nm = 6.0;
  Plant<double, Shape> plant(m);
  plant.reset({}, {});
  plant.advance({5.9, 0.0}, 0.1);
  CHECK(plant.held(0));
  CHECK(plant.positions()[0] == 0.0);
  plant.advance({6.1, 0.0}, 0.1);  // then it is 5 N that slows 3 kg
  CHECK(plant.velocities()[0] == Approx((6.1 - 5.0) / 3.0 * 0.1).epsilon(1e-12));
  plant.advance({5.5, 0.0}, 0.1);  // in motion it goes on
  CHECK(plant.velocities()[0] == Approx((1.1 + 0.5) / 3.0 * 0.1).epsilon(1e-12));
}

TEST_CASE("A sliding block stops after v^2 / 2a and stays there") {
  auto m = blocks(2.0, 1.0, 6.0, 50.0);
  Plant<double, Shape> plant(m);
  plant.reset({}, {0.9, 0.0});
  // Both move as one, 6 N on 3 kg.
  for (int n = 0; n < 100; ++n) plant.advance({}, 0.01);
  CHECK(plant.positions()[0] == Approx(0.9 * 0.9 / (2 * 2.0)).epsilon(1e-12));
  CHECK(plant.velocities()[0] == 0.0);
  CHECK(plant.positions()[1] == 0.0);
}

TEST_CASE("One block breaks free when the other does, and neither before") {
  const double m1 = 2.0, m2 = 1.0, f1 = 5.0, f2 = 0.8;
  const auto m = blocks(m1, m2, f1, f2);
  FrictionMode<8> mode;
  Accelerations<Tree> out;
  settle_friction(m, {}, {}, {4.99, 0.0}, mode, out);
  CHECK((mode.held[0] && mode.held[1]));
  CHECK(out.holding_nm[0] == Approx(-4.99));
  // A little more and the first goes; the second is carried, as long as m2 a < f2: below 5 + 3 * 0.8 = 7.4 N.
  settle_friction(m, {}, {}, {7.39, 0.0}, mode, out);
  CHECK((!mode.held[0] && mode.held[1]));
  CHECK(out.joint_radps2[0] == Approx((7.39 - f1) / (m1 + m2)));
  CHECK(out.holding_nm[1] == Approx((7.39 - f1) / (m1 + m2) * m2));
  settle_friction(m, {}, {}, {7.41, 0.0}, mode, out);
  CHECK((!mode.held[0] && !mode.held[1]));
  CHECK(mode.direction[1] == -1);
  CHECK(out.joint_radps2[0] == Approx((7.41 - f1 - f2) / m1));
  // In motion: from rest under 9 N for 0.2 s, then let go.
  Plant<double, Shape> plant(m);
  plant.reset({}, {});
  plant.advance({9.0, 0.0}, 0.2);
  const double a1 = (9.0 - f1 - f2) / m1, a2 = f2 / m2;
  CHECK(plant.velocities()[0] == Approx(a1 * 0.2).epsilon(1e-12));
  CHECK(plant.velocities()[0] + plant.velocities()[1] == Approx(a2 * 0.2).epsilon(1e-12));
  for (int n = 0; n < 200; ++n) plant.advance({}, 0.01);
  CHECK(plant.velocities()[0] == 0.0);
  CHECK(plant.velocities()[1] == 0.0);
}

TEST_CASE(
    "A pendulum's swing breaks its carriage free at the angle where the sideways pull is the friction") {
  // Held carriage: the pole swings as a simple pendulum; sideways pull m (c w^2 + g cos t) sin t with the energy's w^2.
  const double pole = 0.5, c = 0.4, g = 9.81, friction = 3.0, start = 1.4;
  Tree m;
  const Sym3<double> none{};
  add(m, -1, JointKind::prismatic, at(0, 0, 0), {1, 0, 0},
      inertia_of(1.0, Vec3<double>{0.0, 0.0, 0.0}, none));
  add(m, 0, JointKind::revolute, at(0, 0, 0), {0, -1, 0}, inertia_of(pole, Vec3<double>{0.0, 0.0, -c}, none));
  m.laws[0].friction_nm = friction;
  Plant<double, Shape> plant(m, 1e-3);
  plant.reset({0.0, start}, {});
  double angle_before = start;
  while (plant.held(0) || plant.positions()[1] == start) {
    angle_before = plant.positions()[1];
    plant.advance({}, 1e-4);
    REQUIRE(plant.positions()[1] > 0.5);
  }
  const auto pull = [&](double t) {
    return pole * g * (3 * std::cos(t) - 2 * std::cos(start)) * std::sin(t);
  };
  CHECK(pull(angle_before) < friction);
  CHECK(pull(plant.positions()[1]) > friction);
  CHECK(plant.changes() == 1);
  CHECK(plant.positions()[0] >
        0.0);  // dragged after the pole's centre of mass, at positive angles to the right
}

TEST_CASE(
    "Without torque the energy of random trees in friction only falls, and changes of mode do not pile up") {
  Random r(22);
  int changes = 0, most = 0, at_rest = 0, joints = 0;
  for (int n = 0; n < 40; ++n) {
    auto m = random_tree<8>(r, r.up_to(6));
    for (std::size_t i = 0; i < m.count(); ++i) {
      m.laws[i].friction_nm = r.within(0.0, 3.0);
      m.laws[i].static_friction_nm = n % 2 == 0 ? 0.0 : 1.2 * m.laws[i].friction_nm;
    }
    Plant<double, Shape> plant(m, 1e-3);
    plant.reset(random_joints(r, m, 2), random_joints(r, m, 2));
    double energy = plant.energy_j(), gained = 0.0;
    for (int k = 0; k < 2000; ++k) {
      plant.advance({}, 1e-3);
      gained = std::max(gained, plant.energy_j() - energy);
      energy = plant.energy_j();
      changes += plant.changes();
      most = std::max(most, plant.changes());
    }
    CAPTURE(n, m.count());
    CHECK(gained < 1e-7);
    CHECK(std::isfinite(energy));
    for (std::size_t i = 0; i < m.count(); ++i, ++joints) at_rest += plant.held(i) ? 1 : 0;
  }
  std::printf(
      "tree: 40 trees in friction for 2 s: %d changes of mode, at most %d in 1 ms; %d of %d joints at rest at the end\n",
      changes, most, at_rest, joints);
  CHECK(changes > 100);
  CHECK(most < 10);
}

TEST_CASE("Friction takes what energy is lost, and nothing else does") {
  auto m = DoublePendulum<double>{}.model<Shape>();
  m.laws[0].friction_nm = 0.05;
  m.laws[1].friction_nm = 0.03;
  m.laws[1].static_friction_nm = 0.04;
  Plant<double, Shape> plant(m, 1e-4);
  plant.reset({1.5, 0.5}, {});
  const double before = plant.energy_j();
  double lost = 0.0;
  int changes = 0;
  for (int n = 0; n < 30000; ++n) {
    const Joints q = plant.positions();
    plant.advance({}, 1e-4);
    changes += plant.changes();
    // A turn inside the step moves back and forth by less than acceleration times the step's square.
    for (std::size_t i = 0; i < 2; ++i) lost += m.laws[i].friction_nm * std::abs(plant.positions()[i] - q[i]);
  }
  CHECK(changes > 10);
  CHECK(plant.energy_j() == Approx(before - lost).margin(2e-6));
  for (int n = 0; n < 30000; ++n) plant.advance({}, 1e-3);
  CHECK((plant.held(0) && plant.held(1)));
  // At rest within what friction holds: g1 and g2 below friction.
  const Joints gravity = bias_forces(m, plant.positions(), {});
  CHECK(std::abs(gravity[0]) <= 0.05);
  CHECK(std::abs(gravity[1]) <= 0.04);
}

namespace {

/// Angles after 1.5 s of a driven double pendulum that stops, is held and breaks free again.
template <class T>
std::array<T, 2> after_stick_slip(const T (&x)[5], int* changes = nullptr) {
  DoublePendulum<T> p;
  p.m2 = x[0];
  auto m = p.template model<StaticTopology<kTwoInSeries>>();
  m.laws[0].friction_nm = x[1];
  m.laws[1].friction_nm = x[2];
  m.laws[1].static_friction_nm = x[2] * 1.2;
  m.laws[0].armature_kgm2 = x[3];
  m.laws[1].damping_nmspr = x[4];
  Plant<T, StaticTopology<kTwoInSeries>> plant(m, 2e-3);
  plant.reset({T(0.8), T(-0.3)}, {T(0.0), T(0.0)});
  for (int n = 0; n < 300; ++n) {
    plant.advance({T(0.4 * std::sin(0.03 * n)), T(0.3 * std::cos(0.05 * n))}, 5e-3);
    if (changes != nullptr) *changes += plant.changes();
  }
  return plant.positions();
}

}  // namespace

TEST_CASE("Derivatives pass through sticking and breaking free as differences do") {
  using Dual = identify::Dual<6>;
  const double v[5] = {0.4, 0.25, 0.12, 0.01, 0.01};
  const Dual d[5] = {{v[0], 0}, {v[1], 1}, {v[2], 2}, {v[3], 3}, {v[4], 4}};
  int changes = 0;
  const auto plain = after_stick_slip(v, &changes);
  const auto dual = after_stick_slip(d);
  CHECK(changes >= 6);
  CHECK(dual[0].a == Approx(plain[0]).epsilon(1e-12));
  for (int i = 0; i < 5; ++i) {
    double up[5], down[5];
    for (int k = 0; k < 5; ++k) up[k] = down[k] = v[k];
    up[i] += 1e-6;
    down[i] -= 1e-6;
    const auto a = after_stick_slip(up), b = after_stick_slip(down);
    for (std::size_t k = 0; k < 2; ++k) {
      CAPTURE(i, k);
      CHECK(dual[k].derivative(static_cast<std::size_t>(i)) ==
            Approx((a[k] - b[k]) / 2e-6).epsilon(1e-4).margin(1e-5));
    }
  }
}

TEST_CASE("Both of two equal blocks that stop at once stop") {
  Tree m;
  m.gravity_mps2 = {0.0, 0.0, 0.0};
  const auto body = inertia_of(1.0, Vec3<double>{0.0, 0.0, 0.0}, Sym3<double>{1, 0, 0, 1, 0, 1});
  for (int i = 0; i < 2; ++i) {
    add(m, -1, JointKind::prismatic, at(0, i, 0), {1, 0, 0}, body);
    m.laws[static_cast<std::size_t>(i)].friction_nm = 1.0;
  }
  Plant<double, Shape> plant(m, 0.01);
  plant.reset({}, {0.1, 0.1});
  plant.advance({}, 1.0);
  CHECK(plant.positions()[0] == Approx(0.005).epsilon(1e-12));
  CHECK(plant.positions()[1] == Approx(0.005).epsilon(1e-12));
  CHECK((plant.held(0) && plant.held(1)));
}

TEST_CASE("In float a block stops, stays and sets out as in double") {
  const Model<float, Shape> m(blocks(2.0, 1.0, 6.0, 50.0));
  Plant<float, Shape> plant(m, 2e-3F);
  plant.reset({}, {0.9F, 0.0F});
  for (int n = 0; n < 500; ++n) plant.advance({}, 1e-3F);
  const float stopped = plant.positions()[0];
  CHECK(stopped == Approx(0.9 * 0.9 / 4.0).epsilon(1e-5));
  for (int n = 0; n < 500; ++n) plant.advance({5.9F, 0.0F}, 1e-3F);
  CHECK(plant.positions()[0] == stopped);
  for (int n = 0; n < 500; ++n) plant.advance({9.0F, 0.0F}, 1e-3F);
  CHECK(plant.positions()[0] - stopped == Approx(0.5 * 1.0 * 0.25).epsilon(1e-4));
}

TEST_CASE("A joint behind an elastic drive is held while the spring winds up to its friction") {
  // Torque ramps the rotor against the spring; the body of 0.5 kg m^2 is held by 2 N m.
  Tree m;
  m.gravity_mps2 = {0.0, 0.0, 0.0};
  add(m, -1, JointKind::revolute, at(0, 0, 0), {0, 0, 1},
      inertia_of(1.0, Vec3<double>{0.0, 0.0, 0.0}, {0.5, 0, 0, 0.5, 0, 0.5}));
  m.laws[0] = {.armature_kgm2 = 0.01, .friction_nm = 2.0, .elastic = true, .drive_stiffness_nmprad = 100.0};
  Plant<double, Shape> plant(m);
  plant.reset({0.0}, {0.0});
  // Under 0.9 N m the rotor swings about 9 mrad up to 18 mrad, 1.8 N m: never enough.
  for (int n = 0; n < 300; ++n) plant.advance({0.9}, 1e-3);
  CHECK(plant.held(0));
  CHECK(plant.positions()[0] == 0.0);
  // From relaxed, under 1.5 N m, it reaches 20 mrad after (1 - cos(w t)) 15 mrad = 20 mrad, w = 100 rad/s.
  plant.reset({0.0}, {0.0});
  const double free_at = std::acos(1.0 - 20.0 / 15.0) / 100.0;
  plant.advance({1.5}, free_at - 1e-6);
  CHECK(plant.held(0));
  plant.advance({1.5}, 2e-6);
  CHECK_FALSE(plant.held(0));
}
