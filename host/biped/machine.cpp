#include "host/biped/machine.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace furcula::biped {
namespace {

using namespace dynamics::biped;

constexpr double kDegree = std::numbers::pi / 180.0;
const double kUniform = 1.0 / std::sqrt(3.0);

double& component(dynamics::tree::Vec3<double>& v, std::size_t k) {
  return k == 0 ? v.x : k == 1 ? v.y : v.z;
}
double& component(Sym3<double>& s, std::size_t k) {
  double* all[] = {&s.xx, &s.xy, &s.xz, &s.yy, &s.yz, &s.zz};
  return *all[k];
}
LinkDescription& link(Machine& m, std::size_t i) {
  return i == kJoints ? m.robot.pelvis : m.robot.legs[i / kLegJoints][i % kLegJoints];
}
Drive<double>& drive(Machine& m, std::size_t i) { return m.robot.drives[i / kLegJoints][i % kLegJoints]; }

/// Each number of a machine as a reference: what is read and written.
template <auto kAt>
Unknown unknown(std::string kind, std::string location, std::string unit, double sd, std::size_t place,
                std::size_t part = 0) {
  return {std::move(kind),
          std::move(location),
          std::move(unit),
          sd,
          [](const Machine& m, std::size_t at, std::size_t k) { return kAt(const_cast<Machine&>(m), at, k); },
          [](Machine& m, std::size_t at, std::size_t k, double value) { kAt(m, at, k) = value; },
          place,
          part};
}

constexpr auto kMass = [](Machine& m, std::size_t i, std::size_t) -> double& { return link(m, i).mass_kg; };
constexpr auto kCentre = [](Machine& m, std::size_t i, std::size_t k) -> double& {
  return component(link(m, i).centre_m, k);
};
constexpr auto kInertia = [](Machine& m, std::size_t i, std::size_t k) -> double& {
  return component(link(m, i).about_centre_kgm2, k);
};
constexpr auto kOffset = [](Machine& m, std::size_t i, std::size_t k) -> double& {
  return component(link(m, i).offset_m, k);
};
constexpr auto kTurn = [](Machine& m, std::size_t i, std::size_t k) -> double& {
  return component(m.turns_rad[i / kLegJoints][i % kLegJoints], k);
};
constexpr auto kKp = [](Machine& m, std::size_t i, std::size_t) -> double& { return drive(m, i).kp_nmprad; };
constexpr auto kKd = [](Machine& m, std::size_t i, std::size_t) -> double& { return drive(m, i).kd_nmsprad; };
constexpr auto kEncoder = [](Machine& m, std::size_t i, std::size_t) -> double& {
  return m.encoder_offset_rad[i];
};
constexpr auto kCoulomb = [](Machine& m, std::size_t i, std::size_t) -> double& {
  return drive(m, i).friction_nm;
};
constexpr auto kViscous = [](Machine& m, std::size_t i, std::size_t) -> double& {
  return drive(m, i).damping_nmspr;
};
constexpr auto kArmature = [](Machine& m, std::size_t i, std::size_t) -> double& {
  return drive(m, i).armature_kgm2;
};
constexpr auto kTorque = [](Machine& m, std::size_t i, std::size_t) -> double& { return m.torque_nm[i]; };
constexpr auto kCompliance = [](Machine& m, std::size_t i, std::size_t) -> double& {
  return m.compliance_radpnm[i];
};
constexpr auto kBacklash = [](Machine& m, std::size_t i, std::size_t) -> double& {
  return m.backlash_rad[i];
};
constexpr auto kDelay = [](Machine& m, std::size_t, std::size_t) -> double& { return m.delay_s; };
constexpr auto kImu = [](Machine& m, std::size_t, std::size_t k) -> double& {
  return component(m.imu_turn_rad, k);
};
constexpr auto kGyro = [](Machine& m, std::size_t, std::size_t k) -> double& {
  return component(m.gyro_bias_radps, k);
};
constexpr auto kSlope = [](Machine& m, std::size_t, std::size_t k) -> double& {
  return k == 0 ? m.robot.slope_x_rad : m.robot.slope_y_rad;
};
constexpr auto kFriction = [](Machine& m, std::size_t, std::size_t) -> double& {
  return m.robot.ground.friction;
};
double& of_simulator(Machine& m, std::size_t k) {
  Ground<double>& g = m.robot.ground;
  double* all[] = {&g.stiffness_npm, &g.damping_nspm, &g.shear_stiffness_npm, &g.shear_damping_nspm,
                   &m.robot.creep_radps};
  return *all[k];
}
/// Of what only the simulation has: within a factor of three, two times of three.
Unknown of_simulator(std::string kind, std::size_t k) {
  return {
      std::move(kind),
      "simulator",
      "",
      std::log(3.0),
      [](const Machine& m, std::size_t, std::size_t at) {
        return std::log(of_simulator(const_cast<Machine&>(m), at));
      },
      [](Machine& m, std::size_t, std::size_t at, double value) { of_simulator(m, at) = std::exp(value); },
      0,
      k};
}

constexpr auto kVertex = [](Machine& m, std::size_t i, std::size_t k) -> double& {
  return component(m.robot.vertices_m[i / kVertices][i % kVertices], k);
};
constexpr auto kSpring = [](Machine& m, std::size_t side, std::size_t k) -> double& {
  Clutch<double>& c = m.robot.clutches[side][kHipClutch];
  return k == 0 ? c.spring_nmprad : k == 1 ? c.damping_nmspr : c.spring_rest_rad;
};

}  // namespace

