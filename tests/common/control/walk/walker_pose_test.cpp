// The centre of mass against the feet, as the controller has it, against the plant's sums over all bodies and against differences.
#include "furcula/control/walk/walker_pose.hpp"

#include <catch2/catch.hpp>

#include "furcula/dynamics/biped/design.hpp"
#include "furcula/dynamics/biped/energy.hpp"
#include "tests/common/dynamics/biped_examples.hpp"

using namespace furcula;
using namespace furcula::control;
using dynamics::biped::kLeft;
using dynamics::biped::kRight;
using dynamics::tree::Vec3;

namespace {

const dynamics::biped::Parameters<double>& robot() {
  static const dynamics::biped::Parameters<double> p(dynamics::biped::design());
  return p;
}

struct Seen {
  Vec3<double> centre, left, right, heading_left, heading_right;  // world
};
Seen seen(const dynamics::biped::State<double>& s) {
  dynamics::biped::Kinematics<double> k;
  dynamics::biped::kinematics<dynamics::biped::DesignTopology>(robot(), s, k);
  const auto& leg = k.legs[0];
  const auto at = [](const auto& v, std::size_t side) {
    return Vec3<double>{v.x[side], v.y[side], v.z[side]};
  };
  const auto column = [&](std::size_t side) {
    return Vec3<double>{leg.foot_rotation.x.x[side], leg.foot_rotation.y.x[side],
                        leg.foot_rotation.z.x[side]};
  };
  return {totals(robot(), s).centre_m(), at(leg.foot_position_m, kLeft), at(leg.foot_position_m, kRight),
          column(kLeft), column(kRight)};
}

/// Forward and left of a heading, horizontally.
std::array<double, 2> split(const Vec3<double>& arm, const Vec3<double>& heading) {
  const double n = std::hypot(heading.x, heading.y);
  return {(arm.x * heading.x + arm.y * heading.y) / n, (arm.y * heading.x - arm.x * heading.y) / n};
}

}  // namespace

TEST_CASE("the balance is the plant's centre of mass from a foot, and its rates those of differences") {
  test::Random random(1);
  const double mass = totals(robot(), dynamics::biped::State<double>{}).mass_kg;
  for (int i = 0; i < 50; ++i) {
    const auto s = test::state_of(test::random_coordinates(random));
    // A step on and back along the motion.
    constexpr double kStep = 1e-6;
    auto after = s, before = s;
    drift(dynamics::biped::rotation(s.attitude), kStep, after);
    drift(dynamics::biped::rotation(s.attitude), -kStep, before);
    dynamics::biped::PerLeg<double, LegPose<dynamics::biped::LegScalar<double>>> legs;
    leg_poses(robot(), s.q_rad, s.qd_radps, legs);
    const Seen now = seen(s), then = seen(after), earlier = seen(before);
    for (const double left : {1.0, 0.0, 0.5}) {
      const double right = 1.0 - left;
      const Balance<double> b = balance(robot(), 1.0 / mass, legs, s.attitude, s.w_radps, left, right);
      const auto arm = [&](const Seen& at) { return at.centre - at.left * left - at.right * right; };
      const Vec3<double> heading = now.heading_left * left + now.heading_right * right;
      const auto expected = split(arm(now), heading);
      CHECK(b.forward_m == Approx(expected[0]).margin(1e-10));
      CHECK(b.left_m == Approx(expected[1]).margin(1e-10));
      const auto speed = split((arm(then) - arm(earlier)) * (0.5 / kStep), heading);
      CHECK(b.forward_mps == Approx(speed[0]).margin(1e-6));
      CHECK(b.left_mps == Approx(speed[1]).margin(1e-6));
    }
    const Vec3<double> apart = dynamics::biped::rotation(s.attitude) * ankles_apart<double>(legs);
    CHECK(apart.x == Approx(now.left.x - now.right.x).margin(1e-10));
    CHECK(apart.y == Approx(now.left.y - now.right.y).margin(1e-10));
    CHECK(apart.z == Approx(now.left.z - now.right.z).margin(1e-10));
  }
}
