// Coordinates of a rigid body's inertia for fits: every value is physically possible.
//
// The pseudo-inertia of a body, with density over its mass, is J = integral of [x; 1] [x; 1]' dm, a positive definite
// 4 x 4 matrix for every body of positive volume, and every such matrix belongs to a body (Wensing, Kim, Slotine,
// IEEE RA-L 3, 2018). Its logarithmic Cholesky factor J = U U', with
//   U = exp(a) [exp(d1) s12 s13 t1; 0 exp(d2) s23 t2; 0 0 exp(d3) t3; 0 0 0 1],
// is ten free numbers for ten parameters, one to one (Rucker, Wensing, "Smooth parameterization of rigid-body
// inertia", IEEE RA-L 7, 2022).
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "furcula/core/status.hpp"
#include "furcula/dynamics/scalar.hpp"
#include "furcula/dynamics/tree/spatial.hpp"

namespace furcula::dynamics::tree {

/// The factor U of the pseudo-inertia (above). Any ten finite numbers are a body. Lengths are in m, masses in kg.
template <class T>
struct InertiaCoordinates {
  T log_scale;          ///< a: half the logarithm of the mass
  Vec3<T> log_stretch;  ///< d1, d2, d3: logarithms of lengths
  T shear12,            ///< s12, m
      shear23,          ///< s23, m
      shear13;          ///< s13, m
  Vec3<T> centre_m;     ///< t1, t2, t3: the centre of mass
};

/// The inertia with these coordinates, about the frame's origin.
template <class T>
Inertia<T> inertia_of(const InertiaCoordinates<T>& c) {
  using std::exp;
  const T scale = exp(c.log_scale), mass = scale * scale;
  const Vec3<T>& t = c.centre_m;
  const T u11 = exp(c.log_stretch.x), u22 = exp(c.log_stretch.y), u33 = exp(c.log_stretch.z);
  // Second moments per mass: the upper left 3 x 3 of U U'.
  const T xx = u11 * u11 + c.shear12 * c.shear12 + c.shear13 * c.shear13 + t.x * t.x;
  const T xy = c.shear12 * u22 + c.shear13 * c.shear23 + t.x * t.y;
  const T xz = c.shear13 * u33 + t.x * t.z;
  const T yy = u22 * u22 + c.shear23 * c.shear23 + t.y * t.y;
  const T yz = c.shear23 * u33 + t.y * t.z;
  const T zz = u33 * u33 + t.z * t.z;
  return {mass,
          t * mass,
          {(yy + zz) * mass, -xy * mass, -xz * mass, (xx + zz) * mass, -yz * mass, (xx + yy) * mass}};
}

/// The inverse of inertia_of(). Status::invalid where no body of positive volume has this inertia: the mass is not
/// positive, or the inertia about the centre of mass violates a triangle inequality or meets it with equality (a sheet, a
/// rod, a point).
template <class T>
Result<InertiaCoordinates<T>> coordinates_of(const Inertia<T>& body) {
  using V = ValueOf<T>;
  using std::log;
  using std::sqrt;
  if (!(value_of(body.mass_kg) > V(0))) return Status::invalid;
  const T per_mass = T(V(1)) / body.mass_kg;
  const Sym3<T>& i = body.inertia_kgm2;
  const Vec3<T> t = body.moment_kgm * per_mass;
  const T trace = (i.xx + i.yy + i.zz) * V(0.5);
  const T xx = (trace - i.xx) * per_mass - t.x * t.x, xy = -i.xy * per_mass - t.x * t.y;
  const T xz = -i.xz * per_mass - t.x * t.z, yy = (trace - i.yy) * per_mass - t.y * t.y;
  const T yz = -i.yz * per_mass - t.y * t.z, zz = (trace - i.zz) * per_mass - t.z * t.z;
  // Cholesky from the last row: [xx xy xz; . yy yz; . . zz] = U U'.
  if (!(value_of(zz) > V(0))) return Status::invalid;
  const T u33 = sqrt(zz), s23 = yz / u33, s13 = xz / u33;
  const T left22 = yy - s23 * s23;
  if (!(value_of(left22) > V(0))) return Status::invalid;
  const T u22 = sqrt(left22), s12 = (xy - s13 * s23) / u22;
  const T left11 = xx - s12 * s12 - s13 * s13;
  if (!(value_of(left11) > V(0)) || !std::isfinite(value_of(left11 + left22 + zz))) return Status::invalid;
  return InertiaCoordinates<T>{
      log(body.mass_kg) * V(0.5), {log(left11) * V(0.5), log(u22), log(u33)}, s12, s23, s13, t};
}

}  // namespace furcula::dynamics::tree
