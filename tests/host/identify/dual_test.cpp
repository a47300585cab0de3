// Dual numbers against Ceres' jets, an independent implementation of the same rules.
#include "host/identify/dual.hpp"

#include <ceres/jet.h>

#include <catch2/catch.hpp>
#include <cmath>

namespace furcula::identify {
namespace {

using Jet = ceres::Jet<double, 4>;

template <class T>
T start(double value, double d0, double d1, double d2, double d3) {
  T x(value);
  const double derivatives[] = {d0, d1, d2, d3};
  for (int i = 0; i < 4; ++i) {
    if constexpr (std::is_same_v<T, Jet>)
      x.v[i] = derivatives[i];
    else
      x.set(static_cast<std::size_t>(i), derivatives[i]);
  }
  return x;
}

/// `of(x, y)` in both kinds of numbers, at several values of either sign.
template <class F>
void expect_same(F of, bool positive = false) {
  for (double a : {-0.9, -0.3, 0.2, 0.8}) {
    for (double b : {-1.7, 0.6, 2.4}) {
      if (positive) a = std::abs(a), b = std::abs(b);
      const Dual<4> dual = of(start<Dual<4>>(a, 1, -2, 0.5, 0), start<Dual<4>>(b, 0.3, 0, -1.5, 2));
      const Jet jet = of(start<Jet>(a, 1, -2, 0.5, 0), start<Jet>(b, 0.3, 0, -1.5, 2));
      INFO(a << " " << b);
      CHECK(dual.a == Approx(jet.a).epsilon(1e-14));
      for (int i = 0; i < 4; ++i)
        CHECK(dual.derivative(static_cast<std::size_t>(i)) == Approx(jet.v[i]).epsilon(1e-13).margin(1e-15));
    }
  }
}

}  // namespace

TEST_CASE("Sums, products and quotients carry their derivatives") {
  expect_same([](auto x, auto y) { return x + y - x * y; });
  expect_same([](auto x, auto y) { return x / y + 2.0 / y - y / 3.0; });
  expect_same(
      [](auto x, auto y) { return 3.0 * x - y * 0.5 + (1.0 - x) + (y - 1.0) + (2.0 + x) + (y + 4.0); });
  expect_same([](auto x, auto y) { return -(x * y); });
  expect_same([](auto x, auto y) {
    x += y;
    x *= 1.5;
    x -= 0.2;
    y /= x;
    return y;
  });
}

TEST_CASE(
    "The value of a sum, product or quotient is a double's to the bit, so that a run with derivatives is the same run") {
  for (double a : {-0.9, 1.0 / 3.0, 7.3, 1e-9})
    for (double b : {-1.7, 0.1, 3.0, 49.0}) {
      INFO(a << " " << b);
      const Dual<4> x = start<Dual<4>>(a, 1, -2, 0.5, 0), y = start<Dual<4>>(b, 0.3, 0, -1.5, 2);
      CHECK((x / y).a == a / b);
      CHECK((x / b).a == a / b);
      CHECK((a / y).a == a / b);
      CHECK((x * y + x - y).a == a * b + a - b);
    }
}

TEST_CASE("Functions carry their derivatives") {
  expect_same([](auto x, auto y) { return sin(x) * cos(y); });
  expect_same([](auto x, auto y) { return exp(x) + tanh(y); });
  expect_same([](auto x, auto y) { return abs(x * y); });
  expect_same([](auto x, auto y) { return acos(x) * y; });
  expect_same([](auto x, auto y) { return sqrt(x) / sqrt(y); }, true);
  expect_same([](auto x, auto y) { return log(x) * log(y); }, true);
}

TEST_CASE("Dual numbers compare as their values do") {
  const Dual<2> small(1.0, 0), large(2.0, 1);
  CHECK((small < large && small <= large && large > small && large >= 2.0 && 1.0 == small && small != large));
  CHECK_FALSE((small > large || large < 2.0 || 2.0 != large));
  CHECK(small.derivative(0) == 1.0);
  CHECK(small.derivative(1) == 0.0);
}

}  // namespace furcula::identify
