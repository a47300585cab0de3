// Causes that have one value at several sites, and such that have one of their own at each.
#pragma once

#include "host/trees/search_state.hpp"

namespace furcula::trees {

/// A cause that has one value at several sites may have one of its own at each: where that predicts better.
Fit apart(SearchState& s, Fit fit);

/// One effect with about one value at several sites is one cause.
Fit merge(const Problem& problem, Fit fit);

}  // namespace furcula::trees
