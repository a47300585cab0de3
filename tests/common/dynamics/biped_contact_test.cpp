// The biped on the ground: sink, slip, what a vertex does, and whether the contact forces are all that moves it.
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "tests/common/dynamics/biped_examples.hpp"

using namespace furcula;
using namespace furcula::test;

namespace {

constexpr double kH = biped::kStep_s;

/// Vertices' places in the world, the left foot's first.
std::array<Vec3<double>, 8> vertices(const biped::Description& d, const biped::Parameters<double>& p,
                                     const biped::State<double>& s) {
  biped::Kinematics<double> k;
  biped::kinematics<biped::DesignTopology>(p, s, k);
  std::array<Vec3<double>, 8> out;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto pick = [&](const Vec3<dynamics::SimdBatch<double, 2>>& v) {
      return Vec3<double>{v.x[side], v.y[side], v.z[side]};
    };
    const auto& leg = k.legs[0];
    const Mat3<double> r{pick(leg.foot_rotation.x), pick(leg.foot_rotation.y), pick(leg.foot_rotation.z)};
    for (std::size_t i = 0; i < biped::kVertices; ++i)
      out[side * biped::kVertices + i] = pick(leg.foot_position_m) + r * d.vertices_m[side][i];
  }
  return out;
}

double total(const biped::StepReport<double>& report) {
  return report.contact.normal_n[0][0] + report.contact.normal_n[0][1];
}

/// Stands straight, soles at the ground.
biped::State<double> standing(const biped::Description& d, const biped::Parameters<double>& p) {
  biped::State<double> s;
  s.position_m.z = -vertices(d, p, s)[0].z;
  const auto at = vertices(d, p, s);
  for (std::size_t side = 0; side < 2; ++side)
    for (std::size_t i = 0; i < biped::kVertices; ++i) {
      s.anchors_m[0][i][0].set(side, at[side * biped::kVertices + i].x);
      s.anchors_m[0][i][1].set(side, at[side * biped::kVertices + i].y);
    }
  return s;
}

struct Slide {
  double mps2;       ///< acceleration of the centre of mass along the fall line over half a second
  double anchors_m;  ///< by which the farthest anchor moved in that time
};

Slide on_slope(double slope_rad, double direction_rad, double friction, int settle_steps) {
  biped::Description d = biped::design();
  d.ground.friction = friction;
  biped::Parameters<double> p(d);
  // Gravity of that slope, turned about the ground's normal.
  const Vec3<double> g = dynamics::biped::gravity_on_slope(d.gravity_mps2, 0.0, slope_rad);
  const double cx = std::cos(direction_rad), cy = std::sin(direction_rad);
  p.gravity_mps2 = {g.x * cx, g.x * cy, g.z};
  const auto laws = biped::active_laws(p);
  const biped::Commands<double> straight;
  auto s = standing(d, p);
  biped::StepReport<double> report;
  const auto speed = [&] {
    const auto t = biped::totals(p, s);
    return (t.linear_ns.x * cx + t.linear_ns.y * cy) / t.mass_kg;
  };
  for (int n = 0; n < settle_steps; ++n) biped::step(p, laws, straight, kH, s, report);
  const double before = speed();
  const auto anchors = s.anchors_m;
  for (int n = 0; n < 1000; ++n) biped::step(p, laws, straight, kH, s, report);
  double moved = 0.0;
  for (std::size_t i = 0; i < biped::kVertices; ++i)
    for (std::size_t axis = 0; axis < 2; ++axis)
      for (std::size_t side = 0; side < 2; ++side)
        moved = std::max(moved, std::abs(s.anchors_m[0][i][axis][side] - anchors[0][i][axis][side]));
  return {(speed() - before) / (1000 * kH), moved};
}

}  // namespace

