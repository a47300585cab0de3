// The biped's tree, known at compile time: a floating pelvis and two legs of six revolute joints each.
//
// Both legs share one code. For one robot in double, a leg's numbers are SIMD pairs, {left, right}; for other scalars the code
// runs twice, in two passes. The mirrored geometry of the right leg is in its constants (parameters.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "furcula/dynamics/simd_batch.hpp"
#include "furcula/dynamics/tree/spatial.hpp"

namespace furcula::dynamics::biped {

using tree::Force;
using tree::Inertia;
using tree::Mat3;
using tree::Sym3;
using tree::Vec3;

/// Axis of a joint in its link.
enum class Axis : unsigned char { x, y, z };
/// Index of a leg.
enum Side : std::size_t { kLeft, kRight };
/// Index of a joint in its leg, from the hip outwards.
enum LegJoint : std::size_t { kHipYaw, kHipRoll, kHipPitch, kKnee, kAnklePitch, kAnkleRoll };
/// A leg's clutches: the joints that have modes (joint_laws.hpp).
enum LegClutch : std::size_t { kHipClutch, kKneeClutch };

/// Joints of a leg.
inline constexpr std::size_t kLegJoints = 6;
inline constexpr std::size_t kJoints = 2 * kLegJoints;   ///< of both legs: the left leg's, then the right's
inline constexpr std::size_t kVertices = 4;              ///< of a foot's sole
inline constexpr std::size_t kClutches = 2;              ///< of a leg
inline constexpr std::size_t kVelocities = 6 + kJoints;  ///< degrees of freedom: pelvis and joints

/// The joint of each clutch, by LegClutch.
inline constexpr std::array<LegJoint, kClutches> kClutchJoints{kHipPitch, kKnee};

/// Names by LegJoint, as in the URDF without the side.
inline constexpr std::array<std::string_view, kLegJoints> kLegJointNames{
    "hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll"};

/// The design's joint axes, and the components of joint positions that may differ from zero: the others are left out of the equations.
struct DesignTopology {
  /// Axis of each joint, the same in link and parent.
  static constexpr std::array<Axis, kLegJoints> kAxes{Axis::z, Axis::x, Axis::y, Axis::y, Axis::y, Axis::x};
  /// Bit mask for each joint's position in its parent (bit 0: x, 1: y, 2: z).
  static constexpr std::array<unsigned, kLegJoints> kOffsets{6, 4, 0, 4, 4, 0};
};
/// The same axes with joints at any position in their parents: for fits of the positions, and for joint frames that are rotated
/// against their parents (TurnedParameters).
struct AnywhereTopology {
  /// Axis of each joint, in the link and, at angle zero, in the joint's frame.
  static constexpr std::array<Axis, kLegJoints> kAxes = DesignTopology::kAxes;
  /// All components may differ from zero.
  static constexpr std::array<unsigned, kLegJoints> kOffsets{7, 7, 7, 7, 7, 7};
};

/// Storage of a leg's numbers for a robot of scalar T: the legs are computed in two passes.
template <class T>
struct Legs {
  using Scalar = T;                          ///< the scalar of a leg's numbers
  static constexpr std::size_t kPasses = 2;  ///< how often the code of a leg runs
  /// The pass that computes leg `side` (Side).
  static constexpr std::size_t pass(std::size_t side) { return side; }
  /// The number of leg `side` in x, which is of that leg's pass.
  FURCULA_INLINE static T read(const T& x, std::size_t) { return x; }
  /// Sets the number of leg `side` in x.
  FURCULA_INLINE static void write(T& x, std::size_t, const T& value) { x = value; }
  /// Sum of a number over both legs, given by passes.
  FURCULA_INLINE static T sum(const std::array<T, 2>& x) { return x[0] + x[1]; }
};
/// In double both legs are computed in one pass, as a SIMD pair.
template <>
struct Legs<double> {
  using Scalar = SimdBatch<double, 2>;       ///< {left, right}
  static constexpr std::size_t kPasses = 1;  ///< both legs at once
  /// Always 0.
  static constexpr std::size_t pass(std::size_t) { return 0; }
  /// The number of leg `side`.
  FURCULA_INLINE static double read(const Scalar& x, std::size_t side) { return x[side]; }
  /// Sets the number of leg `side`; the other leg's stays.
  FURCULA_INLINE static void write(Scalar& x, std::size_t side, double value) { x.set(side, value); }
  /// Sum over both legs.
  FURCULA_INLINE static double sum(const std::array<Scalar, 1>& x) { return x[0][0] + x[0][1]; }
};

/// The scalar of a leg's numbers for a robot of scalar T.
template <class T>
using LegScalar = typename Legs<T>::Scalar;

/// An X for each leg, by passes: index with `Legs<T>::pass(side)`.
template <class T, class X>
using PerLeg = std::array<X, Legs<T>::kPasses>;

/// One number for each joint: [pass][LegJoint].
template <class T>
using Joints = PerLeg<T, std::array<LegScalar<T>, kLegJoints>>;

/// The number of joint `i`, 0 to kJoints - 1.
template <class T>
FURCULA_INLINE T joint(const Joints<T>& of, std::size_t i) {
  const std::size_t side = i / kLegJoints;
  return Legs<T>::read(of[Legs<T>::pass(side)][i % kLegJoints], side);
}
/// Sets the number of joint `i`, 0 to kJoints - 1.
template <class T>
FURCULA_INLINE void set_joint(Joints<T>& of, std::size_t i, const T& value) {
  const std::size_t side = i / kLegJoints;
  Legs<T>::write(of[Legs<T>::pass(side)][i % kLegJoints], side, value);
}

/// The same vector for both legs.
template <class T>
FURCULA_INLINE Vec3<LegScalar<T>> for_legs(const Vec3<T>& v) {
  using L = LegScalar<T>;
  return {L(v.x), L(v.y), L(v.z)};
}
/// The same matrix for both legs.
template <class T>
FURCULA_INLINE Mat3<LegScalar<T>> for_legs(const Mat3<T>& m) {
  return {for_legs<T>(m.x), for_legs<T>(m.y), for_legs<T>(m.z)};
}

/// The component of a vector along axis A.
template <Axis A, class T>
FURCULA_INLINE T& along(Vec3<T>& v) {
  if constexpr (A == Axis::x) return v.x;
  if constexpr (A == Axis::y) return v.y;
  if constexpr (A == Axis::z) return v.z;
}
/// The component of a vector along axis A.
template <Axis A, class T>
FURCULA_INLINE const T& along(const Vec3<T>& v) {
  return along<A>(const_cast<Vec3<T>&>(v));
}

/// Permutes the components cyclically so that axis A becomes z, which leaves cross products unchanged. It costs
/// no operation: an equation written for rotation about z then holds for every axis.
template <Axis A, class T>
FURCULA_INLINE Vec3<T> axis_to_z(const Vec3<T>& v) {
  if constexpr (A == Axis::x) return {v.y, v.z, v.x};
  if constexpr (A == Axis::y) return {v.z, v.x, v.y};
  if constexpr (A == Axis::z) return v;
}
/// The inverse of axis_to_z().
template <Axis A, class T>
FURCULA_INLINE Vec3<T> z_to_axis(const Vec3<T>& v) {
  if constexpr (A == Axis::x) return {v.z, v.x, v.y};
  if constexpr (A == Axis::y) return {v.y, v.z, v.x};
  if constexpr (A == Axis::z) return v;
}
/// The same permutation of rows and columns of a matrix.
template <Axis A, class T>
FURCULA_INLINE Mat3<T> axis_to_z(const Mat3<T>& m) {
  const Mat3<T> in{axis_to_z<A>(m.x), axis_to_z<A>(m.y), axis_to_z<A>(m.z)};
  if constexpr (A == Axis::x) return {in.y, in.z, in.x};
  if constexpr (A == Axis::y) return {in.z, in.x, in.y};
  if constexpr (A == Axis::z) return in;
}
/// The inverse of axis_to_z().
template <Axis A, class T>
FURCULA_INLINE Mat3<T> z_to_axis(const Mat3<T>& m) {
  const Mat3<T> in{z_to_axis<A>(m.x), z_to_axis<A>(m.y), z_to_axis<A>(m.z)};
  if constexpr (A == Axis::x) return {in.z, in.x, in.y};
  if constexpr (A == Axis::y) return {in.y, in.z, in.x};
  if constexpr (A == Axis::z) return in;
}
/// The same permutation of rows and columns of a symmetric matrix.
template <Axis A, class T>
FURCULA_INLINE Sym3<T> axis_to_z(const Sym3<T>& s) {
  if constexpr (A == Axis::x) return {s.yy, s.yz, s.xy, s.zz, s.xz, s.xx};
  if constexpr (A == Axis::y) return {s.zz, s.xz, s.yz, s.xx, s.xy, s.yy};
  if constexpr (A == Axis::z) return s;
}
/// The inverse of axis_to_z().
template <Axis A, class T>
FURCULA_INLINE Sym3<T> z_to_axis(const Sym3<T>& s) {
  if constexpr (A == Axis::x) return {s.zz, s.xz, s.yz, s.xx, s.xy, s.yy};
  if constexpr (A == Axis::y) return {s.yy, s.yz, s.xy, s.zz, s.xz, s.xx};
  if constexpr (A == Axis::z) return s;
}

/// Rotation between parent and link by an angle about axis A.
template <Axis A, class T>
struct Turn {
  T c,    ///< cosine of the angle
      s;  ///< sine of the angle

