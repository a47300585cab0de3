#include "host/diagnose/search_state.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/parallel.hpp"
#include "host/diagnose/laws.hpp"

namespace furcula::diagnose {

using dynamics::Effect;

void SearchState::remember(const Hypothesis& h) {
  if (h.failed) return;
  const auto [at, is_new] = known.try_emplace(h.effects, h);
  if (is_new) return;
  const Hypothesis& other = at->second;
  if (h.meaningful != other.meaningful ? h.meaningful : h.fit.squares < other.fit.squares) at->second = h;
}

Tried SearchState::with_one_more(const EffectSet& larger, const Hypothesis& on, const Proposal& proposal,
                                 std::size_t round, std::size_t tries) const {
  Tried t;
  t.round = round;
  t.hypothesis = fit_new(trainer, larger, on, proposal);
  if (!t.hypothesis.failed) t.against_smaller = trainer.compare(on, t.hypothesis, tries);
  return t;
}

std::vector<Proposal> SearchState::propose(const Hypothesis& on, const EffectSet& effects,
                                           double progress_from, double progress_share) const {
  const double left = proposer.squares_left(on);
  std::vector<Proposal> proposals(effects.size());
  core::parallel_for(effects.size(), trainer.threads, [&](std::size_t i) {
    const double share = static_cast<double>(i) / static_cast<double>(effects.size());
    tell(progress_from + progress_share * share, dynamics::info(effects[i]).name);
    proposals[i] = proposer.best(on, extended(on.effects, effects[i]), effects[i], left);
  });
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const Proposal& a, const Proposal& b) { return a.gain > b.gain; });
  return proposals;
}

void SearchState::fit_without_each() {
  const EffectSet& members = chosen.effects;
  without.assign(members.size(), {});
  core::parallel_for(members.size(), trainer.threads, [&](std::size_t i) {
    const EffectSet rest = diagnose::without(members, members[i]);
    without[i] = trainer.fit_if_it_runs(rest, chosen);
    if (without[i].failed) without[i] = trainer.fit(rest, &refitted);
  });
  for (const Hypothesis& h : without) remember(h);
}

bool the_same(const Hypothesis& one, const Hypothesis& other) {
  // Of a slip between the windows no run tells.
  return holds(one.effects, Effect::encoder_slip) == holds(other.effects, Effect::encoder_slip) &&
         std::abs(one.fit.squares - other.fit.squares) < 1e-4 * other.fit.squares;
}

bool one_law(const model::Model& model, const Hypothesis& one, const Hypothesis& other) {
  return always_same(model, one.effects, other.effects) || the_same(one, other);
}

bool stands(const Tried& t) { return t.against_smaller.significant && t.hypothesis.meaningful; }

bool earlier_in_catalogue(const Tried& a, const Tried& b) {
  return a.hypothesis.effects < b.hypothesis.effects;
}

void drop_failed(std::vector<Tried>& all) {
  std::erase_if(all, [](const Tried& t) { return t.hypothesis.failed; });
}

}  // namespace furcula::diagnose
