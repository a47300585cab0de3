// The tree's algorithms against textbook equations, against each other, and their derivatives.
#include <catch2/catch.hpp>

#include "host/identify/dual.hpp"
#include "tests/common/dynamics/tree_examples.hpp"

using namespace furcula;
using namespace furcula::test;

namespace {

using Shape = DynamicTopology<10>;
using Tree = Model<double, Shape>;
using Joints = Tree::Joints;

/// Largest difference over the largest of the values.
template <class M>
double apart(const M& m, const typename M::Joints& a, const typename M::Joints& b) {
  double most = 0.0, scale = 1e-300;
  for (std::size_t i = 0; i < m.count(); ++i) {
    most = std::max<double>(most, std::abs(value_of(a[i]) - value_of(b[i])));
    scale = std::max<double>(scale, std::abs(value_of(b[i])));
  }
  return most / scale;
}

}  // namespace

TEST_CASE("A double pendulum accelerates as Lagrange's equations say") {
  Random r(1);
  const DoublePendulum<double> p;
  const auto m = p.model<Shape>();
  for (int n = 0; n < 100; ++n) {
    const double q[2] = {r.within(-3, 3), r.within(-3, 3)}, w[2] = {r.within(-9, 9), r.within(-9, 9)};
    const double tau[2] = {r.within(-5, 5), r.within(-5, 5)};
    double expected[2];
    p.accelerations(q, w, tau, expected);
    const Joints a = accelerations(m, {q[0], q[1]}, {w[0], w[1]}, {tau[0], tau[1]});
    CHECK(a[0] == Approx(expected[0]).epsilon(1e-10).margin(1e-9));
    CHECK(a[1] == Approx(expected[1]).epsilon(1e-10).margin(1e-9));
  }
}

TEST_CASE("A cart with a pole accelerates as its equations say, with armature and damping") {
  Random r(2);
  const double cart = 1.2, pole = 0.3, c = 0.4, inertia = 0.02, g = 9.81, armature = 0.05, damping = 0.7;
  Tree m;
  add(m, -1, JointKind::prismatic, at(0, 0, 0), {1, 0, 0},
      inertia_of(cart, Vec3<double>{0.0, 0.0, 0.1}, {1, 0, 0, 1, 0, 1}));
  add(m, 0, JointKind::revolute, at(0, 0, 0.1), {0, 1, 0},
      inertia_of(pole, Vec3<double>{0.0, 0.0, c}, {inertia, 0, 0, inertia, 0, 1e-4}));
  m.laws[0].damping_nmspr = damping;
  m.laws[1].armature_kgm2 = armature;
  for (int n = 0; n < 50; ++n) {
    const double x = r.within(-1, 1), t = r.within(-3, 3), v = r.within(-2, 2), w = r.within(-8, 8);
    const double force = r.within(-10, 10), torque = r.within(-1, 1);
    // (M+m) x'' + m c cos t t'' = F - d x' + m c sin t t'^2;  m c cos t x'' + (I + m c^2 + A) t'' = T + m g c sin t
    const double a11 = cart + pole, a12 = pole * c * std::cos(t), a22 = inertia + pole * c * c + armature;
    const double b1 = force - damping * v + pole * c * std::sin(t) * w * w,
                 b2 = torque + pole * g * c * std::sin(t);
    const double det = a11 * a22 - a12 * a12;
    const Joints a = accelerations(m, {x, t}, {v, w}, {force, torque});
    CHECK(a[0] == Approx((a22 * b1 - a12 * b2) / det).epsilon(1e-10).margin(1e-9));
    CHECK(a[1] == Approx((a11 * b2 - a12 * b1) / det).epsilon(1e-10).margin(1e-9));
  }
}

TEST_CASE("A body on a skew axis has the inertia about that axis") {
  Tree m;
  m.gravity_mps2 = {0.0, 0.0, 0.0};
  // About (1, 1, 1)/sqrt(3): the mean of all nine entries of the inertia's matrix.
  const Sym3<double> inertia{0.4, 0.05, -0.02, 0.5, 0.03, 0.6};
  add(m, -1, JointKind::revolute, at(1, 2, 3), {2, 2, 2},
      inertia_of(2.0, Vec3<double>{0.0, 0.0, 0.0}, inertia));
  const double about = (0.4 + 0.5 + 0.6 + 2 * (0.05 - 0.02 + 0.03)) / 3.0;
  CHECK(accelerations(m, {0.7}, {3.0}, {1.0})[0] == Approx(1.0 / about).epsilon(1e-13));
}

