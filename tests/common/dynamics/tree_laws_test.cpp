// What acts in a joint besides damping, springs and Coulomb friction, against closed forms.
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

constexpr double kInertia = 0.5;  // kg m^2

/// A disc on an axis through its centre; gravity does nothing to it.
template <class T = double>
Model<T, Shape> rotor(const JointLaw<T>& law) {
  Model<T, Shape> m;
  add(m, -1, JointKind::revolute, at(0, 0, 0), {0, 0, 1},
      inertia_of(T(1.0), Vec3<T>{T(0.0), T(0.0), T(0.0)},
                 Sym3<T>{T(kInertia), T(0.0), T(0.0), T(kInertia), T(0.0), T(kInertia)}));
  m.laws[0] = law;
  return m;
}

}  // namespace

TEST_CASE("Drag slows a rotor as v0 / (1 + c v0 t / J), both ways") {
  const double drag = 0.2, v0 = 3.0, t = 2.0;
  for (const double way : {1.0, -1.0}) {
    Plant<double, Shape> plant(rotor({.drag_nms2prad2 = drag}), 1e-2);
    plant.reset({}, {way * v0});
    plant.advance({}, t);
    CHECK(plant.velocities()[0] == Approx(way * v0 / (1.0 + drag * v0 * t / kInertia)).epsilon(1e-8));
    CHECK(plant.positions()[0] ==
          Approx(way * kInertia / drag * std::log(1.0 + drag * v0 * t / kInertia)).epsilon(1e-8));
  }
}

TEST_CASE("A rotor coasts J v^2 / 2F, with another F forth than back") {
  const double forth = 0.8, back = 0.3, v0 = 1.5;
  for (const double way : {1.0, -1.0}) {
    Plant<double, Shape> plant(rotor({.friction_nm = forth, .friction_back_nm = back, .asymmetric = true}),
                               1e-2);
    plant.reset({}, {way * v0});
    plant.advance({}, 5.0);
    CHECK(plant.held(0));
    CHECK(plant.positions()[0] ==
          Approx(way * kInertia * v0 * v0 / (2.0 * (way > 0 ? forth : back))).epsilon(1e-12));
    // At rest it takes as much to set out.
    const double stopped = plant.positions()[0];
    plant.advance({0.999 * forth}, 0.1);
    plant.advance({-0.999 * back}, 0.1);
    CHECK(plant.positions()[0] == stopped);
    plant.advance({-1.5 * back}, 0.1);
    CHECK(plant.velocities()[0] == Approx(-0.5 * back / kInertia * 0.1));
  }
}

TEST_CASE("Friction of the load takes its share of the drive's torque") {
  const double ratio = 0.2, torque = 0.7;
  Plant<double, Shape> plant(rotor({.load_friction_ratio = ratio}), 1e-2);
  plant.reset({}, {});
  plant.advance({torque}, 0.5);  // sets out against its own friction
  CHECK(plant.velocities()[0] == Approx((1.0 - ratio) * torque / kInertia * 0.5).epsilon(1e-12));
  plant.advance({}, 0.5);  // no torque, no friction
  CHECK(plant.velocities()[0] == Approx((1.0 - ratio) * torque / kInertia * 0.5).epsilon(1e-12));
  plant.advance({-torque}, 0.2);  // brakes with the drive
  CHECK(plant.velocities()[0] ==
        Approx(torque / kInertia * ((1.0 - ratio) * 0.5 - (1.0 + ratio) * 0.2)).epsilon(1e-12));
}

