// Accelerations of a robot whose toe may stand on the ground: M a = b + J' F with J a = -drift, F the ground's
// force. A leg moves in the plane of x and z, so J has these two rows.
#pragma once

#include "tests/hidden/trees/linear.hpp"

namespace furcula::hidden::trees {

/// In the plane of the leg.
struct Pair {
  double x = 0.0, z = 0.0;
};

class Pinned {
 public:
  struct Solution {
    Values a{};
    Pair force;
  };

  Pinned(const Matrix& mass, std::size_t n) : factor_(cholesky(mass, n)), n_(n) {}

  /// Holds a point whose speed each joint adds `x[j]`, `z[j]` to.
  void hold(const Values& x, const Values& z) {
    held_ = true;
    x_ = x;
    z_ = z;
    of_x_ = solved(factor_, x, n_);
    of_z_ = solved(factor_, z, n_);
    const double xx = along(x_, of_x_), xz = along(x_, of_z_), zz = along(z_, of_z_);
    const double det = xx * zz - xz * xz, trace = xx + zz;
    // Joints that are held can leave the point only one way to go, or none.
    if (det > 1e-10 * trace * trace)
      inverse_ = {zz / det, -xz / det, xx / det};
    else if (trace > 1e-9)
      inverse_ = {xx / (trace * trace), xz / (trace * trace), zz / (trace * trace)};
    else
      inverse_ = {0.0, 0.0, 0.0};
  }

  Solution solve(const Values& b, Pair drift) const {
    Solution out;
    out.a = solved(factor_, b, n_);
    if (!held_) return out;
    const double x = along(x_, out.a) + drift.x, z = along(z_, out.a) + drift.z;
    out.force = {-(inverse_.xx * x + inverse_.xz * z), -(inverse_.xz * x + inverse_.zz * z)};
    for (std::size_t j = 0; j < n_; ++j) out.a[j] += out.force.x * of_x_[j] + out.force.z * of_z_[j];
    return out;
  }

 private:
  double along(const Values& row, const Values& a) const {
    double sum = 0.0;
    for (std::size_t j = 0; j < n_; ++j) sum += row[j] * a[j];
    return sum;
  }
  struct Symmetric {
    double xx = 0.0, xz = 0.0, zz = 0.0;
  };

  Matrix factor_;
  std::size_t n_;
  bool held_ = false;
  Values x_{}, z_{}, of_x_{}, of_z_{};
  Symmetric inverse_;
};

}  // namespace furcula::hidden::trees
