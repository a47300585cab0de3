#include "host/diagnose/simplify.hpp"

#include <algorithm>

#include "host/core/parallel.hpp"
#include "host/diagnose/laws.hpp"

namespace furcula::diagnose {

using dynamics::Effect;

const Tried* best_of(const SearchState& s, const std::vector<Tried>& trials) {
  const Tried* best = nullptr;
  for (const Tried& t : trials)
    if (stands(t) && (best == nullptr || s.trainer.preference(best->hypothesis, t.hypothesis) > 0.0))
      best = &t;
  return best;
}

const Tried& simplest(const SearchState& s, const std::vector<Tried>& trials, const Tried& best) {
  const Tried* simplest = &best;
  for (const Tried& t : trials) {
    if (!stands(t)) continue;
    const double evidence = s.trainer.preference(t.hypothesis, best.hypothesis);
    const std::size_t size = parameters_of(t.hypothesis.effects),
                      now = parameters_of(simplest->hypothesis.effects);
    const bool as_good =
        size < now ? evidence < kEqualEvidence || !leaves_more(t.hypothesis, best.hypothesis, kSmallestLoss)
                   : size == now && one_law(s.model(), t.hypothesis, simplest->hypothesis);
    if (as_good && (size < now || (size == now && &t < simplest))) simplest = &t;
  }
  return *simplest;
}

void add_special_cases(SearchState& s, std::vector<Tried>& trials) {
  struct Narrower {
    const Hypothesis *known, *without;
    const Tried* from;
    Starts starts;
  };
  std::vector<Narrower> sets;
  for (const Tried& t : trials)
    for (Effect e : t.hypothesis.effects) {
      if (told_from_special_case(t.hypothesis, e)) continue;
      const EffectSet rest = without(t.hypothesis.effects, e);
      const auto& sizes = t.hypothesis.fitted.effects.at(e);
      const double size = e == Effect::asymmetric_friction ? 0.5 * (sizes[0] + sizes[1]) : sizes[0];
      for (Effect special : s.all) {
        if (!contains(e, special) || holds(rest, special)) continue;
        const auto known = s.known.find(with(rest, special));
        if (known == s.known.end() || !leaves_more(known->second, t.hypothesis, kSmallestLoss)) continue;
        const auto none = s.known.find(rest);
        sets.push_back(
            {&known->second, none != s.known.end() ? &none->second : &s.refitted, &t, {{special, {size}}}});
      }
    }
  std::vector<Tried> narrower(sets.size());
  core::parallel_for(sets.size(), s.trainer.threads, [&](std::size_t i) {
    const Tried& from = *sets[i].from;
    narrower[i] = {
        s.trainer.fit_if_it_runs(sets[i].known->effects, from.hypothesis, sets[i].starts), from.round, {}};
    if (!narrower[i].hypothesis.failed)
      narrower[i].against_smaller = s.trainer.compare(*sets[i].without, narrower[i].hypothesis, s.all.size());
  });
  drop_failed(narrower);
  s.remember(narrower);
  for (Tried& t : narrower) trials.push_back(std::move(t));
}

void prune(SearchState& s) {
  if (!s.keeps(Rule::prune)) return;
  Hypothesis& chosen = s.chosen;
  const auto replaced_by = [&](Hypothesis smaller, bool needless) {
    if (!needless || (chosen.meaningful && !smaller.meaningful)) return false;
    s.acted.insert(Rule::prune);
    chosen = std::move(smaller);
    return true;
  };
  for (bool again = true; again && chosen.effects.size() > 1;) {
    again = false;
    for (Effect e : EffectSet(chosen.effects)) {
      const EffectSet rest = without(chosen.effects, e);
      Hypothesis smaller = s.trainer.fit_if_it_runs(rest, chosen);
      s.remember(smaller);
      const bool needless = !smaller.failed && !s.trainer.compare(smaller, chosen, s.all.size()).significant;
      again = replaced_by(std::move(smaller), needless);
      for (Effect special : s.all) {
        if (again || !contains(e, special)) continue;
        Hypothesis narrower = s.trainer.fit_if_it_runs(with(rest, special), chosen,
                                                       {{special, {chosen.fitted.effects.at(e)[0]}}});
        s.remember(narrower);
        const bool as_good =
            !narrower.failed && !s.trainer.compare(narrower, chosen, s.all.size()).told_apart;
        again = replaced_by(std::move(narrower), as_good);
      }
      if (again) break;
    }
  }
}

double price_of(const SearchState& s, const Hypothesis& h) {
  const auto more =
      static_cast<double>(parameters_of(h.effects)) - static_cast<double>(parameters_of(s.chosen.effects));
  if (more > 0.0) return chi_square_point(static_cast<double>(s.all.size()), more);
  const bool simpler = more < 0.0 || h.effects.size() < s.chosen.effects.size();
  return simpler ? -kEqualEvidence : one_law(s.model(), h, s.chosen) ? kEqualEvidence : 0.0;
}

}  // namespace furcula::diagnose
