// Whether a joint's velocity column is the slope of its position column, and the units in which it is.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace furcula::mapping {

/// What the velocity is of the position's slope: a number that units or a sign explain, or another; nothing where the columns do not go
/// together, or it is one.
struct VelocityFactor {
  double factor = 1.0;
  std::string what;  ///< "degrees/s beside rad"; empty: no units explain it
};
std::optional<VelocityFactor> velocity_factor(const std::vector<double>& time_s,
                                              const std::vector<double>& position,
                                              const std::vector<double>& velocity);

}  // namespace furcula::mapping