TEST_CASE("A spinning wheel on a turntable presses on the joint across both, which is held") {
  Tree m;
  const double spin = 0.02, wheel_speed = 200.0, table_speed = 1.5;
  const Inertia<double> plate = inertia_of(1.0, Vec3<double>{0.0, 0.0, 0.0}, {0.1, 0, 0, 0.1, 0, 0.2});
  add(m, -1, JointKind::revolute, at(0, 0, 0), {0, 0, 1}, plate);
  add(m, 0, JointKind::revolute, at(0, 0, 0), {0, 1, 0}, plate);
  add(m, 1, JointKind::revolute, at(0, 0, 0), {1, 0, 0},
      inertia_of(1.0, Vec3<double>{0.0, 0.0, 0.0}, {spin, 0, 0, 0.03, 0, 0.03}));
  Accelerations<Tree> out;
  forward_dynamics(m, {0.3, 0.0, 1.1}, {table_speed, 0.0, wheel_speed}, {}, {false, true}, out);
  // The angular momentum spin * wheel_speed is carried around: its rate is table_speed times that, about y.
  CHECK(out.holding_nm[1] == Approx(table_speed * spin * wheel_speed).epsilon(1e-12));
  CHECK(out.joint_radps2[1] == 0.0);
  CHECK(std::abs(out.joint_radps2[0]) < 1e-12);
}

TEST_CASE("Forward and inverse dynamics, mass matrix, bias and energy agree on random trees") {
  Random r(3);
  double worst = 0.0;
  for (int n = 0; n < 200; ++n) {
    const auto m = random_tree<10>(r, r.up_to(10));
    const Joints q = random_joints(r, m, 3), w = random_joints(r, m, 5), tau = random_joints(r, m, 10);
    const Joints a = accelerations(m, q, w, tau);
    worst = std::max(worst, apart(m, inverse_dynamics(m, q, w, a), tau));
    const auto mass = mass_matrix(m, q);
    const Joints bias = bias_forces(m, q, w);
    Joints sum{};
    double twice = 0.0;
    for (std::size_t i = 0; i < m.count(); ++i) {
      sum[i] = bias[i] + passive_torque(m.laws[i], q[i], w[i]);
      for (std::size_t k = 0; k < m.count(); ++k) {
        sum[i] += mass[i][k] * a[k];
        twice += w[i] * mass[i][k] * w[k];
        CHECK(mass[i][k] == mass[k][i]);
      }
    }
    worst = std::max(worst, apart(m, sum, tau));
    CHECK(kinetic_energy_j(m, q, w) == Approx(0.5 * twice).epsilon(1e-11));
    // The torque at rest is the potential energy's slope.
    const Joints still{}, holding = inverse_dynamics(m, q, still, still);
    for (std::size_t i = 0; i < m.count(); ++i) {
      Joints up = q, down = q;
      up[i] += 1e-5;
      down[i] -= 1e-5;
      CHECK(holding[i] == Approx((potential_energy_j(m, up) - potential_energy_j(m, down)) / 2e-5)
                              .epsilon(1e-6)
                              .margin(1e-7));
    }
  }
  std::printf(
      "tree: forward against inverse dynamics and mass matrix, worst of 200 trees: %.1e of the largest torque\n",
      worst);
  CHECK(worst < 1e-9);
}

TEST_CASE("A joint that is held is as if its body were a part of the one before it") {
  Random r(4);
  for (int n = 0; n < 50; ++n) {
    Tree chain, merged;
    const Frame<double> places[3] = {
        {r.turn(), r.vector(0.5)}, {r.turn(), r.vector(0.5)}, {r.turn(), r.vector(0.5)}};
    const Vec3<double> axes[3] = {r.vector(1), r.vector(1), r.vector(1)};
    const Inertia<double> bodies[3] = {r.body(), r.body(), r.body()};
    for (int i = 0; i < 3; ++i) add(chain, i - 1, JointKind::revolute, places[i], axes[i], bodies[i]);
    add(merged, -1, JointKind::revolute, places[0], axes[0], bodies[0] + inertia_back(places[1], bodies[1]));
    add(merged, 0, JointKind::revolute, within(places[1], places[2]), axes[2], bodies[2]);
    const double q0 = r.within(-3, 3), q2 = r.within(-3, 3), w0 = r.within(-5, 5), w2 = r.within(-5, 5);
    Accelerations<Tree> out;
    forward_dynamics(chain, {q0, 0.0, q2}, {w0, 0.0, w2}, {1.0, 0.0, -0.5}, {false, true, false}, out);
    const Joints expected = accelerations(merged, {q0, q2}, {w0, w2}, {1.0, -0.5});
    CHECK(out.joint_radps2[0] == Approx(expected[0]).epsilon(1e-9).margin(1e-9));
    CHECK(out.joint_radps2[2] == Approx(expected[1]).epsilon(1e-9).margin(1e-9));
    // What holds it is what inverse dynamics asks for there.
    const Joints tau = inverse_dynamics(chain, {q0, 0.0, q2}, {w0, 0.0, w2}, out.joint_radps2);
    CHECK(out.holding_nm[1] == Approx(tau[1]).epsilon(1e-9).margin(1e-9));
  }
}

