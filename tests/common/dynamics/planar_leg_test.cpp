// The planar leg's equations against a derivation from its bodies' places, the impact's identities, the pinned form
// against the full one, and the plant's energy and events.
#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <numbers>

#include "furcula/dynamics/leg_joints.hpp"
#include "furcula/dynamics/planar_leg_plant.hpp"
#include "tests/common/dynamics/jet.hpp"

using namespace furcula::dynamics;

namespace {

using Parameters = PlanarLegParameters<double>;
using Equations = LegEquations<double>;
using Joints = Joints2<double>;
using Vec = Vec2<double>;

/// 001 Table I; docs/gaits.md says how its lost digits are read.
Parameters spear() {
  return {6.71,
          2.43,
          0.73,
          0.06,
          0.02,
          0.320,
          0.327,
          0.092,
          0.097,
          0.31,
          0.06,
          60.67,
          61.0 * std::numbers::pi / 180.0,
          9.81};
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double within(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  Joints joints(double by) { return {within(-by, by), within(-by, by)}; }

 private:
  std::mt19937_64 engine_;
};

/// Twice the kinetic less the potential energy from the places of the three bodies, q = (x, y, hip, knee): nothing of it is taken
/// from the code under test.
template <class S>
S lagrangian(const PlanarLegParameters<S>& p, const std::array<S, 4>& q, const std::array<S, 4>& v) {
  const S torso = p.mass_kg - p.thigh_mass_kg - p.shank_mass_kg;
  const S shank = q[2] + q[3], shank_rate = v[2] + v[3];
  const S thigh_vx = v[0] + p.thigh_com_m * cos(q[2]) * v[2],
          thigh_vy = v[1] + p.thigh_com_m * sin(q[2]) * v[2];
  const S shank_vx = v[0] + p.thigh_length_m * cos(q[2]) * v[2] + p.shank_com_m * cos(shank) * shank_rate;
  const S shank_vy = v[1] + p.thigh_length_m * sin(q[2]) * v[2] + p.shank_com_m * sin(shank) * shank_rate;
  const S twice =
      (torso * (v[0] * v[0] + v[1] * v[1]) + p.thigh_mass_kg * (thigh_vx * thigh_vx + thigh_vy * thigh_vy) +
       p.shank_mass_kg * (shank_vx * shank_vx + shank_vy * shank_vy) + p.thigh_inertia_kgm2 * v[2] * v[2] +
       p.shank_inertia_kgm2 * shank_rate * shank_rate);
  const S height = p.mass_kg * q[1] -
                   (p.thigh_mass_kg * p.thigh_com_m + p.shank_mass_kg * p.thigh_length_m) * cos(q[2]) -
                   p.shank_mass_kg * p.shank_com_m * cos(shank);
  // Twice the Lagrangian: Jets of Jets do not multiply with plain numbers.
  return twice - (p.gravity_mps2 + p.gravity_mps2) * height;
}

template <class S>
PlanarLegParameters<S> constants(const Parameters& p) {
  const auto c = [](double v) { return S(typename S::Scalar(v)); };
  return {c(p.mass_kg),
          c(p.thigh_mass_kg),
          c(p.shank_mass_kg),
          c(p.thigh_inertia_kgm2),
          c(p.shank_inertia_kgm2),
          c(p.thigh_length_m),
          c(p.shank_length_m),
          c(p.thigh_com_m),
          c(p.shank_com_m),
          c(p.hip_damping_nmspr),
          c(p.knee_damping_nmspr),
          c(p.stiffness_nmprad),
          c(p.rest_angle_rad),
          c(p.gravity_mps2)};
}

/// D, and C + G with D q'' + C + G = Q, by differentiating the Lagrangian twice.
struct Derived {
  Eigen::Matrix4d d;
  Eigen::Vector4d rest;
};
Derived derived(const Parameters& p, const Eigen::Vector4d& q, const Eigen::Vector4d& v) {
  using Inner = ceres::Jet<double, 8>;
  using Outer = ceres::Jet<Inner, 8>;
  std::array<Outer, 4> qs, vs;
  for (int i = 0; i < 4; ++i) {
    qs[static_cast<std::size_t>(i)] = Outer(Inner(q(i), i), i);
    vs[static_cast<std::size_t>(i)] = Outer(Inner(v(i), 4 + i), 4 + i);
  }
  const Outer l = lagrangian(constants<Outer>(p), qs, vs);
  Derived out;
  for (int i = 0; i < 4; ++i) {
    double along = 0.0;  // d/dt dL/dv less its q'' part, less dL/dq
    for (int j = 0; j < 4; ++j) {
      out.d(i, j) = 0.5 * l.v(4 + i).v(4 + j);
      along += 0.5 * l.v(4 + i).v(j) * v(j);
    }
    out.rest(i) = along - 0.5 * l.v(i).a;
  }
  return out;
}

struct Pinned {
  Eigen::Matrix<double, 2, 4> jacobian;
  Eigen::Vector2d turning;  ///< J' q'
};
/// The toe's Jacobian and its rate from its place alone.
Pinned pinned(const Parameters& p, const Eigen::Vector4d& q, const Eigen::Vector4d& v) {
  using Inner = ceres::Jet<double, 4>;
  using Outer = ceres::Jet<Inner, 4>;
  std::array<Outer, 4> s;
  for (int i = 0; i < 4; ++i) s[static_cast<std::size_t>(i)] = Outer(Inner(q(i), i), i);
  const PlanarLegParameters<Outer> c = constants<Outer>(p);
  const Outer place[2]{s[0] + c.thigh_length_m * sin(s[2]) + c.shank_length_m * sin(s[2] + s[3]),
                       s[1] - c.thigh_length_m * cos(s[2]) - c.shank_length_m * cos(s[2] + s[3])};
  Pinned out;
  out.turning.setZero();
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 4; ++j) {
      out.jacobian(i, j) = place[i].v(j).a;
      for (int k = 0; k < 4; ++k) out.turning(i) += place[i].v(j).v(k) * v(j) * v(k);
    }
  return out;
}

}  // namespace

