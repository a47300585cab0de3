// How far a robot has walked, from its joint angles, attitude and foot switches alone: the stance foot stays where it is.
#pragma once

#include <vector>

#include "host/floating/recording.hpp"

namespace furcula::loop {

/// Horizontal position of the pelvis by row, from that of the first row on: x along its heading there, y to its left.
struct Place {
  double x_m = 0.0, y_m = 0.0;
};

/// Between two rows the lowest sole vertex of the stance foot stays in its place: of the foot whose switch is closed in both rows, of the lower
/// one where both are or neither is. The walks of the tests are 0.5 to 6 % short: the attitude filter is off while the robot accelerates.
std::vector<Place> way_of(const floating::Recording& recording, const floating::Machine& machine);

}  // namespace furcula::loop
