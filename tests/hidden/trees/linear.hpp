// Vectors, rotations and a small dense solver for the blind suite's robots, written for this folder alone.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace furcula::hidden::trees {

inline constexpr std::size_t kMost = 9;  ///< joints, a hidden resonator included
using Values = std::array<double, kMost>;
using Matrix = std::array<Values, kMost>;

struct Vec3 {
  double x = 0.0, y = 0.0, z = 0.0;
};

inline Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double length(Vec3 a) { return std::sqrt(dot(a, a)); }

/// By rows.
struct Mat3 {
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
};

inline Vec3 operator*(const Mat3& m, Vec3 v) { return {dot(m.x, v), dot(m.y, v), dot(m.z, v)}; }
inline Mat3 transposed(const Mat3& m) {
  return {{m.x.x, m.y.x, m.z.x}, {m.x.y, m.y.y, m.z.y}, {m.x.z, m.y.z, m.z.z}};
}
inline Mat3 operator*(const Mat3& a, const Mat3& b) {
  const Mat3 t = transposed(b);
  return {t * a.x, t * a.y, t * a.z};
}
inline Mat3 operator*(double s, const Mat3& m) { return {s * m.x, s * m.y, s * m.z}; }
inline Mat3 operator+(const Mat3& a, const Mat3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Mat3 diagonal(Vec3 d) { return {{d.x, 0, 0}, {0, d.y, 0}, {0, 0, d.z}}; }

/// Turn by `angle_rad` about a unit axis (Rodrigues).
inline Mat3 turn_about(Vec3 a, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad), k = 1.0 - c;
  return {{c + k * a.x * a.x, k * a.x * a.y - s * a.z, k * a.x * a.z + s * a.y},
          {k * a.x * a.y + s * a.z, c + k * a.y * a.y, k * a.y * a.z - s * a.x},
          {k * a.x * a.z - s * a.y, k * a.y * a.z + s * a.x, c + k * a.z * a.z}};
}

/// The URDF's angles: roll about x, then pitch about y, then yaw about z, all fixed axes, rad.
inline Mat3 turn_of(Vec3 rpy) {
  return turn_about({0, 0, 1}, rpy.z) * turn_about({0, 1, 0}, rpy.y) * turn_about({1, 0, 0}, rpy.x);
}

/// Lower Cholesky factor of the leading n x n block of a positive definite matrix. Reads the lower half.
inline Matrix cholesky(const Matrix& a, std::size_t n) {
  Matrix l{};
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j <= i; ++j) {
      double sum = a[i][j];
      for (std::size_t k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      l[i][j] = i == j ? std::sqrt(sum) : sum / l[j][j];
    }
  return l;
}

/// x of L L' x = b.
inline Values solved(const Matrix& l, const Values& b, std::size_t n) {
  Values x{};
  for (std::size_t i = 0; i < n; ++i) {
    double sum = b[i];
    for (std::size_t k = 0; k < i; ++k) sum -= l[i][k] * x[k];
    x[i] = sum / l[i][i];
  }
  for (std::size_t i = n; i-- > 0;) {
    double sum = x[i];
    for (std::size_t k = i + 1; k < n; ++k) sum -= l[k][i] * x[k];
    x[i] = sum / l[i][i];
  }
  return x;
}

}  // namespace furcula::hidden::trees
