#include "host/diagnose/growth.hpp"

#include <algorithm>
#include <utility>

#include "host/core/parallel.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/simplify.hpp"
#include "host/diagnose/wording.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

constexpr double kSmallestScreening = 0.2;  // of the best proposal's

/// Of proposals of which the first `fixed` are fitted in any case.
std::size_t count_promising(const std::vector<Proposal>& proposals, std::size_t fixed, std::size_t most) {
  most = std::min(std::max(most, fixed + kFewestFits), proposals.size());
  double most_promising = 0.0;
  for (const Proposal& p : proposals) most_promising = std::max(most_promising, p.gain);
  std::size_t count = std::min(std::max(fixed, kFewestFits), most);
  while (count < most && proposals[count].gain > kSmallestScreening * most_promising) ++count;
  return count;
}

EffectSet promising(const std::vector<Proposal>& proposals, std::size_t most) {
  EffectSet effects;
  const std::size_t count = count_promising(proposals, 0, most);
  for (std::size_t i = 0; i < count; ++i) effects.push_back(proposals[i].effect);
  return effects;
}

/// How many of the proposals on top of `on` are fitted; puts them first. `promised`: those among them that no rule has to put there.
std::size_t worth_a_fit(const SearchState& s, std::vector<Proposal>& proposals, const Hypothesis& on,
                        std::size_t most, EffectSet& promised) {
  promised = promising(proposals, most);
  // What does not move the body promises little beside what does, dry friction that sticks is badly judged
  // by a linear step, and a slip by windows that do not hold it: those first, always; and a law that has
  // one of the set as a special case, where that does not do. What a clutch's teeth make of a start is no
  // linear step's affair either.
  const bool lacking = !on.effects.empty() && !follows_the_body(on);
  const auto always = [&](const Proposal& p) {
    if (!s.keeps(Rule::always_fitted)) return false;
    const identify::Channel judge = judged_on(p.effect, s.trainer.recordings);
    const bool hardly_seen = judge == identify::Channel::contact || judge == identify::Channel::drive;
    const bool wider =
        std::any_of(on.effects.begin(), on.effects.end(), [&](Effect e) { return contains(p.effect, e); });
    const bool jumps = dynamics::needs_clutch(p.effect);
    return (jumps && (most >= kMostFits || lacking)) || (hardly_seen && p.gain > 0.0) || (lacking && wider) ||
           p.effect == Effect::encoder_slip ||
           ((most >= kMostFits || lacking) &&
            (p.effect == Effect::coulomb_friction ||
             (!dynamics::has(s.model().kind, dynamics::LocationType::leg) &&
              (p.effect == Effect::asymmetric_friction || p.effect == Effect::stribeck_friction))));
  };
  const auto first_other = std::stable_partition(proposals.begin(), proposals.end(), always);
  const auto fixed = static_cast<std::size_t>(first_other - proposals.begin());
  return count_promising(proposals, fixed, most);
}