TEST_CASE("a leg in flight accelerates as the Lagrangian of its three bodies says") {
  const Parameters p = spear();
  const Equations leg(p);
  Random r(1);
  for (int n = 0; n < 200; ++n) {
    const Joints angle = r.joints(3.0), rate = r.joints(20.0), torque = r.joints(50.0);
    const Vec velocity{r.within(-4, 4), r.within(-4, 4)};
    const Derived d =
        derived(p, {0.3, 0.7, angle.hip, angle.knee}, {velocity.x, velocity.y, rate.hip, rate.knee});
    const Eigen::Vector4d given(0.0, 0.0, torque.hip - p.hip_damping_nmspr * rate.hip,
                                torque.knee - p.knee_damping_nmspr * rate.knee);
    const Eigen::Vector4d expected = d.d.ldlt().solve(given - d.rest);
    const auto m = leg.in_flight(leg.pose(angle), rate, torque);
    CHECK(m.hip_acceleration.x == Approx(expected(0)).epsilon(1e-9).margin(1e-8));
    CHECK(m.hip_acceleration.y == Approx(expected(1)).epsilon(1e-9).margin(1e-8));
    CHECK(m.acceleration.hip == Approx(expected(2)).epsilon(1e-9).margin(1e-8));
    CHECK(m.acceleration.knee == Approx(expected(3)).epsilon(1e-9).margin(1e-8));
  }
}

TEST_CASE(
    "on the pinned toe the leg moves, and the ground pushes, as the equations with the constraint say") {
  const Parameters p = spear();
  const Equations leg(p);
  Random r(2);
  for (int n = 0; n < 200; ++n) {
    const Joints angle = n == 0 ? Joints{0.2, 0.0} : Joints{r.within(-1.2, 1.2), r.within(0.0, 2.4)};
    const Joints rate = r.joints(15.0), torque = r.joints(50.0);
    const auto pose = leg.pose(angle);
    const Vec velocity = leg.pinned_hip_velocity(pose, rate);
    const Eigen::Vector4d q(0.0, 0.0, angle.hip, angle.knee), v(velocity.x, velocity.y, rate.hip, rate.knee);
    const Derived d = derived(p, q, v);
    const Pinned toe = pinned(p, q, v);
    CHECK((toe.jacobian * v).norm() < 1e-12);
    Eigen::Matrix<double, 6, 6> full = Eigen::Matrix<double, 6, 6>::Zero();
    full.topLeftCorner<4, 4>() = d.d;
    full.topRightCorner<4, 2>() = -toe.jacobian.transpose();
    full.bottomLeftCorner<2, 4>() = toe.jacobian;
    Eigen::Matrix<double, 6, 1> right;
    right << -d.rest, -toe.turning;
    right(2) += torque.hip - p.hip_damping_nmspr * rate.hip;
    right(3) += torque.knee - p.knee_damping_nmspr * rate.knee;
    const Eigen::Matrix<double, 6, 1> expected = full.partialPivLu().solve(right);
    const auto m = leg.in_stance(pose, rate, torque);
    CHECK(m.hip_acceleration.x == Approx(expected(0)).epsilon(1e-8).margin(1e-7));
    CHECK(m.hip_acceleration.y == Approx(expected(1)).epsilon(1e-8).margin(1e-7));
    CHECK(m.acceleration.hip == Approx(expected(2)).epsilon(1e-8).margin(1e-7));
    CHECK(m.acceleration.knee == Approx(expected(3)).epsilon(1e-8).margin(1e-7));
    CHECK(m.ground_force.x == Approx(expected(4)).epsilon(1e-8).margin(1e-6));
    CHECK(m.ground_force.y == Approx(expected(5)).epsilon(1e-8).margin(1e-6));
  }
}

