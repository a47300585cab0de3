// An attitude as turns about x, then y, then z of the level, and back.
#pragma once

#include <algorithm>
#include <cmath>

#include "furcula/dynamics/biped/state.hpp"

namespace furcula::walk {

struct RollPitchYaw {
  double roll_rad, pitch_rad, yaw_rad;
};

inline RollPitchYaw roll_pitch_yaw(const dynamics::biped::Quaternion<double>& a) {
  const auto r = dynamics::biped::rotation(a);
  return {std::atan2(r.z.y, r.z.z), std::asin(std::clamp(-r.z.x, -1.0, 1.0)), std::atan2(r.y.x, r.x.x)};
}

inline dynamics::biped::Quaternion<double> attitude_of(const RollPitchYaw& t) {
  const double cr = std::cos(0.5 * t.roll_rad), sr = std::sin(0.5 * t.roll_rad);
  const double cp = std::cos(0.5 * t.pitch_rad), sp = std::sin(0.5 * t.pitch_rad);
  const double cy = std::cos(0.5 * t.yaw_rad), sy = std::sin(0.5 * t.yaw_rad);
  return {cy * cp * cr + sy * sp * sr, cy * cp * sr - sy * sp * cr, cy * sp * cr + sy * cp * sr,
          sy * cp * cr - cy * sp * sr};
}

}  // namespace furcula::walk
