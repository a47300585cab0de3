// The biped's state, its accelerations, and how the pelvis' attitude is kept.
#pragma once

#include "furcula/dynamics/biped/topology.hpp"

namespace furcula::dynamics::biped {

/// Of unit length: the pelvis' axes in the world's.
template <class T>
struct Quaternion {
  T w, x, y, z;
};

/// Columns: the pelvis' axes in the world. Pelvis' coordinates to the world's.
template <class T>
FURCULA_INLINE Mat3<T> rotation(const Quaternion<T>& a) {
  using V = ValueOf<T>;
  const T x2 = a.x + a.x, y2 = a.y + a.y, z2 = a.z + a.z;
  const T xx = a.x * x2, yy = a.y * y2, zz = a.z * z2, xy = a.x * y2, xz = a.x * z2, yz = a.y * z2;
  const T wx = a.w * x2, wy = a.w * y2, wz = a.w * z2;
  return {{V(1) - (yy + zz), xy - wz, xz + wy},
          {xy + wz, V(1) - (xx + zz), yz - wx},
          {xz - wy, yz + wx, V(1) - (xx + yy)}};
}

/// Its rate under an angular velocity in the pelvis' axes: a (0, w) / 2.
template <class T>
FURCULA_INLINE Quaternion<T> rate(const Quaternion<T>& a, const Vec3<T>& w) {
  const Vec3<T> h = w * ValueOf<T>(0.5);
  return {-(a.x * h.x + a.y * h.y + a.z * h.z), a.w * h.x + a.y * h.z - a.z * h.y,
          a.w * h.y + a.z * h.x - a.x * h.z, a.w * h.z + a.x * h.y - a.y * h.x};
}

/// One step of Newton's towards length 1: an error of e leaves 1.5 e^2.
template <class T>
FURCULA_INLINE Quaternion<T> normalised(const Quaternion<T>& a) {
  using V = ValueOf<T>;
  const T k = V(1.5) - V(0.5) * (a.w * a.w + a.x * a.x + a.y * a.y + a.z * a.z);
  return {a.w * k, a.x * k, a.y * k, a.z * k};
}

/// World: the ground's frame, in which the ground is z = 0. w and v are of the pelvis frame P: angular velocity and the
/// velocity of its origin, both in its axes.
template <class T>
struct State {
  using L = LegScalar<T>;
  using V = ValueOf<T>;

  Vec3<T> position_m{T(V(0)), T(V(0)), T(V(0))};  ///< of P's origin, world
  Quaternion<T> attitude{T(V(1)), T(V(0)), T(V(0)), T(V(0))};
  Vec3<T> w_radps{T(V(0)), T(V(0)), T(V(0))};
  Vec3<T> v_mps{T(V(0)), T(V(0)), T(V(0))};
  Joints<T> q_rad{}, qd_radps{};
  /// Where each vertex holds on to the ground, world x and y.
  PerLeg<T, std::array<std::array<L, 2>, kVertices>> anchors_m{};
  /// Of the clutches' motors as seen at the joint, where a clutch is open; else the joint's.
  PerLeg<T, std::array<L, kClutches>> rotors_rad{}, rotors_radps{};

  State() {
    const L zero = L(V(0));
    for (auto* of : {&q_rad, &qd_radps})
      for (auto& leg : *of) leg.fill(zero);
    for (auto& leg : anchors_m)
      for (auto& a : leg) a = {zero, zero};
    for (auto* of : {&rotors_rad, &rotors_radps})
      for (auto& leg : *of) leg.fill(zero);
  }
};

/// Derivatives of the components of w, v and qd.
template <class T>
struct Accelerations {
  Vec3<T> wd_radps2, vd_mps2;
  Joints<T> qdd_radps2;
};

/// Of the pelvis and of the joints: what M^-1 makes of an impulse.
template <class T>
FURCULA_INLINE void kick(State<T>& s, const Accelerations<T>& by, const T& times) {
  s.w_radps += by.wd_radps2 * times;
  s.v_mps += by.vd_mps2 * times;
  const LegScalar<T> k = LegScalar<T>(times);
  for (std::size_t p = 0; p < Legs<T>::kPasses; ++p)
    for (std::size_t j = 0; j < kLegJoints; ++j) s.qd_radps[p][j] += by.qdd_radps2[p][j] * k;
}

}  // namespace furcula::dynamics::biped