TEST_CASE("A standing biped sinks by its weight over the springs of eight vertices") {
  const biped::Description d = biped::design();
  const biped::Parameters<double> p(d);
  const auto laws = biped::active_laws(p);
  const biped::Commands<double> straight;
  auto s = standing(d, p);
  biped::StepReport<double> report;
  for (int n = 0; n < 8000; ++n) biped::step(p, laws, straight, kH, s, report);
  const double weight = 49.8 * 9.81;
  CHECK(total(report) == Approx(weight).epsilon(1e-5));
  double mean = 0.0, rear = 0.0;
  const auto at = vertices(d, p, s);
  for (std::size_t i = 0; i < 8; ++i) {
    CHECK(at[i].z < 0.0);
    mean -= at[i].z / 8.0;
    if (i % 4 >= 2) rear -= at[i].z / 4.0;
  }
  CHECK(mean == Approx(weight / (8 * 5e4)).epsilon(1e-5));  // 1.2214 mm
  // The lever between front and rear: the centre of mass over the sole.
  const auto t = biped::totals(p, s);
  const double centre = t.centre_m().x - 0.5 * (at[2].x + at[6].x), length = at[0].x - at[2].x;
  CHECK(rear == Approx((1.0 - centre / length) * weight / (4 * 5e4)).epsilon(1e-3));
  if (std::getenv("FURCULA_FIGURES") != nullptr)
    std::printf("mean sink %.6f mm, expected %.6f mm\n", 1e3 * mean, 1e3 * weight / 4e5);
}

TEST_CASE("A standing biped's step is stable up to some 5 ms") {
  // Linearised about standing: the highest mode of contact, drives and bodies allows steps of 5.2 ms.
  const biped::Description d = biped::design();
  const biped::Parameters<double> p(d);
  const auto laws = biped::active_laws(p);
  const biped::Commands<double> straight;
  const auto speed_after = [&](double h_s) {
    auto s = standing(d, p);
    biped::StepReport<double> report;
    for (int n = 0; n < static_cast<int>(4.0 / h_s); ++n) biped::step(p, laws, straight, h_s, s, report);
    double most = 0.0;
    for (std::size_t i = 0; i < biped::kJoints; ++i)
      most = std::max(most, std::abs(biped::joint<double>(s.qd_radps, i)));
    return most;
  };
  CHECK(speed_after(1e-3) < 1e-4);
  CHECK(speed_after(4.5e-3) < 1e-4);
  CHECK_FALSE(speed_after(6e-3) < 1e-2);
}

TEST_CASE("In contact small steps come to one motion, whatever their rule") {
  // Sways and slips on its soles for 50 ms; the farthest joint rate off, against Runge-Kutta in 1/64 ms.
  const biped::Description d = biped::design();
  const biped::Parameters<double> p(d);
  const auto laws = biped::active_laws(p);
  const biped::Commands<double> straight;
  const auto run = [&](double h_s, bool euler) {
    auto s = standing(d, p);
    s.position_m.z -= 1e-3;
    s.v_mps = {0.2, 0.1, 0.0};
    s.w_radps = {0.1, 0.2, 0.3};
    biped::StepReport<double> report;
    for (int n = 0; n < static_cast<int>(std::lround(0.05 / h_s)); ++n) {
      if (euler) biped::step(p, laws, straight, h_s, s, report);
      if (!euler) biped::check_step<biped::Rule::runge_kutta>(p, laws, straight, h_s, s);
    }
    return s;
  };
  const auto apart = [](const biped::State<double>& a, const biped::State<double>& b) {
    double most = 0.0;
    for (std::size_t i = 0; i < biped::kJoints; ++i)
      most =
          std::max(most, std::abs(biped::joint<double>(a.qd_radps, i) - biped::joint<double>(b.qd_radps, i)));
    return most;
  };
  // Semi-implicit Euler is of first order; so is Runge-Kutta with anchors that move once a step.
  const auto limit = run(1e-3 / 64, false);
  const double euler = apart(run(5e-4, true), limit), finer = apart(run(2.5e-4, true), limit),
               kutta = apart(run(5e-4, false), limit), finer_kutta = apart(run(2.5e-4, false), limit);
  CHECK(euler / finer == Approx(2.0).margin(0.2));
  CHECK(kutta / finer_kutta == Approx(2.0).margin(0.4));
  CHECK(euler < 2e-3);
  CHECK(euler > 1e-5);  // it moves
}

