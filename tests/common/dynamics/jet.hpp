// Lets the dynamics run on Ceres' automatic-differentiation numbers.
#pragma once

#include <ceres/jet.h>

#include "furcula/dynamics/scalar.hpp"

namespace furcula::dynamics {

template <int N>
struct ScalarTraits<ceres::Jet<double, N>> {
  using Value = double;
  static constexpr double value(const ceres::Jet<double, N>& x) { return x.a; }
};

}  // namespace furcula::dynamics
