// Whether lengths, masses and moments of inertia can be those of a robot in SI units, or are in another unit.
#pragma once

#include "host/model/urdf.hpp"

namespace furcula::model {

/// Of the bodies that move. What is odd and may be meant goes into the tree's notes; with `accept` all of the inertias does.
/// @throws core::DataError naming file, line, link, value, what it would mean, and the unit that makes all bodies plausible
void judge_units(RobotTree& tree, const Urdf& robot, bool accept);

}  // namespace furcula::model
