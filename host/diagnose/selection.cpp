#include "host/diagnose/selection.hpp"

#include <optional>

#include "host/core/parallel.hpp"
#include "host/diagnose/beginnings.hpp"
#include "host/diagnose/exchanges.hpp"
#include "host/diagnose/growth.hpp"
#include "host/diagnose/other_words.hpp"
#include "host/diagnose/search_state.hpp"
#include "host/diagnose/weighing.hpp"

namespace furcula::diagnose {
namespace {

/// All that were fitted and mean something, weighed; the chosen one first.
std::vector<Weighed> weighed(const SearchState& s) {
  const Weighing w(s);
  std::vector<const Hypothesis*> others;
  for (const auto& [effects, h] : s.known)
    if (effects != s.chosen.effects && (h.meaningful || effects.empty())) others.push_back(&h);
  std::vector<Weighed> all(others.size() + 1, {s.chosen.effects, 0.0, 0.0});
  const double prior = s.trainer.prior(s.chosen.effects);
  core::parallel_for(others.size(), s.trainer.threads, [&](std::size_t i) {
    const Hypothesis& h = *others[i];
    all[i + 1] = {h.effects, w.evidence_for(h, w.of_motion(h)), s.trainer.prior(h.effects) - prior};
  });
  return all;
}

void search(SearchState& s) {
  s.tell(0.0, "re-fitting the model");
  s.refitted = s.trainer.fit({}, nullptr);
  s.trainer.reference_squares = squares_of_body(s.refitted);
  s.chosen = s.refitted;
  s.remember(s.refitted);
  const std::optional<Hypothesis> wider = s.trainer.widened(s.refitted);
  if (wider && follows_the_body(*wider)) {
    s.beyond_bounds = wider;
    return;
  }
  grow(s, 0);
  if (s.keeps(Rule::one_for_several)) one_for_several(s);
  if (s.keeps(Rule::beam) && begin_with_others(s)) {
    s.acted.insert(Rule::beam);
    if (!follows_the_body(s.chosen)) grow(s, s.chosen.effects.size());
  }
  exchange(s);
  if (!s.chosen.effects.empty() && !follows_the_body(s.chosen)) {
    // What took a place may leave what another cause explains.
    const EffectSet before = s.chosen.effects;
    grow(s, before.size());
    if (s.chosen.effects != before) exchange(s);
  }
  add_friction_of_two_sizes(s);
  if (s.keeps(Rule::early_rows)) add_drive_behind_early_rows(s);
  if (wider && s.trainer.preference(s.chosen, *wider) > -kEqualEvidence) s.beyond_bounds = wider;
  s.pool = weighed(s);
}

}  // namespace

Selection select(const model::Model& model, const std::vector<identify::Recording>& recordings,
                 const identify::TrainingWindows& training, unsigned threads, const Progress& progress,
                 const WithoutRules& without) {
  SearchState s(model, recordings, training, threads, progress, without);
  search(s);
  return s;
}

}  // namespace furcula::diagnose
