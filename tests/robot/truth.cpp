#include "tests/robot/truth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/message.hpp"
#include "host/core/random.hpp"
#include "host/walk/simulation.hpp"

namespace furcula::robot {
namespace {

using namespace dynamics::biped;
using core::Random;

constexpr double kDegree = std::numbers::pi / 180.0;

/// The moments of mass about the centre's planes are those of some body where all are positive: half the trace less each principal moment.
bool is_some_body(const Sym3<double>& s) {
  const double half = 0.5 * (s.xx + s.yy + s.zz);
  const double a = half - s.xx, b = half - s.yy, c = half - s.zz;
  // Sylvester's criterion on the matrix of second moments, whose off-diagonals are the negative products of inertia.
  const double ab = a * b - s.xy * s.xy;
  const double det =
      a * (b * c - s.yz * s.yz) + s.xy * (-s.xy * c - s.yz * s.xz) - s.xz * (s.xy * s.yz + b * s.xz);
  return a > 0.0 && ab > 0.0 && det > 0.0;
}

Vec3<double> within(Random& r, double range) {
  const double x = r.uniform(-range, range), y = r.uniform(-range, range), z = r.uniform(-range, range);
  return {x, y, z};
}

void draw_link(Random& r, double scale, LinkDescription& l) {
  const double nominal_kg = l.mass_kg;
  l.mass_kg = std::max(0.2 * nominal_kg, nominal_kg + r.uniform(-scale, scale));
  l.centre_m += within(r, 0.1 * scale);
  const Sym3<double> nominal = l.about_centre_kgm2;
  for (int tries = 0; tries < 1000; ++tries) {
    Sym3<double>& s = l.about_centre_kgm2;
    s = nominal;
    for (double* x : {&s.xx, &s.xy, &s.xz, &s.yy, &s.yz, &s.zz}) *x += r.uniform(-0.01 * scale, 0.01 * scale);
    if (is_some_body(s)) return;
  }
  l.about_centre_kgm2 = nominal;
}

}  // namespace

Truth as_described(const Description& robot) {
  Truth t;
  t.robot = robot;
  return t;
}

Truth drawn(const Description& robot, double scale, std::uint64_t seed) {
  Truth t = as_described(robot);
  Random r(seed, 100);
  Description& d = t.robot;
  for (std::size_t side = 0; side < 2; ++side) {
    for (std::size_t j = 0; j < kLegJoints; ++j) {  // Table I
      draw_link(r, scale, d.legs[side][j]);
      d.legs[side][j].offset_m += within(r, 1e-3 * scale);
      t.turns_rad[side][j] = within(r, 0.1 * kDegree * scale);
      t.kp_change[side * kLegJoints + j] = r.uniform(-0.1, 0.1) * scale;
      t.kd_change[side * kLegJoints + j] = r.uniform(-0.1, 0.1) * scale;
      t.encoder_offset_rad[side * kLegJoints + j] = r.uniform(-0.5, 0.5) * kDegree * scale;
    }
    for (auto& v : d.vertices_m[side]) v += within(r, 5e-3 * scale);  // Table II
  }
  t.foot_threshold_change_n = r.uniform(-15.0, 15.0) * scale;
  t.contact_stiffness = 1.0 + r.uniform(-0.1, 0.1) * scale;
  t.contact_damping = 1.0 + r.uniform(-0.1, 0.1) * scale;
  d.ground.friction = std::max(0.2, d.ground.friction + r.uniform(-0.4, 0.4) * scale);
  const double damping = r.uniform(-0.005, 0.005) * scale,
               spring = r.uniform(-3.0, 3.0) * scale;  // 300 N/m at 0.1 m
  for (auto& leg : d.clutches) {
    leg[kHipClutch].damping_nmspr += damping;
    leg[kHipClutch].spring_nmprad += spring;
  }
  t.imu_turn_rad = within(r, 0.5 * kDegree * scale);
  d.slope_x_rad += r.uniform(-0.5, 0.5) * kDegree * scale;
  d.slope_y_rad += r.uniform(-0.5, 0.5) * kDegree * scale;
  return t;
}

void plant(const Planted& p, Truth& t) {
  const std::size_t side = p.joint / kLegJoints % 2, j = p.joint % kLegJoints;
  switch (p.cause) {
    case Cause::none:
      break;
    case Cause::coulomb:
      t.robot.drives[side][j].friction_nm += p.size;
      break;
    case Cause::viscous:
      t.robot.drives[side][j].damping_nmspr += p.size;
      break;
    case Cause::elasticity:
      t.elasticity_nmprad[p.joint] = p.size;
      break;
    case Cause::backlash:
      t.backlash_rad[p.joint] = p.size;
      break;
    case Cause::delay:
      t.delay_s += p.size;
      break;
    case Cause::payload:
      (p.joint == kJoints ? t.robot.pelvis : t.robot.legs[side][j]).mass_kg += p.size;
      break;
    case Cause::slope:
      t.robot.slope_y_rad += p.size;
      break;
    case Cause::slope_sideways:
      t.robot.slope_x_rad += p.size;
      break;
    case Cause::sole:
      for (auto& v : t.robot.vertices_m[kLeft]) v.z -= p.size;
      break;
    case Cause::friction:
      t.robot.ground.friction = p.size;
      break;
    case Cause::encoder:
      t.encoder_offset_rad[p.joint] += p.size;
      break;
  }
}

Planted drawn_cause(Cause cause, std::uint64_t seed) {
  Random r(seed, 200);
  Planted p{cause, static_cast<std::size_t>(r.uniform(0.0, kJoints)), 0.0};
  const double sign = r.coin() ? 1.0 : -1.0;
  switch (cause) {
    case Cause::none:
      break;
    case Cause::coulomb:
      p.size = r.uniform(4.0, 6.0);
      break;
    case Cause::viscous:
      p.size = 6.0;
      break;
    case Cause::elasticity:
      p.size = 1e4;
      break;
    case Cause::backlash:
      p.size = 4e-3;
      break;
    case Cause::delay:
      p.size = r.uniform(5e-3, 15e-3);
      break;
    case Cause::payload:
      p.joint = r.coin() ? kJoints : r.coin() ? kHipPitch : kLegJoints + kHipPitch;
      p.size = p.joint == kJoints ? 3.0 : 1.5;
      break;
    case Cause::slope:
    case Cause::slope_sideways:
      p.size = sign * kDegree;
      break;
    case Cause::sole:
      p.size = sign * 4e-3;
      break;
    case Cause::friction:
      p.size = 0.3;
      break;
    case Cause::encoder:
      p.size = sign * kDegree;
      break;
  }
  return p;
}

std::string in_words(const Planted& p) {
  std::string text(kCauseNames[static_cast<std::size_t>(p.cause)]);
  switch (p.cause) {
    case Cause::none:
      return text;
    case Cause::coulomb:
    case Cause::viscous:
    case Cause::elasticity:
    case Cause::backlash:
    case Cause::encoder:
      text += "@" + walk::joint_name(p.joint);
      break;
    case Cause::payload:
      text += "@" + (p.joint == kJoints ? std::string("pelvis") : walk::joint_name(p.joint));
      break;
    default:
      break;
  }
  return text + " " + core::rounded(p.size, 3);
}

}  // namespace furcula::robot
