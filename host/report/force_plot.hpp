// The force that a model lacks, over velocity, position and time, and the named cause's law through it.
#pragma once

#include <string>

#include "host/diagnose/diagnosis.hpp"

namespace furcula::report {

/// Three panels as inline SVG, with their legend and what was left out; empty if there are no samples.
std::string force_plots(const diagnose::ResidualForce& residual, std::size_t most_points = 2500);

}  // namespace furcula::report