TEST_CASE("Friction of the load holds a pendulum that its drive balances within that share") {
  const double mass = 0.8, centre = 0.4, ratio = 0.1, torque = 2.0;
  Tree m;
  add(m, -1, JointKind::revolute, at(0, 0, 0), {0, -1, 0},
      inertia_of(mass, Vec3<double>{0.0, 0.0, -centre}, Sym3<double>{}));
  m.laws[0].load_friction_ratio = ratio;
  const auto settled = [&](double weight, double drive) {  // torques, both of the same sense
    FrictionMode<8> mode;
    Accelerations<Tree> out;
    const Joints q{std::asin(weight / (mass * 9.81 * centre))};
    REQUIRE(settle_friction(m, q, {}, {drive}, mode, out) > 0);
    CHECK((mode.held[0] || mode.direction[0] * out.joint_radps2[0] > 0.0));
    return mode.held[0] ? 0.0 : out.joint_radps2[0] * mass * centre * centre;
  };
  for (const double way : {1.0, -1.0}) {
    CAPTURE(way);
    CHECK(settled(way * 1.801, way * torque) == 0.0);
    CHECK(settled(way * 2.199, way * torque) == 0.0);
    CHECK(settled(way * 1.7, way * torque) == Approx(way * (2.0 - 1.7 - 0.2)));
    CHECK(settled(way * 2.4, way * torque) == Approx(way * (2.0 - 2.4 + 0.2)));
    CHECK(settled(way * 0.3, 0.0) == Approx(way * -0.3));  // without torque nothing holds
  }
}

TEST_CASE("Friction of an elastic drive's load is a share of its spring's torque") {
  const double stiffness = 50.0, ratio = 0.25, wound = 0.02;
  auto m = rotor({.armature_kgm2 = 1e6,
                  .elastic = true,
                  .drive_stiffness_nmprad = stiffness,
                  .load_friction_ratio = ratio});
  Plant<double, Shape> plant(m, 1e-4);
  plant.reset({}, {});
  plant.place_rotor(0, wound, 0.0);
  // The body swings towards the rotor, which hardly moves: a quarter period of K (1 - r), then of K (1 + r).
  const double there = 0.5 * M_PI * std::sqrt(kInertia / (stiffness * (1.0 - ratio)));
  plant.advance({}, there);
  const double fastest = wound * std::sqrt((1.0 - ratio) * stiffness / kInertia);
  CHECK(plant.positions()[0] == Approx(wound).epsilon(1e-6));
  CHECK(plant.velocities()[0] == Approx(fastest).epsilon(1e-6));
  plant.advance({}, 0.5 * M_PI * std::sqrt(kInertia / (stiffness * (1.0 + ratio))));
  CHECK(plant.positions()[0] - wound ==
        Approx(wound * std::sqrt((1.0 - ratio) / (1.0 + ratio))).epsilon(1e-4));
}

TEST_CASE("Friction of the load grows with the torque of a drive's spring that starts relaxed") {
  // At first there is neither friction nor acceleration. With x the spring's angle and s = K x, never negative:
  // x'' = tau / A - K x (1 / A + (1 - r) / J) and J q'' = (1 - r) K x, in one long advance.
  const double stiffness = 20.0, ratio = 0.25, armature = 0.01, torque = 0.5, t = 0.5;
  Plant<double, Shape> plant(rotor({.armature_kgm2 = armature,
                                    .elastic = true,
                                    .drive_stiffness_nmprad = stiffness,
                                    .load_friction_ratio = ratio}),
                             1e-4);
  plant.reset({}, {});
  plant.advance({torque}, t);
  const double w2 = stiffness * (1.0 / armature + (1.0 - ratio) / kInertia), w = std::sqrt(w2);
  const double mean = (1.0 - ratio) * stiffness * torque / (kInertia * armature * w2);
  CHECK(plant.positions()[0] == Approx(mean * (t * t / 2 - (1.0 - std::cos(w * t)) / w2)).epsilon(1e-8));
}

namespace {

constexpr double kCoulomb = 0.4, kStatic = 1.0, kStribeck = 0.2;

double stribeck_curve(double speed) {
  return kCoulomb + (kStatic - kCoulomb) * std::exp(-speed * speed / (kStribeck * kStribeck));
}
/// Simpson's rule over [from, to] in steps of 1e-5 of it.
template <class F>
double integral(double from, double to, const F& f) {
  constexpr int kSteps = 100000;
  const double h = (to - from) / kSteps;
  double sum = f(from) + f(to);
  for (int i = 1; i < kSteps; ++i) sum += f(from + h * i) * (i % 2 == 1 ? 4.0 : 2.0);
  return sum * h / 3.0;
}

const JointLaw<double> kStribeckLaw{
    .friction_nm = kCoulomb, .static_friction_nm = kStatic, .stribeck_velocity_radps = kStribeck};

}  // namespace