TEST_CASE("the torques that a motion needs are those that make it") {
  const Equations leg(spear());
  Random r(3);
  for (int n = 0; n < 50; ++n) {
    const auto pose = leg.pose({r.within(-1.2, 1.2), r.within(0.0, 2.4)});
    const Joints rate = r.joints(15.0), torque = r.joints(50.0);
    const Joints stance =
        leg.needed_in_stance(pose, rate, leg.in_stance(pose, rate, torque).acceleration).torque;
    const Joints flight =
        leg.needed_in_flight(pose, rate, leg.in_flight(pose, rate, torque).acceleration).torque;
    for (const Joints& u : {stance, flight}) {
      CHECK(u.hip == Approx(torque.hip).margin(1e-9));
      CHECK(u.knee == Approx(torque.knee).margin(1e-9));
    }
  }
}

TEST_CASE(
    "an impact stops the toe, keeps angular momentum about it and about the knee, and loses what Carnot says") {
  const Parameters p = spear();
  const Equations leg(p);
  Random r(4);
  for (int n = 0; n < 100; ++n) {
    const Joints angle{r.within(-1.2, 1.2), r.within(0.0, 2.4)}, rate = r.joints(10.0);
    const Vec velocity{r.within(-4, 4), r.within(-4, 1)};
    const auto pose = leg.pose(angle);
    const auto after = leg.impact(pose, velocity, rate);
    const Vec stopped = leg.toe_velocity(pose, after.rate);
    CHECK(after.hip_velocity.x + stopped.x == Approx(0.0).margin(1e-12));
    CHECK(after.hip_velocity.y + stopped.y == Approx(0.0).margin(1e-12));

    // Bodies by themselves: mass, place from the hip, velocity, spin times inertia.
    const auto momentum = [&](const Vec& v, const Joints& w, const Vec& about, bool with_shank) {
      const double torso = p.mass_kg - p.thigh_mass_kg - p.shank_mass_kg, shank = angle.hip + angle.knee;
      const Vec thigh_at{p.thigh_com_m * std::sin(angle.hip), -p.thigh_com_m * std::cos(angle.hip)};
      const Vec knee{p.thigh_length_m * std::sin(angle.hip), -p.thigh_length_m * std::cos(angle.hip)};
      const Vec shank_at{knee.x + p.shank_com_m * std::sin(shank), knee.y - p.shank_com_m * std::cos(shank)};
      const auto of = [&](double mass, const Vec& at, const Vec& speed) {
        return mass * ((at.x - about.x) * speed.y - (at.y - about.y) * speed.x);
      };
      const Vec thigh_v{v.x - thigh_at.y * w.hip, v.y + thigh_at.x * w.hip};
      const double spin = w.hip + w.knee;
      const Vec shank_v{v.x - knee.y * w.hip - (shank_at.y - knee.y) * spin,
                        v.y + knee.x * w.hip + (shank_at.x - knee.x) * spin};
      double sum =
          of(torso, {0.0, 0.0}, v) + of(p.thigh_mass_kg, thigh_at, thigh_v) + p.thigh_inertia_kgm2 * w.hip;
      if (with_shank) sum += of(p.shank_mass_kg, shank_at, shank_v) + p.shank_inertia_kgm2 * spin;
      return sum;
    };
    const Vec toe = leg.toe(pose), knee = leg.knee(pose);
    CHECK(momentum(after.hip_velocity, after.rate, toe, true) ==
          Approx(momentum(velocity, rate, toe, true)).margin(1e-10));
    CHECK(momentum(after.hip_velocity, after.rate, knee, false) ==
          Approx(momentum(velocity, rate, knee, false)).margin(1e-10));

    const double before = leg.kinetic_energy(pose, velocity, rate);
    const double left = leg.kinetic_energy(pose, after.hip_velocity, after.rate);
    const double lost =
        leg.kinetic_energy(pose, {velocity.x - after.hip_velocity.x, velocity.y - after.hip_velocity.y},
                           {rate.hip - after.rate.hip, rate.knee - after.rate.knee});
    CHECK(before - left == Approx(lost).margin(1e-10));
    CHECK(left <= before);
  }
}

