// Numbers that carry first and second derivatives by N unknowns, for the exact Hessians of gait optimisation.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "furcula/dynamics/scalar.hpp"

namespace furcula::optimise {

/// `g` has the first derivatives, `h` the second ones of i >= j at i (i + 1) / 2 + j.
template <std::size_t N>
struct Second {
  static constexpr std::size_t kPairs = N * (N + 1) / 2;
  double a = 0.0;
  std::array<double, N> g{};
  std::array<double, kPairs> h{};

  Second() = default;
  Second(double value) : a(value) {}  // NOLINT(google-explicit-constructor): as a double anywhere
  /// The unknown `index` itself.
  Second(double value, std::size_t index) : a(value) { g[index] = 1.0; }

  /// f(this) with the derivatives f' and f'' there.
  Second chain(double f, double first, double second) const {
    Second o;
    o.a = f;
    for (std::size_t i = 0; i < N; ++i) o.g[i] = first * g[i];
    for (std::size_t i = 0, k = 0; i < N; ++i) {
      const double s = second * g[i];
      for (std::size_t j = 0; j <= i; ++j, ++k) o.h[k] = first * h[k] + s * g[j];
    }
    return o;
  }
};

template <std::size_t N>
Second<N> operator+(const Second<N>& x, const Second<N>& y) {
  Second<N> o;
  o.a = x.a + y.a;
  for (std::size_t i = 0; i < N; ++i) o.g[i] = x.g[i] + y.g[i];
  for (std::size_t k = 0; k < Second<N>::kPairs; ++k) o.h[k] = x.h[k] + y.h[k];
  return o;
}
template <std::size_t N>
Second<N> operator-(const Second<N>& x, const Second<N>& y) {
  Second<N> o;
  o.a = x.a - y.a;
  for (std::size_t i = 0; i < N; ++i) o.g[i] = x.g[i] - y.g[i];
  for (std::size_t k = 0; k < Second<N>::kPairs; ++k) o.h[k] = x.h[k] - y.h[k];
  return o;
}
template <std::size_t N>
Second<N> operator*(const Second<N>& x, const Second<N>& y) {
  Second<N> o;
  o.a = x.a * y.a;
  for (std::size_t i = 0; i < N; ++i) o.g[i] = x.a * y.g[i] + y.a * x.g[i];
  for (std::size_t i = 0, k = 0; i < N; ++i) {
    const double p = x.g[i], q = y.g[i];
    for (std::size_t j = 0; j <= i; ++j, ++k)
      o.h[k] = x.a * y.h[k] + y.a * x.h[k] + (p * y.g[j] + q * x.g[j]);
  }
  return o;
}
template <std::size_t N>
Second<N> inverse(const Second<N>& x) {
  const double r = 1.0 / x.a;
  return x.chain(r, -r * r, 2.0 * r * r * r);
}
template <std::size_t N>
Second<N> operator/(const Second<N>& x, const Second<N>& y) {
  return x * inverse(y);
}
template <std::size_t N>
Second<N> operator*(const Second<N>& x, double c) {
  Second<N> o;
  o.a = x.a * c;
  for (std::size_t i = 0; i < N; ++i) o.g[i] = x.g[i] * c;
  for (std::size_t k = 0; k < Second<N>::kPairs; ++k) o.h[k] = x.h[k] * c;
  return o;
}
template <std::size_t N>
Second<N> operator*(double c, const Second<N>& x) {
  return x * c;
}
template <std::size_t N>
Second<N> operator+(Second<N> x, double c) {
  x.a += c;
  return x;
}
template <std::size_t N>
Second<N> operator+(double c, const Second<N>& x) {
  return x + c;
}
template <std::size_t N>
Second<N> operator-(const Second<N>& x, double c) {
  return x + -c;
}
template <std::size_t N>
Second<N> operator-(const Second<N>& x) {
  return x * -1.0;
}
template <std::size_t N>
Second<N> operator-(double c, const Second<N>& x) {
  return -x + c;
}
template <std::size_t N>
Second<N> operator/(const Second<N>& x, double c) {
  return x * (1.0 / c);
}
template <std::size_t N>
Second<N> operator/(double c, const Second<N>& x) {
  return inverse(x) * c;
}

template <std::size_t N>
Second<N> sin(const Second<N>& x) {
  const double s = std::sin(x.a), c = std::cos(x.a);
  return x.chain(s, c, -s);
}
template <std::size_t N>
Second<N> cos(const Second<N>& x) {
  const double s = std::sin(x.a), c = std::cos(x.a);
  return x.chain(c, -s, -c);
}
template <std::size_t N>
Second<N> sqrt(const Second<N>& x) {
  const double r = std::sqrt(x.a);
  return x.chain(r, 0.5 / r, -0.25 / (r * x.a));
}

}  // namespace furcula::optimise

namespace furcula::dynamics {

template <std::size_t N>
struct ScalarTraits<optimise::Second<N>> {
  using Value = double;
  static constexpr double value(const optimise::Second<N>& x) { return x.a; }
};

}  // namespace furcula::dynamics