  /// Parent's coordinates to the link's.
  FURCULA_INLINE Vec3<T> in(const Vec3<T>& parents) const {
    const Vec3<T> v = axis_to_z<A>(parents);
    return z_to_axis<A>(Vec3<T>{c * v.x + s * v.y, c * v.y - s * v.x, v.z});
  }
  /// Link's coordinates to the parent's.
  FURCULA_INLINE Vec3<T> back(const Vec3<T>& links) const {
    const Vec3<T> v = axis_to_z<A>(links);
    return z_to_axis<A>(Vec3<T>{c * v.x - s * v.y, s * v.x + c * v.y, v.z});
  }
  /// A symmetric matrix in link coordinates, in the parent's. With c c + s s = 1 the rotated block needs four products.
  FURCULA_INLINE Sym3<T> back(const Sym3<T>& links) const {
    const Sym3<T> m = axis_to_z<A>(links);
    const T u = s * (m.xx - m.yy) + c * (m.xy + m.xy), su = s * u;
    return z_to_axis<A>(
        Sym3<T>{m.xx - su, c * u - m.xy, c * m.xz - s * m.yz, m.yy + su, s * m.xz + c * m.yz, m.zz});
  }
  /// A matrix in link coordinates, in the parent's.
  FURCULA_INLINE Mat3<T> back(const Mat3<T>& links) const {
    const Mat3<T> m = axis_to_z<A>(links);
    const T u = s * (m.x.x - m.y.y) + c * (m.x.y + m.y.x), su = s * u, cu = c * u;
    return z_to_axis<A>(Mat3<T>{{m.x.x - su, cu - m.y.x, c * m.x.z - s * m.y.z},
                                {cu - m.x.y, m.y.y + su, s * m.x.z + c * m.y.z},
                                {c * m.z.x - s * m.z.y, s * m.z.x + c * m.z.y, m.z.z}});
  }
};

/// Rotation by an angle about axis A after a fixed rotation of the joint's frame against the parent.
template <Axis A, class T>
struct TurnBehind {
  Turn<A, T> turn;       ///< by the joint angle
  const Mat3<T>& frame;  ///< from parent coordinates to those of the joint at angle zero