TEST_CASE("A topology known when compiled gives the same numbers") {
  constexpr static std::array kPlaces{JointPlace{-1, JointKind::revolute},
                                      JointPlace{0, JointKind::prismatic}, JointPlace{0, JointKind::revolute},
                                      JointPlace{2, JointKind::revolute}};
  using Fixed = StaticTopology<kPlaces>;
  Random r(5);
  Tree dynamic;
  Model<double, Fixed> fixed;
  for (const JointPlace p : kPlaces) {
    const Frame<double> place{r.turn(), r.vector(0.5)};
    const Vec3<double> axis = r.vector(1);
    const Inertia<double> body = r.body();
    add(dynamic, p.parent, p.kind, place, axis, body);
    add(fixed, p.parent, p.kind, place, axis, body);
  }
  CHECK(fixed.add({3, JointKind::revolute}, at(0, 0, 0), {0, 0, 1}, r.body()) == Status::invalid);
  for (int n = 0; n < 50; ++n) {
    const Joints q = random_joints(r, dynamic, 3), w = random_joints(r, dynamic, 5),
                 tau = random_joints(r, dynamic, 5);
    Accelerations<Tree> a;
    Accelerations<Model<double, Fixed>> b;
    forward_dynamics(dynamic, q, w, tau, {}, a);
    forward_dynamics(fixed, {q[0], q[1], q[2], q[3]}, {w[0], w[1], w[2], w[3]},
                     {tau[0], tau[1], tau[2], tau[3]}, {}, b);
    for (std::size_t i = 0; i < 4; ++i) CHECK(a.joint_radps2[i] == Approx(b.joint_radps2[i]).epsilon(1e-12));
  }
}

TEST_CASE("Joints without a place are refused") {
  DynamicTopology<2> shape;
  CHECK_FALSE(shape.add({0, JointKind::revolute}));
  CHECK_FALSE(shape.add({-2, JointKind::revolute}));
  CHECK(shape.add({-1, JointKind::revolute}));
  CHECK(shape.add({0, JointKind::revolute}));
  CHECK_FALSE(shape.add({0, JointKind::revolute}));
  Tree m;
  CHECK(m.add({-1, JointKind::revolute}, at(0, 0, 0), {0, 0, 0}, {}) == Status::invalid);
  CHECK(m.add({-1, JointKind::revolute}, at(0, 0, 0), {0, NAN, 1}, {}) == Status::invalid);
  CHECK(m.count() == 0);
}

TEST_CASE("A link frame is where the joints put it, and a body reads back as it was given") {
  Random r(6);
  Tree m;
  const Inertia<double> body = r.body();
  add(m, -1, JointKind::revolute, at(0, 0, 1), {0, 0, -3}, body);
  add(m, 0, JointKind::prismatic, at(0.5, 0, 0), {0, 1, 0}, body);
  const auto frames = link_frames(m, {-0.5, 0.2});
  // Turned by +0.5 rad about z: the point (0.5, 0.2) of the first link.
  CHECK(frames[1].at.x == Approx(0.5 * std::cos(0.5) - 0.2 * std::sin(0.5)));
  CHECK(frames[1].at.y == Approx(0.5 * std::sin(0.5) + 0.2 * std::cos(0.5)));
  CHECK(frames[1].at.z == 1.0);
  CHECK(frames[1].turn.x.x == Approx(std::cos(0.5)));
  CHECK(frames[1].turn.x.y == Approx(std::sin(0.5)));
  for (std::size_t i = 0; i < 2; ++i) {
    const Inertia<double> back = m.body(i);
    CHECK(back.moment_kgm.y == Approx(body.moment_kgm.y));
    CHECK(back.inertia_kgm2.xz == Approx(body.inertia_kgm2.xz).margin(1e-12));
    CHECK(back.inertia_kgm2.zz == Approx(body.inertia_kgm2.zz));
  }
}

