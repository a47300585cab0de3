#include "host/loop/triangle.hpp"

#include <cmath>

namespace furcula::loop {

double model_error_rad(const floating::WindowErrors& errors) {
  constexpr double kTurns = 3.0;
  const double joints = floating::kJoints;
  return std::sqrt(
      (joints * errors.angle_rad * errors.angle_rad + kTurns * errors.attitude_rad * errors.attitude_rad) /
      (joints + kTurns));
}

}  // namespace furcula::loop
