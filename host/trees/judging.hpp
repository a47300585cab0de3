// Each cause that was found against none in its place, and against the others.
#pragma once

#include <cstddef>

#include "host/trees/search_state.hpp"

namespace furcula::trees {

/// From `fit` on to the end of the search: sets found.fit, its gains and rivals. It is given up after so many `steps`: what is named then stays.
void judge(SearchState& s, Found& found, Fit fit, std::size_t steps);

/// Whether more is missing at `h` than a verdict allows, but for the held-out recordings.
bool much_is_missing(const SearchState& s, const Hypothesis& h, const Hypothesis& refitted);

}  // namespace furcula::trees