TEST_CASE("a plant's energy is what the motors gave less what was lost, through landing and lift-off") {
  for (const LegSpring spring : {LegSpring::switched, LegSpring::parallel, LegSpring::none}) {
    PlanarLeg<double> leg(spear(), spring, LegLiftOff::force);
    leg.reset({0.0, 0.62}, {0.3, 0.2}, {-0.5, 1.1}, {0.1, -0.2});
    const double start = leg.energy().held();
    std::size_t landed = 0, left = 0, apexes = 0;
    for (int i = 0; i < 600; ++i) {
      const double t = 1e-3 * i;
      leg.advance({3.0 * std::sin(20.0 * t), spring == LegSpring::none ? -20.0 : -8.0}, 1e-3);
      for (const auto& e : leg.events()) {
        using Kind = PlanarLeg<double>::Event::Kind;
        landed += e.kind == Kind::touchdown;
        left += e.kind == Kind::liftoff;
        apexes += e.kind == Kind::apex;
      }
      if (leg.mode() == PlanarLeg<double>::Mode::stance) {
        CHECK(leg.toe_m().y == Approx(0.0).margin(1e-12));
        CHECK((leg.clings() || leg.ground_force_n().y >= -1e-9));
      }
    }
    CHECK(landed >= 1);
    CHECK(left >= 1);
    CHECK(apexes >= 1);
    const auto e = leg.energy();
    CHECK(e.held() - start == Approx(e.motors - e.lost()).margin(1e-7));
    CHECK(e.touchdown > 0.0);
    CHECK(e.friction > 0.0);
  }
}

TEST_CASE("a leg without torques falls by gravity alone, and its apex is where a thrown body has it") {
  PlanarLeg<double> leg(spear(), LegSpring::none, LegLiftOff::force);
  // All turn with nothing: the whole leg moves as one point.
  leg.reset({0.0, 1.0}, {0.5, 1.0}, {-0.4, 0.8}, {0.0, 0.0});
  leg.advance({0.0, 0.0}, 0.15);
  CHECK(leg.hip_m().x == Approx(0.075).margin(1e-12));
  CHECK(leg.hip_m().y == Approx(1.0 + 0.15 - 0.5 * 9.81 * 0.15 * 0.15).margin(1e-12));
  REQUIRE(leg.events().size() == 1);
  CHECK(leg.events()[0].offset_s == Approx(1.0 / 9.81).margin(1e-12));
}

TEST_CASE("a switched spring begins at the knee's angle of touch-down and is slack in flight") {
  PlanarLeg<double> leg(spear(), LegSpring::switched, LegLiftOff::force);
  leg.reset({0.0, 0.55}, {0.0, 0.0}, {-0.5, 1.0}, {0.0, 0.0});
  bool stood = false;
  for (int i = 0; i < 400 && !stood; ++i) {
    CHECK(leg.spring_torque_nm() == 0.0);
    leg.advance({0.0, 0.0}, 1e-3);
    stood = leg.mode() == PlanarLeg<double>::Mode::stance;
  }
  REQUIRE(stood);
  // Free fall with nothing turning: the knee lands as it was.
  CHECK(leg.spring_rest_rad() == Approx(1.0).margin(1e-12));
  for (int i = 0; i < 30; ++i) leg.advance({0.0, 0.0}, 1e-3);
  const double knee = leg.angle_rad().knee;
  CHECK(knee > 1.0);
  CHECK(leg.spring_torque_nm() == Approx(-60.67 * (knee - 1.0)));
}