  /// Parent's coordinates to the link's.
  FURCULA_INLINE Vec3<T> in(const Vec3<T>& parents) const { return turn.in(frame * parents); }
  /// Link's coordinates to the parent's.
  FURCULA_INLINE Vec3<T> back(const Vec3<T>& links) const {
    return transposed_times(frame, turn.back(links));
  }
  /// A symmetric matrix in link coordinates, in the parent's.
  FURCULA_INLINE Sym3<T> back(const Sym3<T>& links) const {
    const Sym3<T> s = turn.back(links);
    // Rows of S F, of which F' takes the upper half.
    const Mat3<T> m = Mat3<T>{{s.xx, s.xy, s.xz}, {s.xy, s.yy, s.yz}, {s.xz, s.yz, s.zz}} * frame;
    const Mat3<T>& f = frame;
    const auto at = [](const T& a, const T& b, const T& c, const T& x, const T& y, const T& z) {
      return T(a * x + b * y + c * z);
    };
    return {at(f.x.x, f.y.x, f.z.x, m.x.x, m.y.x, m.z.x), at(f.x.x, f.y.x, f.z.x, m.x.y, m.y.y, m.z.y),
            at(f.x.x, f.y.x, f.z.x, m.x.z, m.y.z, m.z.z), at(f.x.y, f.y.y, f.z.y, m.x.y, m.y.y, m.z.y),
            at(f.x.y, f.y.y, f.z.y, m.x.z, m.y.z, m.z.z), at(f.x.z, f.y.z, f.z.z, m.x.z, m.y.z, m.z.z)};
  }
  /// A matrix in link coordinates, in the parent's.
  FURCULA_INLINE Mat3<T> back(const Mat3<T>& links) const {
    return transposed(frame) * (turn.back(links) * frame);
  }
};

}  // namespace furcula::dynamics::biped
