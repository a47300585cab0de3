// The numbers of the life-size biped of 49.8 kg: those of models/biped/furcula_biped.urdf (a test compares them), and those of its
// drives, clutches, feet and ground, which a URDF cannot hold.
//
// From document 000: gear ratio, peak torque, total mass, the joints. The rest is chosen (docs/biped.md).
#pragma once

#include <string_view>

#include "furcula/dynamics/biped/parameters.hpp"
#include "furcula/dynamics/pin_clutch.hpp"

namespace furcula::dynamics::biped {

/// Name of the robot in its URDF and in the files of its walks.
inline constexpr std::string_view kDesignName = "furcula_biped";

/// Mirrored at the x-z plane: y of positions and the products of inertia xy and yz change sign.
constexpr LinkDescription mirrored(const LinkDescription& l) {
  const auto flip = [](const Vec3<double>& v) { return Vec3<double>{v.x, -v.y, v.z}; };
  const Sym3<double>& s = l.about_centre_kgm2;
  return {flip(l.offset_m), l.mass_kg, flip(l.centre_m), {s.xx, -s.xy, s.xz, s.yy, -s.yz, s.zz}};
}

/// The design, on level ground.
constexpr Description design() {
  Description d{};
  d.pelvis = {{}, 16.2, {0.010, 0.0, 0.075}, {0.243, 0.0, 0.005, 0.18684, 0.0, 0.18684}};
  d.legs[kLeft] = {{
      {{0.0, 0.090, -0.060}, 1.9, {-0.020, 0.0, 0.020}, {0.003167, 0.0, 0.0003, 0.003863, 0.0, 0.003863}},
      {{0.0, 0.0, -0.040}, 3.2, {-0.035, 0.010, 0.0}, {0.007067, 0.0005, 0.0004, 0.010667, 0.0, 0.010053}},
      {{0.0, 0.0, 0.0}, 5.4, {0.005, 0.020, -0.160}, {0.06714, 0.0, 0.004, 0.065925, -0.005, 0.016425}},
      {{0.0, 0.0, -0.400}, 3.4, {0.008, 0.005, -0.165}, {0.036182, 0.0, -0.002, 0.036182, -0.001, 0.006857}},
      {{0.0, 0.0, -0.400}, 0.9, {0.0, 0.0, 0.010}, {0.00096, 0.0, 0.0, 0.00096, 0.0, 0.00096}},
      {{0.0, 0.0, 0.0}, 2.0, {0.020, 0.0, -0.055}, {0.002817, 0.0, 0.001, 0.010017, 0.0, 0.012}},
  }};
  for (std::size_t j = 0; j < kLegJoints; ++j) d.legs[kRight][j] = mirrored(d.legs[kLeft][j]);
  constexpr PinClutchParameters<double> hip = biped_hip<double>();
  for (const std::size_t side : {kLeft, kRight}) {
    d.vertices_m[side] = {
        {{0.150, 0.060, -0.090}, {0.150, -0.060, -0.090}, {-0.090, 0.060, -0.090}, {-0.090, -0.060, -0.090}}};
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      const bool yaw = j == kHipYaw;
      d.drives[side][j] = {
          .armature_kgm2 = hip.rotor_inertia_kgm2,  // 160^2 x 5e-5 kg m^2 of rotor and wave generator
          .damping_nmspr = 2.0,
          .friction_nm = 5.0,
          .kp_nmprad = yaw ? 1500.0 : 3000.0,
          .kd_nmsprad = yaw ? 40.0 : 80.0,
          .limit_nm = hip.torque_limit_nm};
    }
    // A spring of 6000 N/m at 0.1 m; the knee has none.
    d.clutches[side][0] = {.spring_nmprad = hip.spring_stiffness_nmprad,
                           .spring_rest_rad = 0.0,
                           .damping_nmspr = hip.link_damping_nmspr,
                           .brake_nmprad = 2e4,
                           .brake_nmspr = 60.0,
                           .brake_limit_nm = hip.torque_limit_nm};
    d.clutches[side][1] = d.clutches[side][0];
    d.clutches[side][1].spring_nmprad = 0.0;
  }
  d.ground = {.stiffness_npm = 5e4,
              .damping_nspm = 500.0,
              .full_damping_m = 1e-3,
              .shear_stiffness_npm = 3e4,
              .shear_damping_nspm = 300.0,
              .friction = 0.8};
  d.gear_ratio = 160.0;
  d.torque_constant_nmpa = 0.0276;  // a brushless motor of 200 W at 48 V
  d.resistance_ohm = 0.386;
  d.constant_power_w = 100.0;
  d.creep_radps = 0.05;
  d.gravity_mps2 = 9.81;
  return d;
}

}  // namespace furcula::dynamics::biped
