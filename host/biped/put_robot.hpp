// One robot's parameters into a lane of a SIMD batch.
#pragma once

#include <cstddef>

#include "furcula/dynamics/biped/parameters.hpp"

namespace furcula::biped {

/// Writes all numbers of `from` to lane `lane` of `to`. T is a number in lanes, or double: then `to` becomes `from`.
template <class T>
void put_robot(dynamics::biped::Parameters<T>& to, std::size_t lane,
               const dynamics::biped::Parameters<double>& from) {
  using namespace dynamics::biped;
  using L = LegScalar<T>;
  const auto put = [lane](T& x, double v) {
    dynamics::set_lane(x, lane, static_cast<dynamics::ValueOf<T>>(v));
  };
  const auto put3 = [&](Vec3<T>& x, const Vec3<double>& v) { put(x.x, v.x), put(x.y, v.y), put(x.z, v.z); };
  const auto body = [](auto& t, const auto& x, auto&& one) {
    one(t.mass_kg, x.mass_kg);
    one(t.moment_kgm.x, x.moment_kgm.x), one(t.moment_kgm.y, x.moment_kgm.y),
        one(t.moment_kgm.z, x.moment_kgm.z);
    auto& s = t.inertia_kgm2;
    const auto& i = x.inertia_kgm2;
    one(s.xx, i.xx), one(s.xy, i.xy), one(s.xz, i.xz), one(s.yy, i.yy), one(s.yz, i.yz), one(s.zz, i.zz);
  };
  body(to.pelvis, from.pelvis, put);
  for (const std::size_t side : {kLeft, kRight}) {
    const std::size_t pass = Legs<T>::pass(side);
    const auto of_leg = [&](L& x, const auto& v) {
      T all = Legs<T>::read(x, side);
      put(all, Legs<double>::read(v, side));
      Legs<T>::write(x, side, all);
    };
    const auto of_leg3 = [&](Vec3<L>& x, const auto& v) {
      of_leg(x.x, v.x), of_leg(x.y, v.y), of_leg(x.z, v.z);
    };
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      body(to.links[pass][j], from.links[0][j], of_leg);
      of_leg3(to.offsets_m[pass][j], from.offsets_m[0][j]);
      Drive<L>& d = to.drives[pass][j];
      const auto& y = from.drives[0][j];
      of_leg(d.armature_kgm2, y.armature_kgm2), of_leg(d.damping_nmspr, y.damping_nmspr);
      of_leg(d.friction_nm, y.friction_nm), of_leg(d.kp_nmprad, y.kp_nmprad);
      of_leg(d.kd_nmsprad, y.kd_nmsprad), of_leg(d.limit_nm, y.limit_nm);
    }
    for (std::size_t v = 0; v < kVertices; ++v) of_leg3(to.vertices_m[pass][v], from.vertices_m[0][v]);
    for (std::size_t i = 0; i < kClutches; ++i) {
      Clutch<L>& c = to.clutches[pass][i];
      const auto& x = from.clutches[0][i];
      of_leg(c.spring_nmprad, x.spring_nmprad), of_leg(c.spring_rest_rad, x.spring_rest_rad);
      of_leg(c.damping_nmspr, x.damping_nmspr), of_leg(c.brake_nmprad, x.brake_nmprad);
      of_leg(c.brake_nmspr, x.brake_nmspr), of_leg(c.brake_limit_nm, x.brake_limit_nm);
    }
  }
  Ground<T>& g = to.ground;
  put(g.stiffness_npm, from.ground.stiffness_npm), put(g.damping_nspm, from.ground.damping_nspm);
  put(g.full_damping_m, from.ground.full_damping_m);
  put(g.shear_stiffness_npm, from.ground.shear_stiffness_npm);
  put(g.shear_damping_nspm, from.ground.shear_damping_nspm), put(g.friction, from.ground.friction);
  put(to.creep_radps, from.creep_radps);
  put3(to.gravity_mps2, from.gravity_mps2);
}

}  // namespace furcula::biped