TEST_CASE("a leg that falls at rest lands on its ground when a stone would, and stands there") {
  // Straight legs without friction do not turn: the toe falls as the hip does.
  Parameters p = spear();
  for (const double ground : {0.0, 0.01, -0.02}) {
    PlanarLeg<double> leg(p, LegSpring::none, LegLiftOff::force);
    leg.set_ground(ground);
    const double height = 0.75;
    leg.reset({0.0, height}, {0.0, 0.0}, {0.0, 0.0}, {0.0, 0.0});
    const double way = height - p.thigh_length_m - p.shank_length_m - ground;
    double landed = -1.0, t = 0.0;
    for (; landed < 0.0 && t < 1.0; t += 1e-3) {
      leg.advance({0.0, 0.0}, 1e-3);
      for (const auto& e : leg.events())
        if (e.kind == PlanarLeg<double>::Event::Kind::touchdown) landed = t + e.offset_s;
    }
    CHECK(landed == Approx(std::sqrt(2.0 * way / p.gravity_mps2)).margin(1e-9));
    CHECK(leg.toe_m().y == Approx(ground).margin(1e-12));
  }
}

TEST_CASE("derivatives pass through touch-down") {
  using Number = ceres::Jet<double, 2>;
  const auto fallen = [](auto height, auto knee_rate) {
    using S = decltype(height);
    PlanarLeg<S> leg(spear(), LegSpring::switched, LegLiftOff::force);
    leg.reset({S(0.0), height}, {S(0.2), S(0.0)}, {S(-0.5), S(1.0)}, {S(0.0), knee_rate});
    for (int i = 0; i < 150; ++i) leg.advance({S(1.0), S(-3.0)}, 1e-3);
    return std::array{leg.angle_rad().knee, leg.rate_radps().knee, leg.hip_m().y};
  };
  const auto with = fallen(Number(0.6, 0), Number(0.3, 1));
  constexpr double kStep = 1e-5;
  for (int k = 0; k < 2; ++k) {
    const double dh = k == 0 ? kStep : 0.0, dr = k == 1 ? kStep : 0.0;
    const auto up = fallen(0.6 + dh, 0.3 + dr), down = fallen(0.6 - dh, 0.3 - dr);
    for (std::size_t i = 0; i < 3; ++i)
      CHECK(with[i].v(k) == Approx((up[i] - down[i]) / (2.0 * kStep)).epsilon(1e-5).margin(1e-6));
  }
}

TEST_CASE("the joints alone move as in the whole equations, and need the same torques") {
  const Equations whole(spear());
  const LegJoints<double> joints(spear());
  Random random(11);
  const auto same = [](double a, double b) { CHECK(a == Approx(b).epsilon(1e-10).margin(1e-9)); };
  for (int i = 0; i < 200; ++i) {
    const Joints angle = random.joints(2.5), rate = random.joints(8.0), torque = random.joints(40.0);
    const auto o = whole.pose(angle);
    const auto k = joints.pose(angle);
    const auto stands = whole.in_stance(o, rate, torque);
    const Joints standing = joints.acceleration<true>(k, rate, torque);
    same(standing.hip, stands.acceleration.hip);
    same(standing.knee, stands.acceleration.knee);
    const Vec force = joints.ground_force(k, rate, standing);
    same(force.x, stands.ground_force.x);
    same(force.y, stands.ground_force.y);
    const auto flies = whole.in_flight(o, rate, torque);
    const Joints flying = joints.acceleration<false>(k, rate, torque);
    same(flying.hip, flies.acceleration.hip);
    same(flying.knee, flies.acceleration.knee);
    for (const Joints& needed :
         {joints.torque<true>(k, rate, standing), joints.torque<false>(k, rate, flying)}) {
      same(needed.hip, torque.hip);
      same(needed.knee, torque.knee);
    }
    // Places against the centre of all mass.
    const Vec centre = whole.centre(o), velocity = whole.centre_velocity(o, rate);
    const Vec toe = whole.toe(o), toe_velocity = whole.toe_velocity(o, rate);
    same(joints.hip(k).x, -centre.x);
    same(joints.hip(k).y, -centre.y);
    same(joints.hip_velocity(k, rate).x, -velocity.x);
    same(joints.hip_velocity(k, rate).y, -velocity.y);
    same(joints.toe(k).x, toe.x - centre.x);
    same(joints.toe(k).y, toe.y - centre.y);
    same(joints.toe_velocity(k, rate).x, toe_velocity.x - velocity.x);
    same(joints.toe_velocity(k, rate).y, toe_velocity.y - velocity.y);
  }
}
