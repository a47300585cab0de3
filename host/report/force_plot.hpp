// The force that a model lacks, over velocity, position and time, and the named cause's law through it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "host/result/diagnosis.hpp"

namespace furcula::report {

/// Three panels as inline SVG, with their legend and what was left out; empty if there are no samples.
std::string force_plots(const result::ResidualForce& residual, std::size_t most_points = 2500);

/// What two models lack on the same samples, in one unit of torque or force. Columns have one length.
struct MissingForce {
  const std::vector<double>&time_s, &velocity, &position, &before, &after;
  std::string_view unit, velocity_unit, position_unit;
};

/// The same three panels, both models in each; empty if there are no samples.
std::string missing_force_plots(const MissingForce& missing, std::size_t most_points = 1500);

}  // namespace furcula::report
