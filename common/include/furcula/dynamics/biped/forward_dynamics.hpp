// Accelerations of the biped from its joints' torques and the feet's contact wrenches: the articulated-body algorithm.
//
// Featherstone, Rigid Body Dynamics Algorithms (2008), chapters 7 and 9 (floating base), in blocks (articulated.hpp). A joint's armature
// counts on its diagonal only: the rotor spins about the joint's axis; its gyroscopic terms (below 0.03 N m s/rad) are neglected.
#pragma once

#include "furcula/dynamics/biped/articulated.hpp"

namespace furcula::dynamics::biped {

/// Torques, armatures, contact wrenches and gravity that act on the robot.
template <class T>
struct Actions {
  Joints<T> torque_nm;      ///< on each joint, friction and damping subtracted
  Joints<T> armature_kgm2;  ///< reflected rotor inertia; 0 where the motor is not joined to its link
  PerLeg<T, Force<LegScalar<T>>> foot;  ///< contact wrench about the foot's origin, in the foot's axes
  Vec3<T> gravity_mps2;                 ///< acceleration of free fall, world
};

namespace detail {

/// The inverse of a symmetric, positive definite 3 x 3 matrix by its cofactors: one division.
template <class T>
FURCULA_INLINE Sym3<T> inverse(const Sym3<T>& s) {
  const T xx = s.yy * s.zz - s.yz * s.yz, xy = s.xz * s.yz - s.xy * s.zz, xz = s.xy * s.yz - s.xz * s.yy;
  const T k = ValueOf<T>(1) / (s.xx * xx + s.xy * xy + s.xz * xz);
  return {xx * k,
          xy * k,
          xz * k,
          (s.xx * s.zz - s.xz * s.xz) * k,
          (s.xy * s.xz - s.xx * s.yz) * k,
          (s.xx * s.yy - s.xy * s.xy) * k};
}

/// [I H; H' M] [w; v] = -bias, by the Schur complement of M.
template <class T>
FURCULA_INLINE tree::Motion<T> solved(const Articulated<T>& a) {
  const Sym3<T> m = inverse(a.m);
  // Rows of G = H M^-1.
  const Mat3<T> g{m * a.h.x, m * a.h.y, m * a.h.z};
  const Sym3<T> s{a.i.xx - dot(g.x, a.h.x), a.i.xy - dot(g.x, a.h.y), a.i.xz - dot(g.x, a.h.z),
                  a.i.yy - dot(g.y, a.h.y), a.i.yz - dot(g.y, a.h.z), a.i.zz - dot(g.z, a.h.z)};
  const Vec3<T> w = inverse(s) * (g * a.bias.f - a.bias.n);
  return {w, -(m * (a.bias.f + transposed_times(a.h, w)))};
}

}  // namespace detail

/// Accelerations of pelvis and joints at state `s` under `act`. `k` is kinematics() of `s`. kHeld: a stand holds the pelvis, which is at rest.
template <class Topology, bool kHeld = false, class P, class T>
FURCULA_INLINE void forward_dynamics(const P& p, const State<T>& s, const Kinematics<T>& k,
                                     const Actions<T>& act, Accelerations<T>& out) {
  using L = LegScalar<T>;
  constexpr std::size_t kPasses = Legs<T>::kPasses;
  PerLeg<T, std::array<JointTerms<L>, kLegJoints>> terms;
  PerLeg<T, Articulated<L>> hip;

  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    const LegKinematics<L>& leg = k.legs[pass];
    const Vec3<L> pelvis_w = for_legs<T>(s.w_radps);
    Articulated<L> a = articulated(p.links[pass][kLegJoints - 1], leg.w_radps[kLegJoints - 1]);
    a.bias.n = a.bias.n - act.foot[pass].n;
    a.bias.f = a.bias.f - act.foot[pass].f;
    inwards([&](auto index) __attribute__((always_inline)) {
      constexpr std::size_t J = index;
      terms[pass][J] = reduce<Topology::kAxes[J]>(a, leg.w_radps[J], s.qd_radps[pass][J],
                                                  act.torque_nm[pass][J], act.armature_kgm2[pass][J]);
      const auto turn = leg.template turned<Topology, J>(p, pass);
      if constexpr (J > 0) {
        to_parent<Topology::kOffsets[J]>(turn, p.offsets_m[pass][J], leg.w_radps[J - 1], a);
        add_body(a, p.links[pass][J - 1], leg.w_radps[J - 1]);
      } else {
        to_parent<Topology::kOffsets[J]>(turn, p.offsets_m[pass][J], pelvis_w, a);
      }
    });
    hip[pass] = a;
  }

