// Coordinates of inertias in which every point is a body.
#include <Eigen/Eigenvalues>
#include <catch2/catch.hpp>

#include "furcula/dynamics/tree/inertia_coordinates.hpp"
#include "host/identify/dual.hpp"
#include "tests/common/dynamics/tree_examples.hpp"

using namespace furcula;
using namespace furcula::test;

namespace {

template <class T>
std::array<T, 10> numbers(const Inertia<T>& b) {
  const auto& s = b.inertia_kgm2;
  return {b.mass_kg, b.moment_kgm.x, b.moment_kgm.y, b.moment_kgm.z, s.xx, s.xy, s.xz, s.yy, s.yz, s.zz};
}
template <class T>
std::array<T, 10> numbers(const InertiaCoordinates<T>& c) {
  return {c.log_scale, c.log_stretch.x, c.log_stretch.y, c.log_stretch.z, c.shear12,
          c.shear23,   c.shear13,       c.centre_m.x,    c.centre_m.y,    c.centre_m.z};
}
template <class T>
InertiaCoordinates<T> coordinates(const std::array<T, 10>& x) {
  return {x[0], {x[1], x[2], x[3]}, x[4], x[5], x[6], {x[7], x[8], x[9]}};
}

/// The pseudo-inertia, by its definition over the inertia's matrix.
Eigen::Matrix4d pseudo_inertia(const Inertia<double>& b) {
  const auto& s = b.inertia_kgm2;
  Eigen::Matrix3d i;
  i << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  const Eigen::Vector3d h(b.moment_kgm.x, b.moment_kgm.y, b.moment_kgm.z);
  Eigen::Matrix4d j;
  j << 0.5 * i.trace() * Eigen::Matrix3d::Identity() - i, h, h.transpose(), b.mass_kg;
  return j;
}

}  // namespace

TEST_CASE("Ten numbers drawn at random are a body, and come back") {
  Random r(31);
  for (int n = 0; n < 500; ++n) {
    std::array<double, 10> x{};
    for (double& c : x) c = r.within(-2, 2);
    const Inertia<double> body = inertia_of(coordinates(x));
    CHECK(body.mass_kg > 0.0);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(pseudo_inertia(body));
    CHECK(solver.eigenvalues()(0) > -1e-12 * solver.eigenvalues()(3));
    const auto back = coordinates_of(body);
    REQUIRE(back.ok());
    const std::array<double, 10> y = numbers(back.value());
    for (std::size_t i = 0; i < 10; ++i) CHECK(y[i] == Approx(x[i]).epsilon(1e-7).margin(1e-7));
  }
}

TEST_CASE("The coordinates are U of the pseudo-inertia's factors U U'") {
  const std::array<double, 10> x{0.3, -0.5, 0.2, 0.1, 0.7, -0.4, 0.6, 0.05, -0.2, 0.3};
  Eigen::Matrix4d u;
  u << std::exp(x[1]), x[4], x[6], x[7], 0, std::exp(x[2]), x[5], x[8], 0, 0, std::exp(x[3]), x[9], 0, 0, 0,
      1;
  u *= std::exp(x[0]);
  CHECK((u * u.transpose() - pseudo_inertia(inertia_of(coordinates(x)))).norm() < 1e-14);
}

TEST_CASE("Bodies of points have coordinates, and these give them back") {
  Random r(32);
  for (int n = 0; n < 500; ++n) {
    const Inertia<double> body = r.body();
    const auto c = coordinates_of(body);
    REQUIRE(c.ok());
    const auto a = numbers(inertia_of(c.value())), b = numbers(body);
    for (std::size_t i = 0; i < 10; ++i) CHECK(a[i] == Approx(b[i]).epsilon(1e-10).margin(1e-12));
  }
}

TEST_CASE("What no body can have has no coordinates") {
  const Vec3<double> centre{0.1, 0.0, 0.0};
  CHECK(coordinates_of(inertia_of(1.0, centre, {0.1, 0, 0, 0.1, 0, 0.15})).ok());
  CHECK_FALSE(coordinates_of(inertia_of(-1.0, centre, {0.1, 0, 0, 0.1, 0, 0.15})).ok());
  CHECK_FALSE(coordinates_of(inertia_of(0.0, centre, {0.1, 0, 0, 0.1, 0, 0.15})).ok());
  CHECK_FALSE(coordinates_of(inertia_of(1.0, centre, {0.1, 0, 0, 0.1, 0, 0.21}))
                  .ok());  // more than the sum of the others
  CHECK_FALSE(coordinates_of(inertia_of(1.0, centre, {0.21, 0, 0, 0.1, 0, 0.1})).ok());
  CHECK_FALSE(
      coordinates_of(inertia_of(1.0, centre, {0.1, 0.2, 0, 0.1, 0, 0.15})).ok());  // not positive definite
  CHECK_FALSE(coordinates_of(inertia_of(1.0, centre, {0.0, 0, 0, 0.0, 0, 0.0})).ok());  // a point
  CHECK_FALSE(coordinates_of(inertia_of(1.0, centre, {0.1, NAN, 0, 0.1, 0, 0.1})).ok());
}

TEST_CASE("Both ways have derivatives, and one undoes the other") {
  using Dual = identify::Dual<10>;
  std::array<double, 10> x{0.3, -1.5, -1.2, -1.1, 0.07, -0.04, 0.06, 0.05, -0.2, 0.3};
  std::array<Dual, 10> d;
  for (std::size_t i = 0; i < 10; ++i) d[i] = Dual(x[i], static_cast<int>(i));
  const Inertia<Dual> body = inertia_of(coordinates(d));
  const std::array<Dual, 10> out = numbers(body);
  for (std::size_t i = 0; i < 10; ++i) {
    auto up = x, down = x;
    up[i] += 1e-6;
    down[i] -= 1e-6;
    const auto a = numbers(inertia_of(coordinates(up))), b = numbers(inertia_of(coordinates(down)));
    for (std::size_t k = 0; k < 10; ++k)
      CHECK(out[k].derivative(i) == Approx((a[k] - b[k]) / 2e-6).epsilon(1e-6).margin(1e-8));
  }
  const auto back = coordinates_of(body);
  REQUIRE(back.ok());
  const std::array<Dual, 10> again = numbers(back.value());
  for (std::size_t k = 0; k < 10; ++k)
    for (std::size_t i = 0; i < 10; ++i)
      CHECK(again[k].derivative(i) == Approx(k == i ? 1.0 : 0.0).margin(1e-9));
}
