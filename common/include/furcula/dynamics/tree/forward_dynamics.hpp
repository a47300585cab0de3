// Accelerations from torques: the articulated-body algorithm.
//
// Featherstone, Rigid Body Dynamics Algorithms (2008), table 7.1, with the joint's axis z in every body's
// frame. A held joint passes its body's articulated inertia on unreduced; the holding torque is a result of the
// last pass, so that static friction needs no mass matrix.
#pragma once

#include <array>
#include <cstddef>

#include "furcula/dynamics/tree/joint_torque.hpp"
#include "furcula/dynamics/tree/model.hpp"

namespace furcula::dynamics::tree {

namespace detail {

/// Of an articulated body: n = I w + H v + bias.n,  f = H' w + M v + bias.f
template <class T>
struct Articulated {
  Sym3<T> i;
  Mat3<T> h;
  Sym3<T> m;
  Force<T> bias;
};

template <class T>
[[gnu::always_inline]] inline Mat3<T> less_outer(const Mat3<T>& h, const Vec3<T>& a, const Vec3<T>& b) {
  return {h.x - b * a.x, h.y - b * a.y, h.z - b * a.z};
}

/// Its inertia and bias, seen in the parent's frame, added to the parent's.
template <class T>
[[gnu::always_inline]] inline void add_to_parent(const Frame<T>& x, const Articulated<T>& a,
                                                 Articulated<T>& parent) {
  const Mat3<T>& e = x.turn;
  const Vec3<T>& r = x.at;
  const Sym3<T> m = turned_back(e, a.m);
  const Mat3<T> b = a.h * e;
  const Mat3<T> h{transposed_times(b, Vec3<T>{e.x.x, e.y.x, e.z.x}),
                  transposed_times(b, Vec3<T>{e.x.y, e.y.y, e.z.y}),
                  transposed_times(b, Vec3<T>{e.x.z, e.y.z, e.z.z})};
  const Sym3<T> i = turned_back(e, a.i);
  // H2 = H + [r]x M,  I2 = I - H2 [r]x - (H [r]x)'
  const Mat3<T> h2{
      {h.x.x + r.y * m.xz - r.z * m.xy, h.x.y + r.y * m.yz - r.z * m.yy, h.x.z + r.y * m.zz - r.z * m.yz},
      {h.y.x + r.z * m.xx - r.x * m.xz, h.y.y + r.z * m.xy - r.x * m.yz, h.y.z + r.z * m.xz - r.x * m.zz},
      {h.z.x + r.x * m.xy - r.y * m.xx, h.z.y + r.x * m.yy - r.y * m.xy, h.z.z + r.x * m.yz - r.y * m.xz}};
  const Vec3<T> ax = cross(h2.x, r), ay = cross(h2.y, r), az = cross(h2.z, r);
  const Vec3<T> bx = cross(h.x, r), by = cross(h.y, r), bz = cross(h.z, r);
  parent.i = parent.i + Sym3<T>{i.xx - ax.x - bx.x, i.xy - ax.y - by.x, i.xz - ax.z - bz.x,
                                i.yy - ay.y - by.y, i.yz - ay.z - bz.y, i.zz - az.z - bz.z};
  parent.h = {parent.h.x + h2.x, parent.h.y + h2.y, parent.h.z + h2.z};
  parent.m = parent.m + m;
  parent.bias += x.force_back(a.bias);
}

}  // namespace detail

/// Results of forward_dynamics.
template <class M>
struct Accelerations {
  typename M::Joints joint_radps2;  ///< zero of a held joint
  typename M::Joints holding_nm;    ///< the torque that keeps a held joint at rest; zero of the others
};

/// Joint accelerations under the torques `tau_nm` and the joints' springs and damping. The torques of elastic drives and
/// of dry friction must be included in `tau_nm`. A joint with `held` true does not move; its velocity must be zero. Every
/// joint must have a positive inertia: its armature or outboard bodies.
template <class M>
void forward_dynamics(const M& model, const typename M::Joints& q, const typename M::Joints& qd,
                      const typename M::Joints& tau_nm, const typename M::Flags& held,
                      Accelerations<M>& out) {
  using T = typename M::Scalar;
  using V = typename M::V;
  constexpr std::size_t kN = M::kCapacity;
  std::array<Frame<T>, kN> x;
  std::array<Motion<T>, kN> velocity;  // then acceleration
  std::array<Motion<T>, kN> drift;     // the acceleration that the velocities bring along
  std::array<detail::Articulated<T>, kN> body;
  std::array<Force<T>, kN> column;  // the articulated inertia's, of the joint's axis
  std::array<T, kN> free_torque, inverse;
  const auto& shape = model.shape();
  const T zero = T(V(0));

  shape.outwards([&](std::size_t i) __attribute__((always_inline)) {
    const bool slides = shape.kind(i) == JointKind::prismatic;
    x[i] = model.frame(i, q[i]);
    Motion<T> v{{zero, zero, zero}, {zero, zero, zero}};
    if (shape.parent(i) >= 0) v = x[i].motion(velocity[static_cast<std::size_t>(shape.parent(i))]);
    if (slides) {
      v.v.z += qd[i];
      drift[i] = {{zero, zero, zero}, {v.w.y * qd[i], -v.w.x * qd[i], zero}};
    } else {
      v.w.z += qd[i];
      drift[i] = {{v.w.y * qd[i], -v.w.x * qd[i], zero}, {v.v.y * qd[i], -v.v.x * qd[i], zero}};
    }
    velocity[i] = v;
    const Inertia<T>& b = model.aligned_inertia(i);
    const Vec3<T>& h = b.moment_kgm;
    const T& m = b.mass_kg;
    body[i] = {b.inertia_kgm2,
               {{zero, -h.z, h.y}, {h.z, zero, -h.x}, {-h.y, h.x, zero}},
               {m, zero, zero, m, zero, m},
               cross(v, b.times(v))};
  });

  shape.inwards([&](std::size_t i) __attribute__((always_inline)) {
    const bool slides = shape.kind(i) == JointKind::prismatic;
    detail::Articulated<T>& a = body[i];
    column[i] = slides ? Force<T>{{a.h.x.z, a.h.y.z, a.h.z.z}, {a.m.xz, a.m.yz, a.m.zz}}
                       : Force<T>{{a.i.xz, a.i.yz, a.i.zz}, a.h.z};
    const Force<T>& u = column[i];
    free_torque[i] =
        tau_nm[i] - passive_torque(model.laws[i], q[i], qd[i]) - (slides ? a.bias.f.z : a.bias.n.z);
    const T inertia = (slides ? u.f.z : u.n.z) + joint_armature(model.laws[i]);
    inverse[i] = held[i] ? zero : T(T(V(1)) / inertia);
    if (shape.parent(i) < 0) return;
    if (!held[i]) {
      const Vec3<T> n = u.n * inverse[i], f = u.f * inverse[i];
      a.i = less_outer(a.i, u.n, inverse[i]);
      a.h = detail::less_outer(a.h, n, u.f);
      a.m = less_outer(a.m, u.f, inverse[i]);
      const Motion<T>& c = drift[i];
      a.bias.n += a.i * c.w + a.h * c.v + n * free_torque[i];
      a.bias.f += transposed_times(a.h, c.w) + a.m * c.v + f * free_torque[i];
    }
    if (shape.parent(i) >= 0) detail::add_to_parent(x[i], a, body[static_cast<std::size_t>(shape.parent(i))]);
  });

  shape.outwards([&](std::size_t i) __attribute__((always_inline)) {
    Motion<T> a = shape.parent(i) >= 0 ? x[i].motion(velocity[static_cast<std::size_t>(shape.parent(i))])
                                       : Motion<T>{{zero, zero, zero}, x[i].turn * -model.gravity_mps2};
    a = a + drift[i];
    const T missing = free_torque[i] - dot(a, column[i]);
    out.joint_radps2[i] = missing * inverse[i];
    out.holding_nm[i] = held[i] ? T(-missing) : zero;
    (shape.kind(i) == JointKind::prismatic ? a.v.z : a.w.z) += out.joint_radps2[i];
    velocity[i] = a;
  });
}

/// The same with no joint held.
template <class M>
typename M::Joints accelerations(const M& model, const typename M::Joints& q, const typename M::Joints& qd,
                                 const typename M::Joints& tau_nm) {
  Accelerations<M> out;
  forward_dynamics(model, q, qd, tau_nm, typename M::Flags{}, out);
  return out.joint_radps2;
}

}  // namespace furcula::dynamics::tree
