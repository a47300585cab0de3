// The articulated inertia of a link and of all bodies outboard of it, in symmetric blocks:
//
//   n = I w + H v + bias.n,   f = H' w + M v + bias.f      about the link's origin, in its axes
//
// 21 + 6 numbers. (w, v) are accelerations here; v is the classical acceleration of the link's origin. With it the bias of a
// body has no term in its linear velocity, and the velocity-product term of a joint, in the parent's axes, is w x (w x r).
#pragma once

#include "furcula/dynamics/biped/kinematics.hpp"

namespace furcula::dynamics::biped {

/// Articulated-body inertia and bias force, about the link's origin, in its axes (the equation above).
template <class T>
struct Articulated {
  Sym3<T> i;      ///< moment for an angular acceleration, kg m^2
  Mat3<T> h;      ///< moment for a linear acceleration, kg m; its transpose: force for an angular one
  Sym3<T> m;      ///< force for a linear acceleration, kg
  Force<T> bias;  ///< moment and force at zero acceleration, N m and N
};

/// Bias force of a single rigid body with angular velocity w:  n = w x I w,  f = w x (w x h).
template <class T>
FURCULA_INLINE Force<T> body_bias(const Inertia<T>& b, const Vec3<T>& w) {
  return {cross(w, b.inertia_kgm2 * w), cross(w, cross(w, b.moment_kgm))};
}
/// The articulated inertia of a single body with angular velocity w, without outboard bodies.
template <class T>
FURCULA_INLINE Articulated<T> articulated(const Inertia<T>& b, const Vec3<T>& w) {
  const T zero = T(ValueOf<T>(0));
  const Vec3<T>& h = b.moment_kgm;
  return {b.inertia_kgm2,
          {{zero, -h.z, h.y}, {h.z, zero, -h.x}, {-h.y, h.x, zero}},
          {b.mass_kg, zero, zero, b.mass_kg, zero, b.mass_kg},
          body_bias(b, w)};
}
/// Adds a body with angular velocity w to `a`; does not add the entries that are zero for a single body.
template <class T>
FURCULA_INLINE void add_body(Articulated<T>& a, const Inertia<T>& b, const Vec3<T>& w) {
  const Vec3<T>& h = b.moment_kgm;
  a.i = a.i + b.inertia_kgm2;
  a.h.x.y -= h.z, a.h.x.z += h.y;
  a.h.y.x += h.z, a.h.y.z -= h.x;
  a.h.z.x -= h.y, a.h.z.y += h.x;
  a.m.xx += b.mass_kg, a.m.yy += b.mass_kg, a.m.zz += b.mass_kg;
  a.bias += body_bias(b, w);
}

/// Terms of a joint that the outward pass needs again.
template <class T>
struct JointTerms {
  Force<T> column;  ///< column of the articulated inertia for the joint's axis
  T inverse_kgm2;   ///< 1 / (inertia about the joint's axis + armature)
  T torque_nm;      ///< joint torque less the bias moment about its axis
};

/// Reduces `a` to what the parent feels through the joint, which is free about its axis; still in the link's axes. `w` is the
/// link's angular velocity, including the joint's own rate `qd`.
template <Axis A, class T>
FURCULA_INLINE JointTerms<T> reduce(Articulated<T>& a, const Vec3<T>& w, const T& qd, const T& torque_nm,
                                    const T& armature_kgm2) {
  using V = ValueOf<T>;
  JointTerms<T> out;
  const Sym3<T> iz = axis_to_z<A>(a.i);
  const Mat3<T> hz = axis_to_z<A>(a.h);
  out.column = {z_to_axis<A>(Vec3<T>{iz.xz, iz.yz, iz.zz}), z_to_axis<A>(hz.z)};
  const Force<T>& u = out.column;
  out.torque_nm = torque_nm - along<A>(a.bias.n);
  out.inverse_kgm2 = V(1) / (iz.zz + armature_kgm2);
  const Vec3<T> n = u.n * out.inverse_kgm2, f = u.f * out.inverse_kgm2;
  a.i = {a.i.xx - n.x * u.n.x, a.i.xy - n.x * u.n.y, a.i.xz - n.x * u.n.z,
         a.i.yy - n.y * u.n.y, a.i.yz - n.y * u.n.z, a.i.zz - n.z * u.n.z};
  a.h = {a.h.x - u.f * n.x, a.h.y - u.f * n.y, a.h.z - u.f * n.z};
  a.m = {a.m.xx - f.x * u.f.x, a.m.xy - f.x * u.f.y, a.m.xz - f.x * u.f.z,
         a.m.yy - f.y * u.f.y, a.m.yz - f.y * u.f.z, a.m.zz - f.z * u.f.z};
  // Drift w x axis qd: two components.
  const Vec3<T> wz = axis_to_z<A>(w);
  const T cx = wz.y * qd, cy = -(wz.x * qd);
  const Sym3<T> ia = axis_to_z<A>(a.i);
  const Mat3<T> ha = axis_to_z<A>(a.h);
  a.bias.n +=
      z_to_axis<A>(Vec3<T>{ia.xx * cx + ia.xy * cy, ia.xy * cx + ia.yy * cy, ia.xz * cx + ia.yz * cy}) +
      n * out.torque_nm;
  a.bias.f += z_to_axis<A>(ha.x * cx + ha.y * cy) + f * out.torque_nm;
  return out;
}

/// w x (w x r), where only the components `kMask` of r are not zero (bit 0: x, 1: y, 2: z).
template <unsigned kMask, class T>
FURCULA_INLINE Vec3<T> centripetal(const Vec3<T>& w, const Vec3<T>& r) {
  if constexpr (kMask == 4) {
    const T wz = w.z * r.z;
    return {w.x * wz, w.y * wz, -((w.x * w.x + w.y * w.y) * r.z)};
  } else {
    const T zero = T(ValueOf<T>(0));
    return cross(w, -plus_cross<kMask>(Vec3<T>{zero, zero, zero}, r, w));
  }
}

/// Transforms `a` to the parent's axes and origin. `turn` is the joint's rotation, `r` the joint's place in the parent, of which
/// only the components `kMask` are not zero; `parent_w` is the parent's angular velocity.
template <unsigned kMask, class Turned, class T>
FURCULA_INLINE void to_parent(const Turned& turn, const Vec3<T>& r, const Vec3<T>& parent_w,
                              Articulated<T>& a) {
  a.i = turn.back(a.i);
  a.h = turn.back(a.h);
  a.m = turn.back(a.m);
  a.bias.n = turn.back(a.bias.n);
  a.bias.f = turn.back(a.bias.f);
  if constexpr (kMask != 0) {
    const Vec3<T> drift = centripetal<kMask>(parent_w, r);
    a.bias.n += a.h * drift;
    a.bias.f += a.m * drift;
    a.bias.n = plus_cross<kMask>(a.bias.n, r, a.bias.f);
    // H2 = H + [r]x M (columns),  I2 = I + ([r]x H')' + [r]x H2'
    const Mat3<T> before = a.h;
    const Vec3<T> hx =
        plus_cross<kMask>(Vec3<T>{before.x.x, before.y.x, before.z.x}, r, {a.m.xx, a.m.xy, a.m.xz});
    const Vec3<T> hy =
        plus_cross<kMask>(Vec3<T>{before.x.y, before.y.y, before.z.y}, r, {a.m.xy, a.m.yy, a.m.yz});
    const Vec3<T> hz =
        plus_cross<kMask>(Vec3<T>{before.x.z, before.y.z, before.z.z}, r, {a.m.xz, a.m.yz, a.m.zz});
    a.h = {{hx.x, hy.x, hz.x}, {hx.y, hy.y, hz.y}, {hx.z, hy.z, hz.z}};
    // Row k of ([r]x H')' is r x (row k of H); column k of [r]x H2' is r x (row k of H2).
    const Vec3<T> px = plus_cross<kMask>(Vec3<T>{a.i.xx, a.i.xy, a.i.xz}, r, before.x);
    const Vec3<T> py = plus_cross<kMask>(Vec3<T>{a.i.xy, a.i.yy, a.i.yz}, r, before.y);
    const Vec3<T> pz = plus_cross<kMask>(Vec3<T>{a.i.xz, a.i.yz, a.i.zz}, r, before.z);
    const Vec3<T> qx = plus_cross<kMask>(Vec3<T>{px.x, py.x, pz.x}, r, a.h.x);
    const Vec3<T> qy = plus_cross<kMask>(Vec3<T>{px.y, py.y, pz.y}, r, a.h.y);
    const Vec3<T> qz = plus_cross<kMask>(Vec3<T>{px.z, py.z, pz.z}, r, a.h.z);
    a.i = {qx.x, qx.y, qx.z, qy.y, qy.z, qz.z};
  }
}

}  // namespace furcula::dynamics::biped
