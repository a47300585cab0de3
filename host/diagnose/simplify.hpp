// Of sets that do about as well, the simpler ones.
#pragma once

#include <vector>

#include "host/diagnose/search_state.hpp"

namespace furcula::diagnose {

/// Of those that stand the one that is preferred; null where none does.
const Tried* best_of(const SearchState& s, const std::vector<Tried>& trials);

/// Of those that do as well as the best one.
const Tried& simplest(const SearchState& s, const std::vector<Tried>& trials, const Tried& best);

/// A law that is not told from its special case leaves less than that one does: the fit of the special case ended elsewhere, and begins
/// anew from there.
void add_special_cases(SearchState& s, std::vector<Tried>& trials);

/// Backward: takes out members of the chosen set that the others have made needless, and takes a law's special case for one that needs no more.
void prune(SearchState& s);

/// By how much a set must be preferred to the chosen one to take its place: fewer causes or parameters for the same, or better ones.
double price_of(const SearchState& s, const Hypothesis& h);

}  // namespace furcula::diagnose