std::string link_name(std::size_t i) {
  if (i == kJoints) return "pelvis";
  return (i < kLegJoints ? "left_" : "right_") + std::string(kLegJointNames[i % kLegJoints]);
}

std::vector<Unknown> unknowns(const Description& d, bool driven_hips, bool sprung_hips) {
  using std::string;
  std::vector<Unknown> all;
  static constexpr const char *kAxes[] = {"x", "y", "z"}, *kProducts[] = {"xx", "xy", "xz", "yy", "yz", "zz"};
  for (std::size_t i = 0; i <= kJoints; ++i) {  // Table I, and the pelvis
    const string at = link_name(i);
    all.push_back(unknown<kMass>("mass", at, "kg", 1.0 * kUniform, i));
    for (std::size_t k = 0; k < 3; ++k)
      all.push_back(unknown<kCentre>(string("centre_") + kAxes[k], at, "m", 0.1 * kUniform, i, k));
    // As wide as the tables, and not wider than a link of this size can be.
    const Sym3<double>& s =
        (i == kJoints ? d.pelvis : d.legs[i / kLegJoints][i % kLegJoints]).about_centre_kgm2;
    const double range = std::min(0.01, 0.3 * (s.xx + s.yy + s.zz));
    for (std::size_t k = 0; k < 6; ++k)
      all.push_back(
          unknown<kInertia>(string("inertia_") + kProducts[k], at, "kg m2", range * kUniform, i, k));
  }
  const auto driven = [&](std::size_t i) { return driven_hips || i % kLegJoints != kHipPitch; };
  for (std::size_t i = 0; i < kJoints; ++i) {
    const string at = link_name(i);
    for (std::size_t k = 0; k < 3; ++k) {
      all.push_back(unknown<kOffset>(string("position_") + kAxes[k], at, "m", 1e-3 * kUniform, i, k));
      all.push_back(
          unknown<kTurn>(string("attitude_") + kAxes[k], at, "rad", 0.1 * kDegree * kUniform, i, k));
    }
    all.push_back(unknown<kEncoder>("encoder_offset", at, "rad", 0.5 * kDegree * kUniform, i));
    if (!driven(i)) continue;
    const Drive<double>& drive = d.drives[i / kLegJoints][i % kLegJoints];
    all.push_back(unknown<kKp>("gain_kp", at, "N m/rad", 0.1 * drive.kp_nmprad * kUniform, i));
    all.push_back(unknown<kKd>("gain_kd", at, "N m s/rad", 0.1 * drive.kd_nmsprad * kUniform, i));
  }
  // Table II
  static constexpr const char* kGrounds[] = {"contact_stiffness", "contact_damping",
                                             "contact_shear_stiffness", "contact_shear_damping",
                                             "friction_ramp"};
  for (std::size_t k = 0; k < 5; ++k) all.push_back(of_simulator(kGrounds[k], k));
  all.push_back(unknown<kFriction>("contact_friction", "ground", "", 0.4 * kUniform, 0));
  for (std::size_t k = 0; k < 2; ++k)
    all.push_back(
        unknown<kSlope>(k == 0 ? "slope_x" : "slope_y", "ground", "rad", 0.5 * kDegree * kUniform, 0, k));
  for (std::size_t k = 0; k < 3; ++k)
    all.push_back(
        unknown<kImu>(string("imu_mounting_") + kAxes[k], "imu", "rad", 0.5 * kDegree * kUniform, 0, k));
  for (std::size_t v = 0; v < 2 * kVertices; ++v)
    for (std::size_t k = 0; k < 3; ++k)
      all.push_back(unknown<kVertex>(string("sole_") + kAxes[k] + "_" + std::to_string(v % kVertices),
                                     v < kVertices ? "left_foot" : "right_foot", "m", 5e-3 * kUniform, v, k));
  if (sprung_hips)
    for (std::size_t side = 0; side < 2; ++side) {
      const string at = link_name(side * kLegJoints + kHipPitch);
      all.push_back(unknown<kSpring>("spring_rate", at, "N m/rad", 3.0 * kUniform, side,
                                     0));  // 300 N/m at 0.1 m
      all.push_back(unknown<kSpring>("spring_damping", at, "N m s/rad", 0.005 * kUniform, side, 1));
    }
  const std::size_t tables = all.size();
  // Beyond the tables. Sizes: as large as the gear's own friction; a gear a third as compliant as its drive; some clearances of teeth.
  for (std::size_t i = 0; i < kJoints; ++i) {
    const string at = link_name(i);
    all.push_back(unknown<kTorque>("constant_torque", at, "N m", 5.0, i));
    if (!driven(i)) continue;
    const Drive<double>& drive = d.drives[i / kLegJoints][i % kLegJoints];
    all.push_back(unknown<kCoulomb>("coulomb_friction", at, "N m", 5.0, i));
    all.push_back(unknown<kViscous>("viscous_friction", at, "N m s/rad", 5.0, i));
    all.push_back(unknown<kArmature>("rotor_inertia", at, "kg m2", 0.3 * drive.armature_kgm2, i));
    all.push_back(unknown<kCompliance>("gear_elasticity", at, "rad/(N m)", 1e-4, i));
    all.push_back(unknown<kBacklash>("backlash", at, "rad", 4e-3, i));
  }
  all.push_back(unknown<kDelay>("command_delay", "drives", "s", 5e-3, 0));
  for (std::size_t k = 0; k < 3; ++k)
    all.push_back(unknown<kGyro>(string("gyro_bias_") + kAxes[k], "imu", "rad/s", 5e-3, 0, k));
  if (sprung_hips)
    for (std::size_t side = 0; side < 2; ++side)
      all.push_back(unknown<kSpring>("spring_rest_angle", link_name(side * kLegJoints + kHipPitch), "rad",
                                     0.02, side, 2));
  for (std::size_t i = tables; i < all.size(); ++i) all[i].of_tables = false;
  return all;
}