TEST_CASE(
    "With a Stribeck curve a rotor breaks free at the static friction and then speeds up along the curve") {
  Plant<double, Shape> plant(rotor(kStribeckLaw), 1e-3);
  plant.reset({}, {});
  const double rise = 0.05, dt = 1e-3;  // N m/s
  double torque = 0.9;
  for (int n = 0; plant.held(0) || n == 0; ++n) {
    torque = 0.9 + rise * dt * n;
    plant.advance({torque}, dt);
    REQUIRE(torque < 1.1);
  }
  CHECK(torque > kStatic);
  CHECK(torque <= kStatic + rise * dt * 1.001);
  // At a torque that stays, from rest: t = J int dv / (tau - F(v)).
  plant.reset({}, {});
  plant.advance({1.2}, 0.4);
  const double v = plant.velocities()[0];
  const double time = integral(0.0, v, [](double w) { return kInertia / (1.2 - stribeck_curve(w)); });
  CHECK(v > kStribeck);
  CHECK(time == Approx(0.4).epsilon(1e-8));
}

TEST_CASE("A rotor coasts along the Stribeck curve until it stops") {
  const double v0 = 0.9;
  const auto time_to = [&](double v) {
    return integral(v, v0, [](double w) { return kInertia / stribeck_curve(w); });
  };
  for (const double way : {1.0, -1.0}) {
    Plant<double, Shape> plant(rotor(kStribeckLaw), 1e-3);
    plant.reset({}, {way * v0});
    for (int third = 1; third <= 3; ++third) {
      plant.advance({}, 0.3);
      CHECK(time_to(way * plant.velocities()[0]) == Approx(0.3 * third).epsilon(1e-8));
    }
    const double stops_at = time_to(0.0);
    plant.advance({}, stops_at - 0.9 - 1e-6);
    CHECK_FALSE(plant.held(0));
    plant.advance({}, 2e-6);
    CHECK(plant.held(0));
    CHECK(plant.positions()[0] ==
          Approx(way * integral(0.0, v0, [](double w) { return kInertia * w / stribeck_curve(w); }))
              .epsilon(1e-8));
  }
}

TEST_CASE("A passage through a binding spot costs its friction times its width, however long the steps") {
  const double friction = 0.6, centre = 0.7, width = 0.3, v0 = 2.0;
  for (const double way : {1.0, -1.0})
    for (const double step : {1e-3, 1e-2, 0.4}) {  // the last passes the spot in one step
      CAPTURE(way, step);
      Plant<double, Shape> plant(rotor({.binding_friction_nm = friction,
                                        .binding_centre_rad = way * centre,
                                        .binding_width_rad = width}),
                                 step);
      plant.reset({}, {way * v0});
      plant.advance({}, 0.8);
      const double v1 = std::sqrt(v0 * v0 - 2.0 * friction * width / kInertia);
      CHECK(plant.velocities()[0] == Approx(way * v1).epsilon(1e-12));
      // Free, through the spot at the mean of both velocities, free.
      const double before = (centre - width / 2) / v0, within = width / (0.5 * (v0 + v1));
      CHECK(plant.positions()[0] ==
            Approx(way * (centre + width / 2 + v1 * (0.8 - before - within))).epsilon(1e-12));
      CHECK(plant.changes() == 2);
    }
}

