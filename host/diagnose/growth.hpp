// The search grows: cause by cause, by what each promises on top of the chosen set.
#pragma once

#include <cstddef>
#include <vector>

#include "host/diagnose/search_state.hpp"

namespace furcula::diagnose {

inline constexpr std::size_t kMostFits = 8;    ///< of the first round; half of them in the later ones
inline constexpr std::size_t kFewestFits = 3;  ///< on top of one set
inline constexpr std::size_t kBeam = 4;        ///< effects that a pair may begin with

/// The effect that removes most, if that is more than chance and numerics could; of those that remove as
/// much, the one with the fewest parameters, then the first of the catalogue. Which are worth a fit is seen
/// from one linear step each. Then the next.
void grow(SearchState& s, std::size_t first_round);

/// The single effects of the first round, those that remove most first.
std::vector<const Tried*> first_singles(const SearchState& s);

}  // namespace furcula::diagnose