namespace {

bool of_a_body(const Sym3<double>& s) {
  const double x = 0.5 * (s.yy + s.zz - s.xx), y = 0.5 * (s.xx + s.zz - s.yy), z = 0.5 * (s.xx + s.yy - s.zz);
  return x > 0.0 && x * y - s.xy * s.xy > 0.0 &&
         x * (y * z - s.yz * s.yz) - s.xy * (s.xy * z + s.yz * s.xz) - s.xz * (s.xy * s.yz + y * s.xz) > 0.0;
}

}  // namespace

bool make_possible(const Machine& model, Machine& m) {
  constexpr double kLeast = 0.2, kStep_s = 1e-3;
  bool changed = false;
  const auto at_least = [&](double& x, double least) {
    if (!(x >= least)) x = least, changed = true;
  };
  for (std::size_t i = 0; i <= kJoints; ++i) {
    LinkDescription& l = link(m, i);
    const LinkDescription& nominal = link(const_cast<Machine&>(model), i);
    at_least(l.mass_kg, kLeast * nominal.mass_kg);
    const Sym3<double> wanted = l.about_centre_kgm2;
    for (double share = 0.9; share > -0.05 && !of_a_body(l.about_centre_kgm2); share -= 0.1) {
      changed = true;
      for (std::size_t k = 0; k < 6; ++k) {
        const double from = component(const_cast<Sym3<double>&>(nominal.about_centre_kgm2), k);
        component(l.about_centre_kgm2, k) =
            from + std::max(0.0, share) * (component(const_cast<Sym3<double>&>(wanted), k) - from);
      }
    }
    if (i == kJoints) break;
    Drive<double>& d = drive(m, i);
    const Drive<double>& n = drive(const_cast<Machine&>(model), i);
    at_least(d.friction_nm, 0.0), at_least(d.damping_nmspr, 0.0);
    at_least(d.kp_nmprad, kLeast * n.kp_nmprad), at_least(d.kd_nmsprad, kLeast * n.kd_nmsprad);
    at_least(d.armature_kgm2, kLeast * n.armature_kgm2);
    at_least(m.compliance_radpnm[i], 0.0), at_least(m.backlash_rad[i], 0.0);
    // A steeper ramp of dry friction rings from step to step.
    at_least(m.robot.creep_radps, kStep_s * d.friction_nm / d.armature_kgm2);
  }
  at_least(m.delay_s, 0.0);
  at_least(m.robot.ground.friction, 0.1);
  for (std::size_t side = 0; side < 2; ++side) {
    Clutch<double>& c = m.robot.clutches[side][kHipClutch];
    at_least(c.damping_nmspr, 0.0), at_least(c.spring_nmprad, 0.0);
  }
  return changed;
}

}  // namespace furcula::biped
