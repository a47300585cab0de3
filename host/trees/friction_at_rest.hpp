// Dry friction of a joint that is held still.
//
// A drive that holds a joint answers what disturbs it. The log has the answer, not the disturbance. Dry friction
// swallows the answer, so in windows at rest it always looks right. It is there only if it gains where its joint moves.
#pragma once

#include <vector>

#include "host/trees/fit.hpp"

namespace furcula::trees {

bool is_dry_friction(Effect effect);

/// Of each window: whether one of the cause's joints moves all through it, or nearly so.
std::vector<bool> windows_in_motion(const Problem& problem, const Cause& cause);

/// Whether the fit `with` dry friction is better than that `without` it in the windows that move: by more than chance, or by a share of
/// what it gains in the others. Both are of one weighing.
bool gains_in_motion(const Fit& with, const Fit& without, const std::vector<bool>& moves);

}  // namespace furcula::trees
