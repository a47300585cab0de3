// Causes are added until none is worth it.
#pragma once

#include "host/trees/search_state.hpp"

namespace furcula::trees {

/// `most`: rounds. `found`: gets the table of the first round; may be null.
Fit rounds(SearchState& s, Fit fit, int most, Found* found);

/// Weighed by itself.
Fit fitted_anew(Problem& problem, const Hypothesis& h);

}  // namespace furcula::trees
