// The feet's 8 vertices on the ground z = 0: a spring and a damper along the normal, Coulomb friction about an anchor.
//
// With penetration d = -x_z, velocity u and anchor a of a vertex:
//   N = d > 0 ? max(0, kn d - dn u_z min(1, d/d0)) : 0       no jump at touch-down, no pull at lift-off
//   t = kt (a - x_xy) - dt u_xy;  F = t min(1, mu N / |t|),  |t| = sqrt(t.t + 1e-12)
//   a <- x_xy + (F + dt u_xy) / kt                           constant in stick, follows the vertex in slip
// In flight F = 0 and the anchor is placed where friction is zero, so friction is continuous at touch-down (docs/decisions/0034).
#pragma once

#include "furcula/dynamics/biped/forward_dynamics.hpp"

namespace furcula::dynamics::biped {

/// Ground force on a vertex and its new anchor, world axes.
template <class L>
struct VertexForce {
  Vec3<L> force_n;            ///< z: normal force, >= 0; x, y: friction
  std::array<L, 2> anchor_m;  ///< x and y of the anchor after this evaluation
};

/// Force on a vertex at `x` with velocity `u` and anchor `anchor` (x, y), world axes, by the equations above.
/// `inverse_full_damping` is 1 / full_damping_m, `inverse_shear` 1 / shear_stiffness_npm.
template <class L>
FURCULA_INLINE VertexForce<L> vertex_force(const Ground<L>& g, const L& inverse_full_damping,
                                           const L& inverse_shear, const Vec3<L>& x, const Vec3<L>& u,
                                           const std::array<L, 2>& anchor) {
  using V = ValueOf<L>;
  const L zero = L(V(0)), one = L(V(1)), d = -x.z;
  const auto touches = d > V(0);
  const L push = g.stiffness_npm * d - g.damping_nspm * u.z * smaller(L(d * inverse_full_damping), one);
  const L n = select(touches, larger(push, zero), zero);
  const L ux = g.shear_damping_nspm * u.x, uy = g.shear_damping_nspm * u.y;
  const L tx = g.shear_stiffness_npm * (anchor[0] - x.x) - ux,
          ty = g.shear_stiffness_npm * (anchor[1] - x.y) - uy;
  const L size = square_root(L(tx * tx + ty * ty + V(1e-12)));
  const L share = smaller(L(g.friction * n / size), one);
  const L fx = tx * share, fy = ty * share;
  return {{fx, fy, n}, {x.x + (fx + ux) * inverse_shear, x.y + (fy + uy) * inverse_shear}};
}

/// Normal forces and anchors of both feet.
template <class T>
struct FootContact {
  using L = LegScalar<T>;   ///< the scalar of a leg's numbers
  PerLeg<T, L> normal_n{};  ///< sum over the foot's vertices
  PerLeg<T, std::array<std::array<L, 2>, kVertices>>
      anchors_m{};  ///< [pass][vertex][x, y]: anchors after this evaluation, world
};

/// Contact wrenches for forward_dynamics, about the feet's origins, in their axes. `k` is kinematics() of `s`. The state's anchors
/// are not changed: step() writes them, once a step.
template <class T>
FURCULA_INLINE void contact(const Parameters<T>& p, const State<T>& s, const Kinematics<T>& k,
                            PerLeg<T, Force<LegScalar<T>>>& wrench, FootContact<T>& out) {
  using L = LegScalar<T>;
  using V = ValueOf<T>;
  const Ground<L> g{L(p.ground.stiffness_npm),      L(p.ground.damping_nspm),
                    L(p.ground.full_damping_m),     L(p.ground.shear_stiffness_npm),
                    L(p.ground.shear_damping_nspm), L(p.ground.friction)};
  const L inverse_full = V(1) / g.full_damping_m, inverse_shear = V(1) / g.shear_stiffness_npm;
  const L zero = L(V(0));
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass) {
    const LegKinematics<L>& leg = k.legs[pass];
    const Vec3<L> v = leg.foot_rotation * leg.foot_v_mps, w = leg.foot_rotation * leg.w_radps[kLegJoints - 1];
    Vec3<L> force{zero, zero, zero}, moment{zero, zero, zero};
    for (std::size_t i = 0; i < kVertices; ++i) {
      const Vec3<L> arm = leg.foot_rotation * p.vertices_m[pass][i];
      const VertexForce<L> f = vertex_force(g, inverse_full, inverse_shear, leg.foot_position_m + arm,
                                            v + cross(w, arm), s.anchors_m[pass][i]);
      out.anchors_m[pass][i] = f.anchor_m;
      force += f.force_n;
      moment += cross(arm, f.force_n);
    }
    out.normal_n[pass] = force.z;
    wrench[pass] = {transposed_times(leg.foot_rotation, moment), transposed_times(leg.foot_rotation, force)};
  }
}

}  // namespace furcula::dynamics::biped