  // The legs' sum first, then the pelvis: the same order whether the legs are a SIMD batch or two passes.
  const auto both = [&](auto&& of) __attribute__((always_inline)) {
    std::array<L, kPasses> x;
    for (std::size_t pass = 0; pass < kPasses; ++pass) x[pass] = of(hip[pass]);
    return Legs<T>::sum(x);
  };
#define FURCULA_BOTH(what) both([](const Articulated<L>& x) __attribute__((always_inline)) { return x.what; })
  Articulated<T> a{{FURCULA_BOTH(i.xx), FURCULA_BOTH(i.xy), FURCULA_BOTH(i.xz), FURCULA_BOTH(i.yy),
                    FURCULA_BOTH(i.yz), FURCULA_BOTH(i.zz)},
                   {{FURCULA_BOTH(h.x.x), FURCULA_BOTH(h.x.y), FURCULA_BOTH(h.x.z)},
                    {FURCULA_BOTH(h.y.x), FURCULA_BOTH(h.y.y), FURCULA_BOTH(h.y.z)},
                    {FURCULA_BOTH(h.z.x), FURCULA_BOTH(h.z.y), FURCULA_BOTH(h.z.z)}},
                   {FURCULA_BOTH(m.xx), FURCULA_BOTH(m.xy), FURCULA_BOTH(m.xz), FURCULA_BOTH(m.yy),
                    FURCULA_BOTH(m.yz), FURCULA_BOTH(m.zz)},
                   {{FURCULA_BOTH(bias.n.x), FURCULA_BOTH(bias.n.y), FURCULA_BOTH(bias.n.z)},
                    {FURCULA_BOTH(bias.f.x), FURCULA_BOTH(bias.f.y), FURCULA_BOTH(bias.f.z)}}};
#undef FURCULA_BOTH
  add_body(a, p.pelvis, s.w_radps);
  // Seen from free fall, in which gravity acts on nothing.
  tree::Motion<T> pelvis;
  if constexpr (kHeld) {
    const T none = T(ValueOf<T>(0));
    pelvis = {{none, none, none}, -transposed_times(k.pelvis_rotation, act.gravity_mps2)};
  } else {
    pelvis = detail::solved(a);
  }
  out.wd_radps2 = pelvis.w;
  out.vd_mps2 = pelvis.v + transposed_times(k.pelvis_rotation, act.gravity_mps2) - cross(s.w_radps, s.v_mps);

  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    const LegKinematics<L>& leg = k.legs[pass];
    Vec3<L> w = for_legs<T>(s.w_radps), aw = for_legs<T>(pelvis.w), av = for_legs<T>(pelvis.v);
    outwards([&](auto index) __attribute__((always_inline)) {
      constexpr std::size_t J = index;
      constexpr Axis kAxis = Topology::kAxes[J];
      constexpr unsigned kMask = Topology::kOffsets[J];
      const Vec3<L>& r = p.offsets_m[pass][J];
      const auto turn = leg.template turned<Topology, J>(p, pass);
      if constexpr (kMask != 0) av = plus_cross<kMask>(av, -r, aw) + centripetal<kMask>(w, r);
      av = turn.in(av);
      aw = axis_to_z<kAxis>(turn.in(aw));
      w = leg.w_radps[J];
      const Vec3<L> wz = axis_to_z<kAxis>(w);
      const L qd = s.qd_radps[pass][J];
      aw.x += wz.y * qd;
      aw.y -= wz.x * qd;
      aw = z_to_axis<kAxis>(aw);
      const JointTerms<L>& t = terms[pass][J];
      const L qdd = (t.torque_nm - (dot(t.column.n, aw) + dot(t.column.f, av))) * t.inverse_kgm2;
      out.qdd_radps2[pass][J] = qdd;
      along<kAxis>(aw) += qdd;
    });
  }
}

/// The same, with the kinematics computed here.
template <class Topology = DesignTopology, bool kHeld = false, class P, class T>
Accelerations<T> accelerations(const P& p, const State<T>& s, const Actions<T>& act) {
  Kinematics<T> k;
  kinematics<Topology>(p, s, k);
  Accelerations<T> out;
  forward_dynamics<Topology, kHeld>(p, s, k, act, out);
  return out;
}

}  // namespace furcula::dynamics::biped
