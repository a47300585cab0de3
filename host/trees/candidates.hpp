// What a search tries: each effect at each site, and at several sites with one value, as probes that a linear test can
// tell the size of.
#pragma once

#include <cstddef>
#include <vector>

#include "host/trees/fit.hpp"

namespace furcula::trees {

/// A cause at its sites, in so many columns: the change that each of `columns` makes is taken as linear.
struct Candidate {
  Effect effect;
  std::vector<std::size_t> sites;
  std::vector<Cause> columns;
  bool only_forward = true;  ///< coefficients below zero make no sense
  std::ptrdiff_t replaces =
      -1;  ///< a cause of the hypothesis that it contains (dry friction by a fuller law of it)
};

/// All that the hypothesis does not have yet. `ripple_cycles[joint]` are what the torque may ripple with.
std::vector<Candidate> candidates(const Problem& problem, const Hypothesis& h,
                                  const std::vector<std::vector<double>>& ripple_cycles);

/// The hypothesis with a column of a candidate.
Hypothesis with_column(const Hypothesis& h, const Candidate& c, std::size_t column);

/// The hypothesis with the candidate at the size that the coefficients of its columns say.
Hypothesis with_candidate(const TreeModel& model, const Hypothesis& h, const Candidate& c,
                          std::span<const double> coefficients);

Hypothesis without(const Hypothesis& h, std::size_t cause);

}  // namespace furcula::trees