TEST_CASE("On a slope the biped stands below the cone's angle and slides above it as a block does") {
  // Of so little friction that it does not fall over its heels.
  const double mu = 0.05, cone = std::atan(mu);
  for (const double direction : {0.0, 3.14159265358979, 1.5707963267949, 0.7}) {
    CAPTURE(direction);
    // Let go at once it slips first, and comes to rest.
    const Slide below = on_slope(0.9 * cone, direction, mu, 6000),
                above = on_slope(1.1 * cone, direction, mu, 1000);
    CHECK(below.anchors_m < 1e-12);
    CHECK(std::abs(below.mps2) < 2e-3);  // the body still sways on its drives
    const double angle = 1.1 * cone, expected = 9.81 * (std::sin(angle) - mu * std::cos(angle));
    CHECK(above.mps2 == Approx(expected).epsilon(0.01));
    if (std::getenv("FURCULA_FIGURES") != nullptr)
      std::printf("slope: %.6f m/s2, anchors %.1e m; above %.6f, block %.6f m/s2\n", below.mps2,
                  below.anchors_m, above.mps2, expected);
  }
}

TEST_CASE("A slope turns gravity about y, then about x") {
  // R_lg = Ry Rx takes the ground's coordinates to level ones.
  const double ax = 0.1, ay = 0.2, g = 9.81;
  const Mat3<double> ry{{std::cos(ay), 0, std::sin(ay)}, {0, 1, 0}, {-std::sin(ay), 0, std::cos(ay)}},
      rx{{1, 0, 0}, {0, std::cos(ax), -std::sin(ax)}, {0, std::sin(ax), std::cos(ax)}};
  const Vec3<double> level = (ry * rx) * biped::gravity_on_slope(g, ax, ay);
  CHECK(level.x == Approx(0.0).margin(1e-14));
  CHECK(level.y == Approx(0.0).margin(1e-14));
  CHECK(level.z == Approx(-g).epsilon(1e-14));
}

TEST_CASE("A vertex neither jumps at touch-down nor pulls at lift-off, and its friction is in a cone") {
  const biped::Ground<double> g = biped::design().ground;
  const auto force = [&](const Vec3<double>& x, const Vec3<double>& u, std::array<double, 2> anchor) {
    return biped::vertex_force(g, 1.0 / g.full_damping_m, 1.0 / g.shear_stiffness_npm, x, u, anchor);
  };
  CHECK(force({0, 0, 1e-9}, {0, 0, -3}, {0, 0}).force_n.z == 0.0);
  CHECK(force({0, 0, -1e-9}, {0, 0, -3}, {0, 0}).force_n.z < 5e-3);   // falling at 3 m/s
  CHECK(force({0, 0, -2e-3}, {0, 0, 1.0}, {0, 0}).force_n.z == 0.0);  // 100 N of spring, 500 N of damper
  CHECK(force({0, 0, -2e-3}, {0, 0, 0.1}, {0, 0}).force_n.z == Approx(50.0));
  CHECK(force({0, 0, -5e-4}, {0, 0, -0.1}, {0, 0}).force_n.z == Approx(25.0 + 25.0));  // half of the damping
  Random r(21);
  for (int n = 0; n < 200; ++n) {
    const Vec3<double> x{r.within(-1, 1), r.within(-1, 1), r.within(-5e-3, 1e-3)}, u = r.vector(0.3);
    const std::array<double, 2> anchor{x.x + r.within(-5e-3, 5e-3), x.y + r.within(-5e-3, 5e-3)};
    const auto f = force(x, u, anchor);
    const double tx = 3e4 * (anchor[0] - x.x) - 300 * u.x, ty = 3e4 * (anchor[1] - x.y) - 300 * u.y;
    const double size = std::hypot(f.force_n.x, f.force_n.y), most = 0.8 * f.force_n.z;
    CHECK(size <= most * (1 + 1e-12));
    if (f.force_n.z == 0.0) {
      CHECK(size == 0.0);
      // Where spring and damper together give none.
      CHECK(3e4 * (f.anchor_m[0] - x.x) == Approx(300 * u.x).margin(1e-9));
      CHECK(3e4 * (f.anchor_m[1] - x.y) == Approx(300 * u.y).margin(1e-9));
    } else if (std::hypot(tx, ty) < most * (1 - 1e-9)) {
      CHECK(f.force_n.x == Approx(tx));
      CHECK(f.anchor_m[0] == Approx(anchor[0]).margin(1e-12));
      CHECK(f.anchor_m[1] == Approx(anchor[1]).margin(1e-12));
    } else {
      CHECK(size == Approx(most));
      CHECK(f.force_n.x * ty == Approx(f.force_n.y * tx).margin(1e-6));
      // Dragged to where spring and damper give just that force.
      CHECK(3e4 * (f.anchor_m[0] - x.x) - 300 * u.x == Approx(f.force_n.x).margin(1e-6));
    }
  }
}

