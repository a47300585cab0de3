// How likely other sets are, over the chosen one: by the motion under what disturbs the machine, and by the other channels.
#pragma once

#include <optional>

#include "host/diagnose/remainder.hpp"
#include "host/diagnose/search_state.hpp"

namespace furcula::diagnose {

class Weighing {
 public:
  /// Over the set that is chosen now. The state must outlive it.
  explicit Weighing(const SearchState& s);

  /// Twice the logarithm of the likelihood ratio of the motion under random forces; nothing where that cannot be told.
  std::optional<double> of_motion(const Hypothesis& h) const {
    return disturbed_ ? disturbed_(h.fitted) : std::nullopt;
  }
  bool knows_motion() const { return static_cast<bool>(disturbed_); }

  /// Twice the logarithm of the likelihood ratio of a set over the chosen one: of the motion under random forces, of other channels by the
  /// residuals that count as independent, where these scatter no more than those would.
  double evidence_for(const Hypothesis& h, const std::optional<double>& of_motion) const;

  /// Twice the logarithm of the odds for a set against the chosen one, as the confidence of a name has them (posterior.hpp).
  double odds_for(const Hypothesis& h, const std::optional<double>& of_motion) const;
  double odds_for(const Hypothesis& h) const { return odds_for(h, of_motion(h)); }

  /// Whether it explains as much as the chosen one.
  bool as_good(const Hypothesis& h) const;

 private:
  const SearchState& s_;
  double misfit_;          ///< overdispersion with the chosen set
  EvidenceFor disturbed_;  ///< over the chosen set
};

}  // namespace furcula::diagnose
