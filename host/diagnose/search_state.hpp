// What the steps of the search for causes share: the selection as far as it is made, how sets are fitted, and which were.
#pragma once

#include <map>
#include <string_view>
#include <vector>

#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/proposals.hpp"
#include "host/diagnose/selection.hpp"

namespace furcula::diagnose {

struct SearchState : Selection {
  SearchState(const model::Model& model, const std::vector<identify::Recording>& recordings,
              const identify::TrainingWindows& training, unsigned threads, const Progress& to,
              const WithoutRules& left_out)
      : trainer{model, recordings, training, threads},
        proposer(trainer),
        progress(to),
        off(left_out),
        all(trainer.candidates()) {}
  SearchState(const SearchState&) = delete;

  Trainer trainer;
  Proposer proposer;
  const Progress& progress;
  const WithoutRules& off;
  EffectSet all;                           ///< that could extend the model
  std::map<EffectSet, Hypothesis> known;   ///< all sets that were fitted
  std::vector<Proposal> first_screenings;  ///< on top of the re-fitted model

  const model::Model& model() const { return trainer.model; }
  bool keeps(Rule r) const { return !off.contains(r); }
  void tell(double fraction, std::string_view what) const {
    if (progress) progress(fraction, what);
  }

  /// Keeps a set that was fitted; of several fits of one set the best that means something.
  void remember(const Hypothesis& h);
  void remember(const std::vector<Tried>& fitted) {
    for (const Tried& t : fitted) remember(t.hypothesis);
  }

  /// A set with one effect more than `on`, from what was proposed for it; compared with `on`.
  Tried with_one_more(const EffectSet& larger, const Hypothesis& on, const Proposal& proposal,
                      std::size_t round, std::size_t tries) const;

  /// What each effect on top of `on` promises, the most promising first.
  std::vector<Proposal> propose(const Hypothesis& on, const EffectSet& effects, double progress_from,
                                double progress_share) const;

  /// The chosen set without each of its members, in their order.
  void fit_without_each();
};

/// Two names of one law: the same free runs to within a ten-thousandth, whatever was to be expected before.
bool the_same(const Hypothesis& one, const Hypothesis& other);
/// Whether two sets are names of one law, by what they say or by their runs.
bool one_law(const model::Model& model, const Hypothesis& one, const Hypothesis& other);

/// Beyond chance, and it means something.
bool stands(const Tried& t);
bool earlier_in_catalogue(const Tried& a, const Tried& b);
void drop_failed(std::vector<Tried>& all);

}  // namespace furcula::diagnose