TEST_CASE("A binding spot stops, holds and lets go, and outside of it nothing is held") {
  const double friction = 0.6, centre = 0.7, width = 0.3;
  Plant<double, Shape> plant(
      rotor({.binding_friction_nm = friction, .binding_centre_rad = centre, .binding_width_rad = width}));
  plant.reset({}, {0.5});
  plant.advance({}, 5.0);
  const double stopped = centre - width / 2 + kInertia * 0.25 / (2.0 * friction);
  CHECK(plant.held(0));
  CHECK(plant.positions()[0] == Approx(stopped).epsilon(1e-12));
  plant.advance({-0.59}, 1.0);
  CHECK(plant.held(0));
  // Out of the spot with 1 - 0.6 N m, then with all of it.
  plant.advance({-1.0}, 1.0);
  const double way = stopped - (centre - width / 2), a = 0.4 / kInertia;
  const double leaves = std::sqrt(2.0 * way / a);
  CHECK(plant.velocities()[0] == Approx(-a * leaves - 1.0 / kInertia * (1.0 - leaves)).epsilon(1e-12));
  // From rest outside, in one long advance: 0.01 N m sets out at once, and the spot stops it.
  plant.reset({0.5}, {});
  plant.advance({0.01}, 20.0);
  CHECK(plant.held(0));
  CHECK(plant.positions()[0] > centre - width / 2);
  CHECK(plant.positions()[0] == Approx(centre - width / 2 + 0.01 * 0.05 / (friction - 0.01)).epsilon(1e-10));
}

TEST_CASE("A joint that nothing moves yet meets the binding spot once its elastic drive has wound up") {
  // The rotor starts relaxed: at that moment the joint has neither friction nor acceleration.
  const double friction = 0.3;
  auto m = rotor({.armature_kgm2 = 0.01,
                  .elastic = true,
                  .drive_stiffness_nmprad = 20.0,
                  .binding_friction_nm = friction,
                  .binding_centre_rad = 0.2,
                  .binding_width_rad = 0.1});
  Plant<double, Shape> plant(m, 1e-4);
  plant.reset({}, {});
  plant.advance({0.5}, 1.5);
  CHECK(plant.positions()[0] > 0.25);
  CHECK(plant.changes() >= 2);
  // What the drive gave, less what the spot took.
  CHECK(plant.energy_j() == Approx(0.5 * plant.rotor_angle(0) - friction * 0.1).epsilon(1e-8));
}

namespace {

/// Some of the laws, at random.
template <class M>
void with_all_laws(Random& r, M& m) {
  for (std::size_t i = 0; i < m.count(); ++i) {
    JointLaw<double>& law = m.laws[i];
    law.friction_nm = r.below(3) == 0 ? 0.0 : r.within(0.0, 2.0);
    law.asymmetric = r.below(2) == 0;
    law.friction_back_nm = r.below(3) == 0 ? 0.0 : r.within(0.0, 2.0);
    if (r.below(2) == 0) {
      law.static_friction_nm = 1.3 * std::max(law.friction_nm, law.friction_back_nm);
      law.stribeck_velocity_radps = r.within(0.05, 0.5);
    }
    if (r.below(2) == 0) law.load_friction_ratio = r.within(0.0, 0.4);
    if (r.below(2) == 0) {
      law.binding_friction_nm = r.within(0.0, 2.0);
      law.binding_centre_rad = r.within(-1.0, 1.0);
      law.binding_width_rad = r.within(0.05, 0.5);
    }
    if (r.below(2) == 0) law.drag_nms2prad2 = r.within(0.0, 0.3);
  }
}

}  // namespace

