#include "host/diagnose/beginnings.hpp"

#include <algorithm>
#include <utility>

#include "host/core/parallel.hpp"
#include "host/diagnose/growth.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/simplify.hpp"

namespace furcula::diagnose {

using dynamics::Effect;

void one_for_several(SearchState& s) {
  if (s.chosen.effects.size() < 2) return;
  s.tell(0.78, "one cause in the place of several");
  std::vector<Proposal> singles;
  for (const Proposal& p : s.first_screenings) {
    const bool known = std::any_of(s.tried.begin(), s.tried.end(), [&](const Tried& t) {
      return t.round == 0 && t.hypothesis.effects == EffectSet{p.effect};
    });
    const bool wider = std::any_of(s.chosen.effects.begin(), s.chosen.effects.end(),
                                   [&](Effect e) { return contains(p.effect, e); });
    if (!known && (wider || (p.gain > 0.0 && singles.size() < kMostFits))) singles.push_back(p);
  }
  std::vector<Tried> trials(singles.size());
  core::parallel_for(singles.size(), s.trainer.threads, [&](std::size_t i) {
    trials[i] = s.with_one_more({singles[i].effect}, s.refitted, singles[i], 0, s.all.size());
  });
  drop_failed(trials);
  s.remember(trials);
  s.tried.insert(s.tried.end(), trials.begin(), trials.end());
  const Hypothesis* simpler = nullptr;
  for (const Tried& t : s.tried)
    if (t.hypothesis.effects.size() == 1 && stands(t) &&
        s.trainer.preference(s.chosen, t.hypothesis) > -kEqualEvidence &&
        (simpler == nullptr || t.hypothesis.fit.squares < simpler->fit.squares))
      simpler = &t.hypothesis;
  if (simpler == nullptr) return;
  s.chosen = Hypothesis(*simpler);
  s.acted.insert(Rule::one_for_several);
}

bool begin_with_others(SearchState& s) {
  if (s.chosen.effects.size() < 2 && follows_the_body(s.chosen)) return false;
  std::vector<const Tried*> firsts = first_singles(s);
  if (firsts.size() > kBeam) firsts.resize(kBeam);
  std::vector<Tried> pairs;
  for (const Tried* first : firsts) {
    const Hypothesis& on = first->hypothesis;
    EffectSet left;
    for (Effect e : s.all)
      if (!stands_for_a_member(s.model(), on.effects, e) && !contains(e, on.effects.front()))
        left.push_back(e);
    const std::vector<Proposal> proposals = s.propose(on, left, 0.78, 0.02);
    std::vector<Tried> trials(std::min(proposals.size(), kFewestFits));
    core::parallel_for(trials.size(), s.trainer.threads, [&](std::size_t i) {
      trials[i] = s.with_one_more(with(on.effects, proposals[i].effect), on, proposals[i], 1, left.size());
    });
    drop_failed(trials);
    for (Tried& t : trials) pairs.push_back(std::move(t));
  }
  s.remember(pairs);
  add_special_cases(s, pairs);
  std::stable_sort(pairs.begin(), pairs.end(), earlier_in_catalogue);
  bool better = false;
  if (const Tried* best = best_of(s, pairs)) {
    const Hypothesis& pair = simplest(s, pairs, *best).hypothesis;
    better = s.trainer.preference(s.chosen, pair) > price_of(s, pair);
    if (better) {
      s.chosen = Hypothesis(pair);
      prune(s);
    }
  }
  s.tried.insert(s.tried.end(), pairs.begin(), pairs.end());
  return better;
}

}  // namespace furcula::diagnose
