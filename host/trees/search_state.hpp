// What the steps of a search share.
#pragma once

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "host/trees/search.hpp"

namespace furcula::trees {

struct SearchState {
  Problem& problem;
  const Progress& progress;
  bool swings;                                         ///< are looked for
  bool random = true;                                  ///< what is left, as far as the recordings tell
  bool beside_common = false;                          ///< laws that are there from the first
  std::optional<Candidate> first_pick{}, not_first{};  ///< of the first round; what must not be that
  std::vector<Candidate> springs{}, ripples{};         ///< that may be
  double disputed = 0.0;                               ///< see Found, of the last round
  double dropped_worth = 0.0;  ///< of causes that were dropped, and nothing came in their place: of the loss
  std::set<std::string> dropped{};  ///< causes that did not hold at the end of a search

  void say(double fraction, const std::string& doing) const {
    if (progress) progress(std::min(fraction, 0.99), doing);
  }
  /// Of a search that began elsewhere, whose end counts.
  void take_over(SearchState& other) {
    springs = std::move(other.springs);
    ripples = std::move(other.ripples);
    dropped = std::move(other.dropped);
    dropped_worth = other.dropped_worth;
    disputed = other.disputed;
  }
};

/// The names of its causes.
std::set<std::string> names(const TreeModel& model, const Hypothesis& at);

}  // namespace furcula::trees
