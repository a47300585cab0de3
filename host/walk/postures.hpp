// Limits that no posture keeps: a search would spend its budget on robots that are over one from the first moment on.
#pragma once

#include <string>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/walk/rollout.hpp"

namespace furcula::walk {

/// Of the limits that end a run (pelvis height, joints' range, feet that are too near) the one that every posture from which a search's
/// walks may begin breaks at once, with what could be kept, in words; empty: some posture keeps them all. The other limits are broken in
/// motion only: nothing is said of them.
std::string limit_of_no_posture(const dynamics::biped::Description& robot, const RolloutOptions& options);

}  // namespace furcula::walk
