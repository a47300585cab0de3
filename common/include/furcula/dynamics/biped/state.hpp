// The biped's state and accelerations, and the quaternion of the pelvis' attitude.
#pragma once

#include "furcula/dynamics/biped/topology.hpp"

namespace furcula::dynamics::biped {

/// Attitude of the pelvis, of length 1: rotation from pelvis to world coordinates.
template <class T>
struct Quaternion {
  T w,    ///< scalar part
      x,  ///< vector part, x
      y,  ///< vector part, y
      z;  ///< vector part, z
};

/// Rotation matrix from pelvis to world coordinates; its columns are the pelvis' axes in the world.
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

/// Rate of the attitude at the angular velocity `w` in the pelvis' axes: a (0, w) / 2.
template <class T>
FURCULA_INLINE Quaternion<T> rate(const Quaternion<T>& a, const Vec3<T>& w) {
  const Vec3<T> h = w * ValueOf<T>(0.5);
  return {-(a.x * h.x + a.y * h.y + a.z * h.z), a.w * h.x + a.y * h.z - a.z * h.y,
          a.w * h.y + a.z * h.x - a.x * h.z, a.w * h.z + a.x * h.y - a.y * h.x};
}

/// One Newton step towards length 1: an error e of the length becomes 1.5 e^2.
template <class T>
FURCULA_INLINE Quaternion<T> normalised(const Quaternion<T>& a) {
  using V = ValueOf<T>;
  const T k = V(1.5) - V(0.5) * (a.w * a.w + a.x * a.x + a.y * a.y + a.z * a.z);
  return {a.w * k, a.x * k, a.y * k, a.z * k};
}

/// State of the biped. World is the ground's frame, in which the ground is z = 0. w and v are the angular velocity of the pelvis
/// frame P and the velocity of its origin, both in the axes of P. Arrays over legs: [pass].
template <class T>
struct State {
  using L = LegScalar<T>;  ///< the scalar of a leg's numbers
  using V = ValueOf<T>;    ///< the plain number behind the scalar T

  Vec3<T> position_m{T(V(0)), T(V(0)), T(V(0))};               ///< of the origin of P, world
  Quaternion<T> attitude{T(V(1)), T(V(0)), T(V(0)), T(V(0))};  ///< of P in the world
  Vec3<T> w_radps{T(V(0)), T(V(0)), T(V(0))};                  ///< angular velocity of P, in its axes
  Vec3<T> v_mps{T(V(0)), T(V(0)), T(V(0))};  ///< velocity of the origin of P, in the axes of P
  Joints<T> q_rad{},                         ///< joint angles
      qd_radps{};                            ///< joint rates
  /// Friction anchor of each vertex on the ground (contact.hpp): [pass][vertex][x, y], world.
  PerLeg<T, std::array<std::array<L, 2>, kVertices>> anchors_m{};
  /// [pass][LegClutch]: angles of the motors behind open clutches, as seen at the joint; of joined motors the joint's after a
  /// switched step.
  PerLeg<T, std::array<L, kClutches>> rotors_rad{}, rotors_radps{};  ///< their rates

  /// At rest at the world's origin, all angles 0.
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

/// Time derivatives of the components of w, v and qd (State).
template <class T>
struct Accelerations {
  Vec3<T> wd_radps2,     ///< of the angular velocity of P, in its axes
      vd_mps2;           ///< of the components of v in the rotating axes of P
  Joints<T> qdd_radps2;  ///< of the joint rates
};

/// Adds `by` times `times` (s, or an impulse where `by` is its unit response) to the velocities of pelvis and joints.
template <class T>
FURCULA_INLINE void kick(State<T>& s, const Accelerations<T>& by, const T& times) {
  s.w_radps += by.wd_radps2 * times;
  s.v_mps += by.vd_mps2 * times;
  const LegScalar<T> k = LegScalar<T>(times);
  for (std::size_t p = 0; p < Legs<T>::kPasses; ++p)
    for (std::size_t j = 0; j < kLegJoints; ++j) s.qd_radps[p][j] += by.qdd_radps2[p][j] * k;
}

}  // namespace furcula::dynamics::biped
