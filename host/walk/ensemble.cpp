#include "host/walk/ensemble.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/core/random.hpp"

namespace furcula::walk {
namespace {

using namespace dynamics::biped;
using core::Random;

constexpr double kDegree = std::numbers::pi / 180.0;

/// Half of the trace less each principal moment is a second moment of mass: where the triangle inequality holds by this margin on the diagonal, and the
/// products are small beside it, some body has the inertia.
bool is_of_a_body(const Sym3<double>& s) {
  const double x = 0.5 * (s.yy + s.zz - s.xx), y = 0.5 * (s.xx + s.zz - s.yy), z = 0.5 * (s.xx + s.yy - s.zz);
  return x > 0.0 && y > 0.0 && z > 0.0 && s.xy * s.xy < x * y && s.xz * s.xz < x * z && s.yz * s.yz < y * z &&
         x * (y * z - s.yz * s.yz) - s.xy * (s.xy * z + s.yz * s.xz) - s.xz * (s.xy * s.yz + y * s.xz) > 0.0;
}

class Draw {
 public:
  Draw(double scale, std::uint64_t seed, std::uint64_t stream) : scale_(scale), random_(seed, stream) {}

  double within(double range) { return random_.uniform(-range, range) * scale_; }
  Vec3<double> vector(double range) {
    const double x = within(range), y = within(range), z = within(range);
    return {x, y, z};
  }
  void link(LinkDescription& l) {
    l.mass_kg = std::max(0.2 * l.mass_kg, l.mass_kg + within(1.0));
    l.centre_m += vector(0.1);
    Sym3<double> s = l.about_centre_kgm2;
    for (double* x : {&s.xx, &s.xy, &s.xz, &s.yy, &s.yz, &s.zz}) *x += within(0.01);
    if (is_of_a_body(s))
      l.about_centre_kgm2 = s;  // else the model's: the tables' ranges are wider than a small link's inertia
  }
  std::uint64_t seed() { return random_.next(); }

 private:
  double scale_;
  Random random_;
};

}  // namespace

std::vector<Member> ensemble_of(const Description& robot, const EnsembleOptions& options) {
  constexpr double kPush_mps = 0.03;  // 15 N for 0.1 s on 50 kg
  std::vector<Member> all(kEnsemble);
  all[0].robot = robot;
  for (std::size_t m = 1; m < all.size(); ++m) {
    Draw draw(options.scale, options.seed, m);
    Member& member = all[m];
    Description& d = member.robot = robot;
    for (std::size_t side = 0; side < 2; ++side) {
      for (std::size_t j = 0; j < kLegJoints; ++j) {
        draw.link(d.legs[side][j]);
        d.legs[side][j].offset_m += draw.vector(1e-3);
        Drive<double>& drive = d.drives[side][j];
        drive.kp_nmprad *= 1.0 + draw.within(0.1);
        drive.kd_nmsprad *= 1.0 + draw.within(0.1);
        drive.friction_nm = std::max(0.0, drive.friction_nm + draw.within(3.0));
        member.encoder_offset_rad[side * kLegJoints + j] = draw.within(0.5 * kDegree);
      }
      for (auto& v : d.vertices_m[side]) v += draw.vector(5e-3);
    }
    Ground<double>& g = d.ground;
    g.friction = std::max(0.2, g.friction + draw.within(0.4));
    for (double* x : {&g.stiffness_npm, &g.damping_nspm, &g.shear_stiffness_npm, &g.shear_damping_nspm})
      *x *= std::exp(draw.within(std::numbers::ln2));
    const double damping = draw.within(0.005), spring = draw.within(3.0);
    for (auto& leg : d.clutches) {
      leg[kHipClutch].damping_nmspr = std::max(0.0, leg[kHipClutch].damping_nmspr + damping);
      leg[kHipClutch].spring_nmprad += spring;
    }
    d.slope_x_rad += draw.within(0.5 * kDegree);
    d.slope_y_rad += draw.within(0.5 * kDegree);
    member.imu_turn_rad = draw.vector(0.5 * kDegree);
    member.foot_reads_n = draw.within(15.0);
    member.push_mps = kPush_mps;
    member.seed = draw.seed();
  }
  return all;
}

}  // namespace furcula::walk
