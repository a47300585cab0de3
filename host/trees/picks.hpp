// What a round of the search tries and takes, by the linear test.
#pragma once

#include <set>
#include <span>
#include <string>
#include <vector>

#include "host/trees/score_test.hpp"
#include "host/trees/search_state.hpp"

namespace furcula::trees {

/// Values that no probe tells, from what torque is missing, and what may swing.
Guesses guesses(const SearchState& s, const Hypothesis& h);

/// All candidates but those that the recordings did not agree on, and those that have a law in them that is found already: a position
/// law's kd is a damping.
std::vector<Candidate> tried(const SearchState& s, const Hypothesis& h);

/// The candidates to take in this round, by a greedy solution of the linear problem. `table`: gets the best of the first; may be null.
std::vector<ScoreTest::Score> pick(SearchState& s, const ScoreTest& linear, const Fit& fit,
                                   const std::set<std::string>& refused, Found* table);

std::span<const double> coefficients(const ScoreTest::Score& score);

}  // namespace furcula::trees