/// Where a larger set removes more but means nothing, because the new member explains what an old one was
/// taken for: the new one in the place of that, if the set is better than the chosen one.
bool swap_members(SearchState& s, const std::vector<Tried>& trials, const EffectSet& before,
                  std::size_t round) {
  std::vector<std::pair<EffectSet, const Hypothesis*>> sets;
  const Hypothesis* best = nullptr;
  for (const Tried& t : trials) {
    if (!t.against_smaller.significant || t.hypothesis.meaningful) continue;
    for (Effect e : before)
      if (holds(t.hypothesis.effects, e)) sets.push_back({without(t.hypothesis.effects, e), &t.hypothesis});
    if (best == nullptr || t.hypothesis.fit.squares < best->fit.squares) best = &t.hypothesis;
  }
  // An old member that was a stand-in, where the best of them leaves less than half of the body's error:
  // other single causes in its place, of one law under two names the first.
  if (best != nullptr && before.size() == 1 && squares_of_body(*best) < 0.5 * squares_of_body(s.chosen)) {
    const Hypothesis* last = nullptr;
    std::size_t others = 0;
    for (const Tried* first : first_singles(s)) {
      const Effect e = first->hypothesis.effects.front();
      if (holds(best->effects, e) || (last != nullptr && the_same(first->hypothesis, *last))) continue;
      last = &first->hypothesis;
      sets.push_back({with(without(best->effects, before.front()), e), best});
      if (++others == kBeam) break;
    }
  }
  std::erase_if(sets, [&](const auto& set) { return names_twice(s.model(), set.first); });
  std::vector<Tried> swaps(sets.size());
  core::parallel_for(sets.size(), s.trainer.threads, [&](std::size_t i) {
    swaps[i] = {s.trainer.fit_if_it_runs(sets[i].first, *sets[i].second), round, {}};
    if (!swaps[i].hypothesis.failed)
      swaps[i].against_smaller = s.trainer.compare(s.refitted, swaps[i].hypothesis, s.all.size());
  });
  drop_failed(swaps);
  s.remember(swaps);
  bool swapped = false;
  for (const Tried& t : swaps)
    if (stands(t) && s.trainer.preference(s.chosen, t.hypothesis) > price_of(s, t.hypothesis)) {
      s.chosen = Hypothesis(t.hypothesis);
      swapped = true;
    }
  s.tried.insert(s.tried.end(), swaps.begin(), swaps.end());
  return swapped;
}

}  // namespace

void grow(SearchState& s, std::size_t first_round) {
  for (std::size_t round = first_round; round < kMostEffects; ++round) {
    EffectSet left;
    for (Effect e : s.all)
      if (!stands_for_a_member(s.model(), s.chosen.effects, e)) left.push_back(e);
    const double from = 0.05 + 0.18 * static_cast<double>(round);
    std::vector<Proposal> proposals = s.propose(s.chosen, left, from, 0.09);
    if (round == 0) s.first_screenings = proposals;
    EffectSet promised;
    std::vector<Tried> trials(
        worth_a_fit(s, proposals, s.chosen, round == 0 ? kMostFits : kMostFits / 2, promised));
    core::parallel_for(trials.size(), s.trainer.threads, [&](std::size_t i) {
      const EffectSet larger = extended(s.chosen.effects, proposals[i].effect);
      s.tell(from + 0.09, names(larger));
      trials[i] = s.with_one_more(larger, s.chosen, proposals[i], round, left.size());
    });
    drop_failed(trials);
    s.remember(trials);
    add_special_cases(s, trials);
    std::sort(trials.begin(), trials.end(), earlier_in_catalogue);
    const EffectSet before = s.chosen.effects;
    const Tried* best = best_of(s, trials);
    if (best != nullptr) s.chosen = simplest(s, trials, *best).hypothesis;
    for (Effect e : s.chosen.effects)
      if (!holds(before, e) && !holds(promised, e)) s.acted.insert(Rule::always_fitted);
    const bool swapped = s.keeps(Rule::swap_members) && swap_members(s, trials, before, round);
    s.tried.insert(s.tried.end(), trials.begin(), trials.end());
    if (swapped) s.acted.insert(Rule::swap_members);
    if (best == nullptr && !swapped) return;
    prune(s);
  }
}

std::vector<const Tried*> first_singles(const SearchState& s) {
  std::vector<const Tried*> firsts;
  for (const Tried& t : s.tried)
    if (t.round == 0 && (t.against_smaller.significant || s.chosen.effects.empty()) &&
        t.hypothesis.effects.size() == 1)
      firsts.push_back(&t);
  std::sort(firsts.begin(), firsts.end(), [](const Tried* a, const Tried* b) {
    return a->hypothesis.fit.squares < b->hypothesis.fit.squares;
  });
  return firsts;
}

}  // namespace furcula::diagnose
