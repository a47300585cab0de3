// Velocity columns that are not the slope of their position.
#pragma once

#include <vector>

#include "host/identify/recording.hpp"

namespace furcula::identify {

/// Of recordings whose velocity is their position's slope but for a factor: a note that says so, and the slope in its place.
void mend_velocities(std::vector<Recording>& recordings);

}  // namespace furcula::identify
