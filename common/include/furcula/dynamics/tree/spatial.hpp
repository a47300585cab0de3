// Vectors, rotations and inertias of rigid bodies.
//
// Written by components: a compiler then keeps them in registers for every scalar, without loops to unroll.
// Spatial vectors are pairs of such vectors, angular first (Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 2).
#pragma once

#include <utility>

namespace furcula::dynamics::tree {

/// The type of a product: plain numbers times dual numbers are dual numbers.
template <class A, class B>
using Product = decltype(std::declval<A>() * std::declval<B>());

/// A vector by its components.
template <class T>
struct Vec3 {
  T x,    ///< first component
      y,  ///< second component
      z;  ///< third component
};

/// Sum by components.
template <class A, class B>
constexpr Vec3<Product<A, B>> operator+(const Vec3<A>& a, const Vec3<B>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
/// Difference by components.
template <class A, class B>
constexpr Vec3<Product<A, B>> operator-(const Vec3<A>& a, const Vec3<B>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
/// The opposite vector.
template <class T>
constexpr Vec3<T> operator-(const Vec3<T>& a) {
  return {-a.x, -a.y, -a.z};
}
/// Vector times scalar.
template <class A, class B>
constexpr Vec3<Product<A, B>> operator*(const Vec3<A>& a, const B& b) {
  return {a.x * b, a.y * b, a.z * b};
}
/// Adds a vector.
template <class T>
constexpr Vec3<T>& operator+=(Vec3<T>& a, const Vec3<T>& b) {
  return a = a + b;
}
/// Scalar product.
template <class A, class B>
constexpr Product<A, B> dot(const Vec3<A>& a, const Vec3<B>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
/// Vector product.
template <class A, class B>
constexpr Vec3<Product<A, B>> cross(const Vec3<A>& a, const Vec3<B>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A 3 x 3 matrix by rows.
template <class T>
struct Mat3 {
  Vec3<T> x,  ///< first row
      y,      ///< second row
      z;      ///< third row
};

/// The identity matrix.
template <class T>
constexpr Mat3<T> identity() {
  return {{T(1), T(0), T(0)}, {T(0), T(1), T(0)}, {T(0), T(0), T(1)}};
}
/// The transposed matrix.
template <class T>
constexpr Mat3<T> transposed(const Mat3<T>& m) {
  return {{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}};
}
/// Matrix times vector.
template <class A, class B>
constexpr Vec3<Product<A, B>> operator*(const Mat3<A>& m, const Vec3<B>& v) {
  return {dot(m.x, v), dot(m.y, v), dot(m.z, v)};
}
/// m' v, without forming the transpose.
template <class A, class B>
constexpr Vec3<Product<A, B>> transposed_times(const Mat3<A>& m, const Vec3<B>& v) {
  return {m.x.x * v.x + m.y.x * v.y + m.z.x * v.z, m.x.y * v.x + m.y.y * v.y + m.z.y * v.z,
          m.x.z * v.x + m.y.z * v.y + m.z.z * v.z};
}
/// Matrix product.
template <class A, class B>
constexpr Mat3<Product<A, B>> operator*(const Mat3<A>& a, const Mat3<B>& b) {
  return {transposed_times(b, a.x), transposed_times(b, a.y), transposed_times(b, a.z)};
}

/// A symmetric 3 x 3 matrix by the entries of its upper triangle.
template <class T>
struct Sym3 {
  T xx,    ///< row 1, column 1
      xy,  ///< row 1, column 2
      xz,  ///< row 1, column 3
      yy,  ///< row 2, column 2
      yz,  ///< row 2, column 3
      zz;  ///< row 3, column 3
};

/// Sum by entries.
template <class A, class B>
constexpr Sym3<Product<A, B>> operator+(const Sym3<A>& a, const Sym3<B>& b) {
  return {a.xx + b.xx, a.xy + b.xy, a.xz + b.xz, a.yy + b.yy, a.yz + b.yz, a.zz + b.zz};
}
/// Matrix times vector.
template <class A, class B>
constexpr Vec3<Product<A, B>> operator*(const Sym3<A>& s, const Vec3<B>& v) {
  return {s.xx * v.x + s.xy * v.y + s.xz * v.z, s.xy * v.x + s.yy * v.y + s.yz * v.z,
          s.xz * v.x + s.yz * v.y + s.zz * v.z};
}
/// s - u u' d.
template <class T>
constexpr Sym3<T> less_outer(const Sym3<T>& s, const Vec3<T>& u, const T& d) {
  const Vec3<T> k = u * d;
  return {s.xx - k.x * u.x, s.xy - k.x * u.y, s.xz - k.x * u.z,
          s.yy - k.y * u.y, s.yz - k.y * u.z, s.zz - k.z * u.z};
}
/// m' s m: where m is a frame's `turn`, a matrix in the frame's axes, in the parent's.
template <class A, class B>
[[gnu::always_inline]] constexpr Sym3<Product<A, B>> turned_back(const Mat3<A>& m, const Sym3<B>& s) {
  using P = Product<A, B>;
  const Vec3<A> cx{m.x.x, m.y.x, m.z.x}, cy{m.x.y, m.y.y, m.z.y}, cz{m.x.z, m.y.z, m.z.z};
  const Vec3<P> sx = s * cx, sy = s * cy, sz = s * cz;
  return {dot(cx, sx), dot(cx, sy), dot(cx, sz), dot(cy, sy), dot(cy, sz), dot(cz, sz)};
}
/// -[a]x [a]x: the inertia of a unit point mass at `a` about the origin.
template <class T>
constexpr Sym3<T> minus_squared_cross(const Vec3<T>& a) {
  return {a.y * a.y + a.z * a.z, -(a.x * a.y), -(a.x * a.z),
          a.x * a.x + a.z * a.z, -(a.y * a.z), a.x * a.x + a.y * a.y};
}

/// Spatial motion (velocity or acceleration) at a frame's origin, in its axes.
template <class T>
struct Motion {
  Vec3<T> w,  ///< angular part, rad/s or rad/s^2
      v;      ///< linear part, m/s or m/s^2
};
/// Spatial force, or momentum, at a frame's origin, in its axes.
template <class T>
struct Force {
  Vec3<T> n,  ///< moment about the origin, N m; or angular momentum, N m s
      f;      ///< force, N; or linear momentum, N s
};

/// Sum of motions at the same frame.
template <class T>
constexpr Motion<T> operator+(const Motion<T>& a, const Motion<T>& b) {
  return {a.w + b.w, a.v + b.v};
}
/// Sum of forces at the same frame.
template <class T>
constexpr Force<T> operator+(const Force<T>& a, const Force<T>& b) {
  return {a.n + b.n, a.f + b.f};
}
/// Adds a force at the same frame.
template <class T>
constexpr Force<T>& operator+=(Force<T>& a, const Force<T>& b) {
  return a = a + b;
}
/// Power of a force at a velocity: n . w + f . v.
template <class A, class B>
constexpr Product<A, B> dot(const Motion<A>& m, const Force<B>& f) {
  return dot(m.w, f.n) + dot(m.v, f.f);
}
/// Rate of a spatial force that is constant in a frame moving with `m` (Featherstone's crf).
template <class A, class B>
constexpr Force<Product<A, B>> cross(const Motion<A>& m, const Force<B>& f) {
  return {cross(m.w, f.n) + cross(m.v, f.f), cross(m.w, f.f)};
}

/// Pose of a frame in its parent frame: the Pluecker transform in 12 numbers.
template <class T>
struct Frame {
  Mat3<T> turn;  ///< rotation from parent to frame coordinates
  Vec3<T> at;    ///< origin of the frame in parent coordinates, m

  /// A motion given in the parent, in the frame.
  template <class B>
  constexpr Motion<Product<T, B>> motion(const Motion<B>& m) const {
    return {turn * m.w, turn * (m.v + cross(m.w, at))};
  }
  /// A force given in the frame, in the parent.
  template <class B>
  constexpr Force<Product<T, B>> force_back(const Force<B>& f) const {
    const auto force = transposed_times(turn, f.f);
    return {transposed_times(turn, f.n) + cross(at, force), force};
  }
  /// Position of a point given in the frame, in the parent.
  template <class B>
  constexpr Vec3<Product<T, B>> point_back(const Vec3<B>& p) const {
    return transposed_times(turn, p) + at;
  }
};

/// Composition: the pose of `inner`, given in `outer`, in the parent of `outer`.
template <class A, class B>
constexpr Frame<Product<A, B>> within(const Frame<A>& outer, const Frame<B>& inner) {
  return {inner.turn * outer.turn, outer.point_back(inner.at)};
}

/// Inertial parameters of a rigid body about a frame's origin, in its axes: the equations of motion are linear in these ten
/// numbers.
template <class T>
struct Inertia {
  T mass_kg;             ///< of the body
  Vec3<T> moment_kgm;    ///< mass times position of the centre of mass
  Sym3<T> inertia_kgm2;  ///< about the origin

  /// Spatial momentum at a velocity, or the force for an acceleration at rest.
  constexpr Force<T> times(const Motion<T>& m) const {
    return {inertia_kgm2 * m.w + cross(moment_kgm, m.v), m.v * mass_kg - cross(moment_kgm, m.w)};
  }
};

/// Inertia of two bodies joined, both about the same frame's origin.
template <class A, class B>
constexpr Inertia<Product<A, B>> operator+(const Inertia<A>& a, const Inertia<B>& b) {
  return {a.mass_kg + b.mass_kg, a.moment_kgm + b.moment_kgm, a.inertia_kgm2 + b.inertia_kgm2};
}

/// Inertia about the frame's origin from that about the centre of mass, which is at `centre_m`; all in the frame's axes.
template <class T>
constexpr Inertia<T> inertia_of(const T& mass_kg, const Vec3<T>& centre_m, const Sym3<T>& about_centre_kgm2) {
  const Sym3<T> s = minus_squared_cross(centre_m);
  return {mass_kg, centre_m * mass_kg,
          about_centre_kgm2 + Sym3<T>{s.xx * mass_kg, s.xy * mass_kg, s.xz * mass_kg, s.yy * mass_kg,
                                      s.yz * mass_kg, s.zz * mass_kg}};
}

/// The inertia `b`, given in `frame`, in the parent of the frame.
template <class A, class B>
constexpr Inertia<Product<A, B>> inertia_back(const Frame<A>& frame, const Inertia<B>& b) {
  const auto h = transposed_times(frame.turn, b.moment_kgm);
  const auto i = turned_back(frame.turn, b.inertia_kgm2);
  // Steiner twice, by the first moment: I - [r]x[h]x - [h]x[r]x - m [r]x[r]x
  const auto& r = frame.at;
  const auto s = minus_squared_cross(r);
  const auto two = dot(r, h) + dot(r, h);
  return {
      b.mass_kg * A(1),
      h + r * b.mass_kg,
      {i.xx + s.xx * b.mass_kg + (two - (r.x * h.x + h.x * r.x)),
       i.xy + s.xy * b.mass_kg - (r.x * h.y + h.x * r.y), i.xz + s.xz * b.mass_kg - (r.x * h.z + h.x * r.z),
       i.yy + s.yy * b.mass_kg + (two - (r.y * h.y + h.y * r.y)),
       i.yz + s.yz * b.mass_kg - (r.y * h.z + h.y * r.z),
       i.zz + s.zz * b.mass_kg + (two - (r.z * h.z + h.z * r.z))}};
}

/// Rotation by an angle about z, as `turn` of a Frame.
template <class T>
constexpr Mat3<T> turn_about_z(const T& cosine, const T& sine) {
  return {{cosine, sine, T(0)}, {-sine, cosine, T(0)}, {T(0), T(0), T(1)}};
}

}  // namespace furcula::dynamics::tree