TEST_CASE("In float the accelerations are those in double, to a float's digits") {
  Random r(7);
  double worst = 0.0;
  for (int n = 0; n < 100; ++n) {
    const auto m = random_tree<10>(r, 6);
    const Model<float, Shape> f(m);
    const Joints q = random_joints(r, m, 3), w = random_joints(r, m, 5), tau = random_joints(r, m, 10);
    Model<float, Shape>::Joints qf{}, wf{}, tf{}, af;
    Joints back{};
    for (std::size_t i = 0; i < 6; ++i) qf[i] = float(q[i]), wf[i] = float(w[i]), tf[i] = float(tau[i]);
    af = accelerations(f, qf, wf, tf);
    for (std::size_t i = 0; i < 6; ++i) back[i] = double(af[i]);
    worst = std::max(worst, apart(m, back, accelerations(m, q, w, tau)));
  }
  std::printf("tree: float against double, worst of 100 trees of 6 joints: %.1e\n", worst);
  CHECK(worst < 2e-3);
}

namespace {

/// Accelerations of the double pendulum with unknowns: both masses, a centre, an inertia.
template <class T>
void by_tree(const T (&x)[4], T (&out)[2]) {
  DoublePendulum<T> p;
  p.m1 = x[0], p.m2 = x[1], p.c2 = x[2], p.i2 = x[3];
  const auto a = accelerations(p.template model<StaticTopology<kTwoInSeries>>(), {T(0.7), T(-1.3)},
                               {T(2.0), T(-3.0)}, {T(0.5), T(0.2)});
  out[0] = a[0], out[1] = a[1];
}
template <class T>
void by_lagrange(const T (&x)[4], T (&out)[2]) {
  DoublePendulum<T> p;
  p.m1 = x[0], p.m2 = x[1], p.c2 = x[2], p.i2 = x[3];
  p.accelerations({T(0.7), T(-1.3)}, {T(2.0), T(-3.0)}, {T(0.5), T(0.2)}, out);
}

}  // namespace

TEST_CASE("Derivatives by masses, centre and inertia are those of Lagrange's equations") {
  using Dual = identify::Dual<4>;
  using Jet = ceres::Jet<double, 4>;
  const double v[4] = {0.6, 0.4, 0.2, 3e-3};
  const Dual d[4] = {{v[0], 0}, {v[1], 1}, {v[2], 2}, {v[3], 3}};
  const Jet j[4] = {{v[0], 0}, {v[1], 1}, {v[2], 2}, {v[3], 3}};
  Dual tree[2];
  Jet tree_jets[2], lagrange[2];
  by_tree(d, tree);
  by_tree(j, tree_jets);
  by_lagrange(j, lagrange);
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < 4; ++i) {
      CAPTURE(k, i);
      CHECK(tree[k].derivative(static_cast<std::size_t>(i)) == Approx(lagrange[k].v[i]).epsilon(1e-9));
      CHECK(tree_jets[k].v[i] == Approx(lagrange[k].v[i]).epsilon(1e-9));
    }
}

TEST_CASE("Derivatives by state, torque, armature, damping, spring and gravity are those of differences") {
  using Dual = identify::Dual<8>;
  Random r(8);
  for (int n = 0; n < 20; ++n) {
    const auto m = random_tree<10>(r, 5);
    const Joints q = random_joints(r, m, 3), w = random_joints(r, m, 5), tau = random_joints(r, m, 10);
    const auto run = [&](const auto& shift) {
      using T = std::decay_t<decltype(shift(0))>;
      Model<T, Shape> x = [&] {
        if constexpr (std::is_same_v<T, double>)
          return m;
        else
          return Model<T, Shape>(m);
      }();
      typename Model<T, Shape>::Joints a{}, b{}, c{};
      for (std::size_t i = 0; i < 5; ++i) a[i] = T(q[i]), b[i] = T(w[i]), c[i] = T(tau[i]);
      a[2] += shift(0);
      b[1] += shift(1);
      c[3] += shift(2);
      x.laws[1].armature_kgm2 += shift(3);
      x.laws[2].damping_nmspr += shift(4);
      x.laws[3].stiffness_nmprad += shift(5);
      x.gravity_mps2.x += shift(6);
      auto body = x.body(4);
      body.mass_kg += shift(7);
      x.set_body(4, body);
      return accelerations(x, a, b, c);
    };
    const auto duals = run([](int k) { return Dual(0.0, k); });
    for (int k = 0; k < 8; ++k) {
      const auto up = run([k](int i) { return i == k ? 1e-5 : 0.0; });
      const auto down = run([k](int i) { return i == k ? -1e-5 : 0.0; });
      double scale = 0.0;
      for (std::size_t i = 0; i < 5; ++i)
        scale = std::max(scale, std::abs(duals[i].derivative(static_cast<std::size_t>(k))));
      for (std::size_t i = 0; i < 5; ++i) {
        CAPTURE(k, i);
        CHECK(std::abs(duals[i].derivative(static_cast<std::size_t>(k)) - (up[i] - down[i]) / 2e-5) <
              1e-6 * scale + 1e-5);
      }
    }
  }
}
