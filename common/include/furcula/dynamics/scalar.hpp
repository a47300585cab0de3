// The scalar type of the dynamics: float on the target, double on the host, and automatic-differentiation
// types, whose value is read through ScalarTraits.
#pragma once

#include <cmath>

namespace furcula::dynamics {

/// How to read the plain value of a scalar. Automatic-differentiation types specialise it
/// (host/identify/dual.hpp).
template <class T>
struct ScalarTraits {
  using Value = T;  ///< type of the plain value
  /// The plain value, without derivatives.
  static constexpr Value value(const T& x) { return x; }
};

/// Type of the plain value of a scalar: float or double.
template <class T>
using ValueOf = typename ScalarTraits<T>::Value;

/// The plain value of a scalar, without derivatives.
template <class T>
constexpr ValueOf<T> value_of(const T& x) {
  return ScalarTraits<T>::value(x);
}

}  // namespace furcula::dynamics
