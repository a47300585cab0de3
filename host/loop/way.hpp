// How far a robot has walked, from its joint angles, attitude and foot switches alone: the stance foot stays where it is.
#pragma once

#include <vector>

#include "host/floating/recording.hpp"

namespace furcula::loop {

/// Horizontal position of the pelvis by row, from that of the first row on: x along its heading there, y to its left.
struct Place {
  double x_m = 0.0, y_m = 0.0;
};

/// Between two rows the lowest sole vertex of each foot whose switch is closed in both of them stays in its place (the mean of both feet);
/// where there is no such foot, that of the lower one.
std::vector<Place> way_of(const floating::Recording& recording, const floating::Machine& machine);

}  // namespace furcula::loop
