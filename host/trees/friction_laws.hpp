// Two wrong laws of friction in the place of the right one.
#pragma once

#include "host/trees/search_state.hpp"

namespace furcula::trees {

/// Dry friction beside another resistance of the same joint or a constant torque, or of two sizes in the two directions, or a Stribeck curve
/// may be other laws: dry friction or a Stribeck curve, alone or beside a third. Once two wrong laws are in, the right ones gain little, one
/// by one.
Fit friction_anew(SearchState& s, Fit fit);

/// Dry friction of one size takes a Stribeck curve's place where its loss is less. Where the curve does not rise towards standstill by kRises
/// standard errors, the loss may be more by kHardlyWorse.
Fit without_falls(const Problem& problem, Fit fit);

}  // namespace furcula::trees
