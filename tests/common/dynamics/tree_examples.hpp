// Trees for tests: random ones, and machines whose equations are in every textbook.
#pragma once

#include <cmath>
#include <random>
#include <stdexcept>

#include "furcula/dynamics/tree/energy.hpp"
#include "furcula/dynamics/tree/forward_dynamics.hpp"
#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "tests/common/dynamics/jet.hpp"

namespace furcula::test {

using namespace dynamics::tree;
using dynamics::value_of;

inline const Mat3<double> kStraight = identity<double>();
inline Frame<double> at(double x, double y, double z) { return {kStraight, {x, y, z}}; }

template <class M>
void add(M& m, int parent, JointKind kind, const Frame<double>& placement, const Vec3<double>& axis,
         const Inertia<typename M::Scalar>& body) {
  if (m.add({parent, kind}, placement, axis, body) != Status::ok) throw std::runtime_error("no such joint");
}

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double within(double lower, double upper) {
    return std::uniform_real_distribution<double>(lower, upper)(engine_);
  }
  int below(int n) { return std::uniform_int_distribution<int>(0, n - 1)(engine_); }
  std::size_t up_to(std::size_t most) { return std::uniform_int_distribution<std::size_t>(1, most)(engine_); }
  Vec3<double> vector(double most) { return {within(-most, most), within(-most, most), within(-most, most)}; }
  Mat3<double> turn() {
    double w = within(-1, 1), x = within(-1, 1), y = within(-1, 1), z = within(-1, 1);
    const double n = std::sqrt(w * w + x * x + y * y + z * z);
    w /= n, x /= n, y /= n, z /= n;
    return {{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
            {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
            {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
  }
  /// Of five point masses: what a body can have.
  Inertia<double> body() {
    Inertia<double> sum{};
    for (int i = 0; i < 5; ++i) sum = sum + inertia_of(within(0.05, 0.5), vector(0.3), Sym3<double>{});
    return sum;
  }

 private:
  std::mt19937 engine_;
};

/// `n` joints of both kinds on random parents; with armature, damping and springs.
template <std::size_t kMost>
Model<double, DynamicTopology<kMost>> random_tree(Random& r, std::size_t n) {
  Model<double, DynamicTopology<kMost>> m;
  m.gravity_mps2 = r.vector(9.81);
  for (std::size_t i = 0; i < n; ++i) {
    add(m, r.below(static_cast<int>(i) + 1) - 1, r.below(3) == 0 ? JointKind::prismatic : JointKind::revolute,
        {r.turn(), r.vector(0.5)}, r.vector(1.0), r.body());
    m.laws[i].armature_kgm2 = r.within(0.0, 0.1);
    m.laws[i].damping_nmspr = r.within(0.0, 0.5);
    m.laws[i].stiffness_nmprad = r.within(0.0, 5.0);
    m.laws[i].rest_rad = r.within(-1.0, 1.0);
  }
  return m;
}

template <class M>
typename M::Joints random_joints(Random& r, const M& m, double most) {
  typename M::Joints out{};
  for (std::size_t i = 0; i < m.count(); ++i) out[i] = typename M::Scalar(r.within(-most, most));
  return out;
}

/// Two thin bodies in a plane, angles from hanging down, the second relative to the first.
template <class T>
struct DoublePendulum {
  T m1 = T(0.6), m2 = T(0.4), c1 = T(0.25), c2 = T(0.2), i1 = T(4e-3), i2 = T(3e-3);
  double l1 = 0.3, g = 9.81;

  template <class P>
  Model<T, P> model() const {
    Model<T, P> m;
    const auto body = [](const T& mass, const T& centre, const T& inertia) {
      return inertia_of(mass, Vec3<T>{T(0.0), T(0.0), -centre},
                        Sym3<T>{inertia, T(0.0), T(0.0), inertia, T(0.0), T(1e-4)});
    };
    add(m, -1, JointKind::revolute, at(0, 0, 0), {0, -1, 0}, body(m1, c1, i1));
    add(m, 0, JointKind::revolute, at(0, 0, -l1), {0, -1, 0}, body(m2, c2, i2));
    return m;
  }
  /// Lagrange's equations, M qdd = tau - C - G, solved by Cramer's rule.
  void accelerations(const T (&q)[2], const T (&w)[2], const T (&tau)[2], T (&out)[2]) const {
    using std::cos;
    using std::sin;
    const T b = m2 * l1 * c2, cb = b * cos(q[1]), sb = b * sin(q[1]);
    const T d22 = i2 + m2 * c2 * c2, d12 = d22 + cb;
    const T d11 = i1 + m1 * c1 * c1 + m2 * (l1 * l1) + d22 + cb * 2.0;
    const T g2 = m2 * c2 * g * sin(q[0] + q[1]), g1 = (m1 * c1 + m2 * l1) * g * sin(q[0]) + g2;
    const T r1 = tau[0] + sb * (w[0] * w[1] * 2.0 + w[1] * w[1]) - g1;
    const T r2 = tau[1] - sb * w[0] * w[0] - g2;
    const T det = d11 * d22 - d12 * d12;
    out[0] = (d22 * r1 - d12 * r2) / det;
    out[1] = (d11 * r2 - d12 * r1) / det;
  }
};

inline constexpr std::array kTwoInSeries{JointPlace{-1, JointKind::revolute},
                                         JointPlace{0, JointKind::revolute}};

}  // namespace furcula::test