TEST_CASE("What settles keeps the conditions of all laws of friction on random trees") {
  Random r(31);
  int most_rounds = 0, held = 0, moving = 0;
  for (int n = 0; n < 3000; ++n) {
    auto m = random_tree<8>(r, r.up_to(8));
    with_all_laws(r, m);
    Joints q = random_joints(r, m, 1), w = random_joints(r, m, 2);
    for (std::size_t i = 0; i < m.count(); ++i)
      if (r.below(4) != 0) w[i] = 0.0;
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
      // The laws once more, as the description of JointLaw has them.
      const bool in_spot = std::abs(q[i] - law.binding_centre_rad) <= law.binding_width_rad / 2;
      const auto level = [&](double direction, bool rest) {
        const double coulomb = direction < 0 && law.asymmetric ? law.friction_back_nm : law.friction_nm;
        const double most = std::max(coulomb, law.static_friction_nm), vs = law.stribeck_velocity_radps;
        double out_nm = rest ? most : coulomb;
        if (!rest && vs > 0.0) out_nm += (most - coulomb) * std::exp(-w[i] * w[i] / (vs * vs));
        return out_nm + law.load_friction_ratio * std::abs(tau[i]) +
               (in_spot ? law.binding_friction_nm : 0.0);
      };
      const double s = mode.direction[i];
      const bool dry = level(1, true) > 0.0 || level(-1, true) > 0.0;
      total[i] += mode.held[i] ? out.holding_nm[i] : s == 0.0 ? 0.0 : -s * level(s, false);
      if (mode.held[i]) {
        ++held;
        CHECK(w[i] == 0.0);
        CHECK(out.joint_radps2[i] == 0.0);
        CHECK(out.holding_nm[i] <= level(-1, true));
        CHECK(out.holding_nm[i] >= -level(1, true));
      } else if (dry) {
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
  std::printf("tree: all laws settle, 3000 states: at most %d rounds; %d held, %d moving\n", most_rounds,
              held, moving);
  CHECK(held > 1000);
  CHECK(moving > 1000);
}

TEST_CASE("Without torque the energy of random trees with all laws only falls") {
  Random r(32);
  int changes = 0, most = 0;
  double worst = 0.0;
  for (int n = 0; n < 60; ++n) {
    auto m = random_tree<8>(r, r.up_to(6));
    with_all_laws(r, m);
    for (std::size_t i = 0; i < m.count(); ++i)
      if (r.below(3) == 0) {
        m.laws[i].elastic = true;
        m.laws[i].armature_kgm2 += 0.02;
        m.laws[i].drive_stiffness_nmprad = r.within(5.0, 50.0);
        m.laws[i].drive_damping_nmspr = r.within(0.0, 0.1);
      }
    Plant<double, Shape> plant(m, 1e-3);
    plant.reset(random_joints(r, m, 1), random_joints(r, m, 2));
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
    worst = std::max(worst, gained);
  }
  std::printf("tree: 60 trees with all laws for 2 s: %d changes of mode, at most %d in 1 ms; gained %.1e J\n",
              changes, most, worst);
  CHECK(changes > 100);
  CHECK(most < 20);
}

TEST_CASE("Derivatives by the binding spot are those of its closed form") {
  using Dual = identify::Dual<4>;
  const double friction = 0.6, centre = 0.7, width = 0.3, v0 = 2.0, time = 0.8;
  Plant<Dual, Shape> plant(rotor<Dual>({.binding_friction_nm = Dual(friction, 0),
                                        .binding_centre_rad = Dual(centre, 1),
                                        .binding_width_rad = Dual(width, 2)}),
                           1e-2);
  plant.reset({}, {Dual(v0, 3)});
  plant.advance({}, time);
  const double v1 = std::sqrt(v0 * v0 - 2.0 * friction * width / kInertia);
  const auto by = [&](std::size_t i) { return plant.velocities()[0].derivative(i); };
  CHECK(by(0) == Approx(-width / (kInertia * v1)).epsilon(1e-7));
  CHECK(by(1) == Approx(0.0).margin(1e-7));
  CHECK(by(2) == Approx(-friction / (kInertia * v1)).epsilon(1e-7));
  CHECK(by(3) == Approx(v0 / v1).epsilon(1e-7));
  // A spot that is further away is met later: dx = dc (1 - v1 / v0).
  CHECK(plant.positions()[0].derivative(1) == Approx(1.0 - v1 / v0).epsilon(1e-7));
}

namespace {

constexpr int kUnknowns = 10;

/// Angles after 1.5 s of a driven double pendulum with all laws, one drive of which is elastic.
template <class T>
std::array<T, 2> after_all_laws(const T (&x)[kUnknowns], int* changes = nullptr) {
  auto m = DoublePendulum<T>{}.template model<StaticTopology<kTwoInSeries>>();
  m.laws[0] = {.armature_kgm2 = T(0.01),
               .friction_nm = x[0],
               .static_friction_nm = x[1],
               .friction_back_nm = x[2],
               .asymmetric = true,
               .stribeck_velocity_radps = x[3],
               .load_friction_ratio = x[4],
               .drag_nms2prad2 = x[5]};
  m.laws[1] = {.armature_kgm2 = T(0.01),
               .elastic = true,
               .drive_stiffness_nmprad = T(8.0),
               .drive_damping_nmspr = T(0.02),
               .load_friction_ratio = x[6],
               .binding_friction_nm = x[7],
               .binding_centre_rad = x[8],
               .binding_width_rad = x[9]};
  Plant<T, StaticTopology<kTwoInSeries>> plant(m, 2e-3);
  plant.reset({T(0.8), T(-0.3)}, {T(0.0), T(0.0)});
  for (int n = 0; n < 300; ++n) {
    plant.advance({T(0.4 * std::sin(0.03 * n)), T(0.3 * std::cos(0.05 * n))}, 5e-3);
    if (changes != nullptr) *changes += plant.changes();
  }
  return plant.positions();
}

}  // namespace

TEST_CASE("Derivatives pass through all laws as differences do") {
  using Dual = identify::Dual<kUnknowns>;
  const double v[kUnknowns] = {0.15, 0.25, 0.2, 0.4, 0.1, 0.02, 0.15, 0.1, 0.1, 0.3};
  Dual d[kUnknowns];
  for (int i = 0; i < kUnknowns; ++i) d[i] = Dual(v[i], i);
  int changes = 0;
  const auto plain = after_all_laws(v, &changes);
  const auto dual = after_all_laws(d);
  CHECK(changes >= 6);
  CHECK(dual[0].a == Approx(plain[0]).epsilon(1e-12));
  for (int i = 0; i < kUnknowns; ++i) {
    double up[kUnknowns], down[kUnknowns];
    for (int k = 0; k < kUnknowns; ++k) up[k] = down[k] = v[k];
    up[i] += 1e-6;
    down[i] -= 1e-6;
    const auto a = after_all_laws(up), b = after_all_laws(down);
    for (std::size_t k = 0; k < 2; ++k) {
      CAPTURE(i, k, changes);
      CHECK(dual[k].derivative(static_cast<std::size_t>(i)) != 0.0);
      CHECK(dual[k].derivative(static_cast<std::size_t>(i)) ==
            Approx((a[k] - b[k]) / 2e-6).epsilon(1e-4).margin(1e-5));
    }
  }
}

TEST_CASE("All laws survive the change of scalar") {
  auto m = rotor({.friction_nm = 0.1,
                  .static_friction_nm = 0.2,
                  .friction_back_nm = 0.3,
                  .asymmetric = true,
                  .stribeck_velocity_radps = 0.4,
                  .load_friction_ratio = 0.5,
                  .binding_friction_nm = 0.6,
                  .binding_centre_rad = 0.7,
                  .binding_width_rad = 0.8,
                  .drag_nms2prad2 = 0.9});
  const JointLaw<float> law = Model<float, Shape>(m).laws[0];
  CHECK(law.friction_back_nm == 0.3F);
  CHECK(law.asymmetric);
  CHECK(law.stribeck_velocity_radps == 0.4F);
  CHECK(law.load_friction_ratio == 0.5F);
  CHECK(law.binding_friction_nm == 0.6F);
  CHECK(law.binding_centre_rad == 0.7F);
  CHECK(law.binding_width_rad == 0.8F);
  CHECK(law.drag_nms2prad2 == 0.9F);
  Plant<double, Shape> plant(m);
  Plant<float, Shape> in_float{Model<float, Shape>(m)};
  plant.reset({}, {2.0});
  in_float.reset({}, {2.0F});
  for (int n = 0; n < 2000; ++n) {
    plant.advance({0.05}, 1e-3);
    in_float.advance({0.05F}, 1e-3F);
  }
  CHECK(plant.held(0));
  CHECK(in_float.held(0));
  CHECK(in_float.positions()[0] == Approx(plant.positions()[0]).epsilon(1e-5));
}
