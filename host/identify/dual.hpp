// Numbers that carry derivatives by N unknowns (forward automatic differentiation), for fits through the
// dynamics.
//
// They follow ceres::Jet's rules, against which a test holds them. Nine tenths of a diagnosis are their
// arithmetic (docs/benchmarks.md), and GCC 12 leaves the expression templates of Ceres' as calls and scalar
// loops: here the derivatives are pairs of doubles that every x86-64 and AArch64 adds and multiplies at once.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "furcula/dynamics/scalar.hpp"

namespace furcula::identify {

template <int N>
struct Dual {
  static_assert(N > 0 && N % 2 == 0, "the derivatives go in pairs");
  using Pair [[gnu::vector_size(2 * sizeof(double))]] = double;
  static constexpr std::size_t kPairs = N / 2;

  double a = 0.0;
  std::array<Pair, kPairs> v{};

  Dual() = default;
  Dual(double value) : a(value) {}  // NOLINT(google-explicit-constructor): as a double anywhere
  /// The unknown `index` itself.
  Dual(double value, int index) : a(value) { set(static_cast<std::size_t>(index), 1.0); }

  double derivative(std::size_t i) const { return v[i / 2][i % 2]; }
  void set(std::size_t i, double derivative) { v[i / 2][i % 2] = derivative; }
};

namespace detail {

/// `value`, with p times the derivatives of x.
template <int N>
[[gnu::always_inline]] inline Dual<N> chain(double value, double p, const Dual<N>& x) {
  Dual<N> out;
  out.a = value;
#pragma GCC unroll 16
  for (std::size_t i = 0; i < Dual<N>::kPairs; ++i) out.v[i] = p * x.v[i];
  return out;
}

/// `value`, with p times the derivatives of x and q times those of y.
template <int N>
[[gnu::always_inline]] inline Dual<N> chain(double value, double p, const Dual<N>& x, double q,
                                            const Dual<N>& y) {
  Dual<N> out;
  out.a = value;
#pragma GCC unroll 16
  for (std::size_t i = 0; i < Dual<N>::kPairs; ++i) out.v[i] = p * x.v[i] + q * y.v[i];
  return out;
}

template <int N>
[[gnu::always_inline]] inline Dual<N> shifted(double value, const Dual<N>& x) {
  Dual<N> out;
  out.a = value;
  out.v = x.v;
  return out;
}

}  // namespace detail

template <int N>
[[gnu::always_inline]] inline Dual<N> operator+(const Dual<N>& x, const Dual<N>& y) {
  Dual<N> out;
  out.a = x.a + y.a;
#pragma GCC unroll 16
  for (std::size_t i = 0; i < Dual<N>::kPairs; ++i) out.v[i] = x.v[i] + y.v[i];
  return out;
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator-(const Dual<N>& x, const Dual<N>& y) {
  Dual<N> out;
  out.a = x.a - y.a;
#pragma GCC unroll 16
  for (std::size_t i = 0; i < Dual<N>::kPairs; ++i) out.v[i] = x.v[i] - y.v[i];
  return out;
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator*(const Dual<N>& x, const Dual<N>& y) {
  return detail::chain(x.a * y.a, x.a, y, y.a, x);
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator/(const Dual<N>& x, const Dual<N>& y) {
  const double inverse = 1.0 / y.a, quotient = x.a / y.a;
  return detail::chain(quotient, inverse, x, -quotient * inverse, y);
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator-(const Dual<N>& x) {
  return detail::chain(-x.a, -1.0, x);
}

template <int N>
[[gnu::always_inline]] inline Dual<N> operator+(const Dual<N>& x, double c) {
  return detail::shifted(x.a + c, x);
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator+(double c, const Dual<N>& x) {
  return detail::shifted(c + x.a, x);
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator-(const Dual<N>& x, double c) {
  return detail::shifted(x.a - c, x);
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator-(double c, const Dual<N>& x) {
  return detail::chain(c - x.a, -1.0, x);
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator*(const Dual<N>& x, double c) {
  return detail::chain(x.a * c, c, x);
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator*(double c, const Dual<N>& x) {
  return detail::chain(c * x.a, c, x);
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator/(const Dual<N>& x, double c) {
  return detail::chain(x.a / c, 1.0 / c, x);
}
template <int N>
[[gnu::always_inline]] inline Dual<N> operator/(double c, const Dual<N>& x) {
  const double quotient = c / x.a;
  return detail::chain(quotient, -quotient / x.a, x);
}

template <int N, class Y>
[[gnu::always_inline]] inline Dual<N>& operator+=(Dual<N>& x, const Y& y) {
  return x = x + y;
}
template <int N, class Y>
[[gnu::always_inline]] inline Dual<N>& operator-=(Dual<N>& x, const Y& y) {
  return x = x - y;
}
template <int N, class Y>
[[gnu::always_inline]] inline Dual<N>& operator*=(Dual<N>& x, const Y& y) {
  return x = x * y;
}
template <int N, class Y>
[[gnu::always_inline]] inline Dual<N>& operator/=(Dual<N>& x, const Y& y) {
  return x = x / y;
}

/// Dual numbers compare as their values do.
#define FURCULA_COMPARE(op)                              \
  template <int N>                                       \
  bool operator op(const Dual<N>& x, const Dual<N>& y) { \
    return x.a op y.a;                                   \
  }                                                      \
  template <int N>                                       \
  bool operator op(const Dual<N>& x, double y) {         \
    return x.a op y;                                     \
  }                                                      \
  template <int N>                                       \
  bool operator op(double x, const Dual<N>& y) {         \
    return x op y.a;                                     \
  }
FURCULA_COMPARE(<)
FURCULA_COMPARE(<=)
FURCULA_COMPARE(>)
FURCULA_COMPARE(>=)
FURCULA_COMPARE(==)
FURCULA_COMPARE(!=)
#undef FURCULA_COMPARE

template <int N>
Dual<N> abs(const Dual<N>& x) {
  return detail::chain(std::abs(x.a), std::copysign(1.0, x.a), x);
}
template <int N>
Dual<N> sqrt(const Dual<N>& x) {
  const double root = std::sqrt(x.a);
  return detail::chain(root, 0.5 / root, x);
}
template <int N>
Dual<N> exp(const Dual<N>& x) {
  const double value = std::exp(x.a);
  return detail::chain(value, value, x);
}
template <int N>
Dual<N> log(const Dual<N>& x) {
  return detail::chain(std::log(x.a), 1.0 / x.a, x);
}
template <int N>
Dual<N> sin(const Dual<N>& x) {
  return detail::chain(std::sin(x.a), std::cos(x.a), x);
}
template <int N>
Dual<N> cos(const Dual<N>& x) {
  return detail::chain(std::cos(x.a), -std::sin(x.a), x);
}
template <int N>
Dual<N> acos(const Dual<N>& x) {
  return detail::chain(std::acos(x.a), -1.0 / std::sqrt(1.0 - x.a * x.a), x);
}
template <int N>
Dual<N> tanh(const Dual<N>& x) {
  const double value = std::tanh(x.a);
  return detail::chain(value, 1.0 - value * value, x);
}

}  // namespace furcula::identify

namespace furcula::dynamics {

template <int N>
struct ScalarTraits<identify::Dual<N>> {
  using Value = double;
  static constexpr double value(const identify::Dual<N>& x) { return x.a; }
};

}  // namespace furcula::dynamics