TEST_CASE("It makes no difference whether a vertex has just touched the ground at a step or has not quite") {
  const biped::Ground<double> g = biped::design().ground;
  const Vec3<double> u{0.3, -0.2, -0.4};
  const auto after_two_steps = [&](double height_m) {
    Vec3<double> x{0.0, 0.0, height_m};
    std::array<double, 2> anchor{0.003, -0.002};
    biped::VertexForce<double> f{};
    for (int n = 0; n < 3; ++n) {
      f = biped::vertex_force(g, 1.0 / g.full_damping_m, 1.0 / g.shear_stiffness_npm, x, u, anchor);
      anchor = f.anchor_m;
      x += u * kH;
    }
    return f;
  };
  const auto just = after_two_steps(-1e-10), not_quite = after_two_steps(1e-10);
  CHECK(just.force_n.z > 10.0);
  for (auto v : {&Vec3<double>::x, &Vec3<double>::y, &Vec3<double>::z})
    CHECK(just.force_n.*v == Approx(not_quite.force_n.*v).margin(1e-3));
  for (std::size_t axis = 0; axis < 2; ++axis)
    CHECK(just.anchor_m[axis] == Approx(not_quite.anchor_m[axis]).margin(1e-8));
}

TEST_CASE("Weight and vertex forces are all that changes the biped's momentum") {
  Random r(22);
  const biped::Description d = biped::design();
  const biped::Parameters<double> p(d);
  const auto laws = biped::active_laws(p);
  const double h = 1e-7;
  for (int n = 0; n < 20; ++n) {
    auto s = standing(d, p);
    s.position_m.z -= 3e-3;
    for (std::size_t i = 0; i < biped::kJoints; ++i) {
      biped::set_joint<double>(s.q_rad, i, r.within(-3e-3, 3e-3));
      biped::set_joint<double>(s.qd_radps, i, r.within(-1.0, 1.0));
    }
    s.w_radps = r.vector(0.3);
    s.v_mps = r.vector(0.3);
    const auto at = vertices(d, p, s);
    const auto before = biped::totals(p, s);
    const auto anchors = s.anchors_m;
    // The vertices' velocities by moving them.
    auto moved = s;
    biped::drift(biped::rotation(s.attitude), h, moved);
    const auto later = vertices(d, p, moved);
    Vec3<double> force = p.gravity_mps2 * before.mass_kg, moment = cross(before.moment_kgm, p.gravity_mps2);
    for (std::size_t i = 0; i < 8; ++i) {
      const auto f = biped::vertex_force(d.ground, 1e3, 1 / 3e4, at[i], (later[i] - at[i]) * (1 / h),
                                         {anchors[0][i % 4][0][i / 4], anchors[0][i % 4][1][i / 4]});
      force += f.force_n;
      moment += cross(at[i], f.force_n);
    }
    biped::StepReport<double> report;
    biped::step(p, laws, biped::Commands<double>(), h, s, report);
    const auto after = biped::totals(p, s);
    const Vec3<double> linear = (after.linear_ns - before.linear_ns) * (1 / h) - force,
                       angular = (after.angular_nms - before.angular_nms) * (1 / h) - moment;
    const double force_off_n = std::sqrt(dot(linear, linear)),
                 moment_off_nm = std::sqrt(dot(angular, angular));
    // Of up to 2500 N and 160 N m; the differences leave 5e-4 and 2e-4.
    CHECK(force_off_n < 2e-3);
    CHECK(moment_off_nm < 1e-3);
  }
}
