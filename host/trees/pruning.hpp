// Which causes of a fit hold, and fits without those that do not.
#pragma once

#include "host/trees/search_state.hpp"

namespace furcula::trees {

/// A cause is dropped whose parameters are nearer to none than so many of their own variances.
inline constexpr double kHolds = 12.0;
/// By so much better the recordings predict each other with a cause that counts, of the loss.
inline constexpr double kPredicts = 0.05;

/// Between two rows nobody knows when a command came.
bool is_unresolved(const Problem& problem, const Cause& c);

/// Drops causes that do not hold, the weakest first. `strict`: the recordings must agree on what stays.
Fit prune(SearchState& s, Fit fit, bool strict);

/// Without the latches that the switch's own lateness accounts for.
Fit without_doubtful_latches(const Problem& problem, Fit fit);

/// Without the causes that are worth next to nothing of what all are, by squares: no law is a law to much less than that, and what is left of
/// a large cause looks like a small one of another sort. The least first.
Fit without_negligible(Problem& problem, Fit fit);

}  // namespace furcula::trees
