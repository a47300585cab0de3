// The table of all sets of causes that were tried, each with why it was named or not.
#pragma once

#include <string>
#include <vector>

#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/held_out.hpp"
#include "host/diagnose/selection.hpp"

namespace furcula::diagnose {

/// The chosen set first, if it has a cause; then its rivals, and what else was tried. `withdrawn`: the chosen set is not named.
std::vector<Candidate> candidates_of(const model::Model& model, const Selection& selection, bool withdrawn,
                                     const HeldOut& held_out);

/// Why a set was not named, in plain words.
std::string why_not(const Tried& t, const Selection& s);

}  // namespace furcula::diagnose
