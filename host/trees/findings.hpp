// What a diagnosis names: each cause that the search found, with its intervals, its rivals and its worth.
#pragma once

#include <string>

#include "host/trees/diagnosis_state.hpp"

namespace furcula::trees {

/// Below this confidence it is said why.
inline constexpr double kClear = 0.9;

/// Sets d.findings, the one that is worth most on the held-out recordings first; undecided and at_bound.
void add_findings(DiagnosisState& s, Problem& problem, const Found& found);

/// Whether the recordings cannot tell it from a cause that is another law.
bool undecided(const Finding& f);

/// Its confidence is no more than `most`; where that is less than it was, `why` stands beside it.
void limit(Finding& f, double most, std::string why);

/// A fitted value and its 95 % interval.
Estimate interval(const std::string& name, const std::string& unit, const Fit& fit, std::size_t unknown);

}  // namespace furcula::trees
