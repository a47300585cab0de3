// The torque that a diagnosis leaves at each joint, and what it is like.
#pragma once

#include "host/trees/diagnosis_state.hpp"

namespace furcula::trees {

/// Of the training recordings, with the model re-fitted and extended: sets d.missing and after.
void set_missing_torques(DiagnosisState& s, const Problem& problem);

/// What is left at the extended model.
Remainder remains(const MissingTorque& m);

/// Much torque is missing, and nearly all of it in a few places.
bool at_times(const MissingTorque& m);

/// Squares of torque over a joint's own: what goes with all that is named, and what a flexible law predicts of the rest, or lasts in it.
struct Shares {
  double named = 0.0, left = 0.0;
};
Shares shares_of(const MissingTorque& m);

}  // namespace furcula::trees
