// Outward pass over the biped: rotations, velocities and the feet's positions.
#pragma once

#include <utility>

#include "furcula/dynamics/biped/parameters.hpp"
#include "furcula/dynamics/biped/state.hpp"
#include "furcula/dynamics/sine_cosine.hpp"

namespace furcula::dynamics::biped {

/// Calls f(std::integral_constant J) for the joints of a leg, from the hip to the foot.
template <class F>
FURCULA_INLINE void outwards(F&& f) {
  [&]<std::size_t... J>(std::index_sequence<J...>) __attribute__((always_inline)) {
    (f(std::integral_constant<std::size_t, J>{}), ...);
  }
  (std::make_index_sequence<kLegJoints>{});
}
/// Calls f(std::integral_constant J) for the joints of a leg, from the foot to the hip.
template <class F>
FURCULA_INLINE void inwards(F&& f) {
  [&]<std::size_t... J>(std::index_sequence<J...>) __attribute__((always_inline)) {
    (f(std::integral_constant<std::size_t, kLegJoints - 1 - J>{}), ...);
  }
  (std::make_index_sequence<kLegJoints>{});
}

/// sum + r x v, where only the components `kMask` of r are not zero (bit 0: x, 1: y, 2: z).
template <unsigned kMask, class T>
FURCULA_INLINE Vec3<T> plus_cross(const Vec3<T>& sum, const Vec3<T>& r, const Vec3<T>& v) {
  Vec3<T> out = sum;
  if constexpr ((kMask & 1) != 0) out.y -= r.x * v.z, out.z += r.x * v.y;
  if constexpr ((kMask & 2) != 0) out.x += r.y * v.z, out.z -= r.y * v.x;
  if constexpr ((kMask & 4) != 0) out.x -= r.z * v.y, out.y += r.z * v.x;
  return out;
}
/// sum + r, where only the components `kMask` of r are not zero.
template <unsigned kMask, class T>
FURCULA_INLINE Vec3<T> plus(const Vec3<T>& sum, const Vec3<T>& r) {
  Vec3<T> out = sum;
  if constexpr ((kMask & 1) != 0) out.x += r.x;
  if constexpr ((kMask & 2) != 0) out.y += r.y;
  if constexpr ((kMask & 4) != 0) out.z += r.z;
  return out;
}

/// Rotations and velocities of a leg.
template <class L>
struct LegKinematics {
  std::array<SineCosine<L>, kLegJoints> turn;  ///< sine and cosine of each joint angle
  std::array<Vec3<L>, kLegJoints> w_radps;     ///< angular velocity of each link, in its axes
  Vec3<L> foot_v_mps;                          ///< velocity of the foot's origin, in the foot's axes
  Mat3<L> foot_rotation;                       ///< from foot to world coordinates
  Vec3<L> foot_position_m;                     ///< position of the foot's origin, world

  /// The rotation from joint J's parent to its link (Turn or TurnBehind), for parameters `p` in pass `pass`.
  template <class Topology, std::size_t J, class P>
  FURCULA_INLINE auto turned(const P& p, std::size_t pass) const {
    const Turn<Topology::kAxes[J], L> by{turn[J].cosine, turn[J].sine};
    if constexpr (requires { p.frames; }) return TurnBehind<Topology::kAxes[J], L>{by, p.frames[pass][J]};
    if constexpr (!requires { p.frames; }) return by;
  }
};

/// Rotations and velocities of the robot at a state.
template <class T>
struct Kinematics {
  Mat3<T> pelvis_rotation;                      ///< from pelvis to world coordinates
  PerLeg<T, LegKinematics<LegScalar<T>>> legs;  ///< [pass]
};

/// Kinematics of state `s`. `p` is Parameters or TurnedParameters, here and wherever a template parameter is called P.
template <class Topology, class P, class T>
FURCULA_INLINE void kinematics(const P& p, const State<T>& s, Kinematics<T>& out) {
  using L = LegScalar<T>;
  out.pelvis_rotation = rotation(s.attitude);
  for (std::size_t pass = 0; pass < Legs<T>::kPasses; ++pass) {
    LegKinematics<L>& leg = out.legs[pass];
    for (std::size_t j = 0; j < kLegJoints; ++j) leg.turn[j] = sine_cosine(s.q_rad[pass][j]);
    Vec3<L> w = for_legs<T>(s.w_radps), v = for_legs<T>(s.v_mps), at = for_legs<T>(s.position_m);
    Mat3<L> r = for_legs<T>(out.pelvis_rotation);
    outwards([&](auto index) __attribute__((always_inline)) {
      constexpr std::size_t J = index;
      constexpr Axis kAxis = Topology::kAxes[J];
      constexpr unsigned kMask = Topology::kOffsets[J];
      const Vec3<L>& offset = p.offsets_m[pass][J];
      const auto turn = leg.template turned<Topology, J>(p, pass);
      v = turn.in(plus_cross<kMask>(v, -offset, w));
      w = turn.in(w);
      along<kAxis>(w) += s.qd_radps[pass][J];
      leg.w_radps[J] = w;
      if constexpr (kMask != 0) {
        const Vec3<L> o = plus<kMask>(Vec3<L>{L(0), L(0), L(0)}, offset);
        at += r * o;
      }
      r = {turn.in(r.x), turn.in(r.y), turn.in(r.z)};
    });
    leg.foot_v_mps = v;
    leg.foot_rotation = r;
    leg.foot_position_m = at;
  }
}

}  // namespace furcula::dynamics::biped
