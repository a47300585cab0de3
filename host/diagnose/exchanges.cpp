#include "host/diagnose/exchanges.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include "host/diagnose/bootstrap.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/other_words.hpp"
#include "host/diagnose/rivals.hpp"
#include "host/diagnose/simplify.hpp"
#include "host/diagnose/weighing.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

constexpr double kLittle = 4e-3;  // of what the re-fitted model leaves: such a member must help plainly
constexpr double kPlainly = 2.0, kAtAll = 0.5;  // standard errors
constexpr int kMostExchanges = 4;

/// Of all sets that were fitted and hold no more causes the one that is most likely, if it is ten times as likely as the chosen one.
const Hypothesis* heaviest(const SearchState& s, const Weighing& w) {
  const Hypothesis* best = nullptr;
  double most = kTenTimes;
  for (const auto& [effects, h] : s.known) {
    if (effects.empty() || effects.size() > s.chosen.effects.size() || !h.meaningful ||
        names_twice(s.model(), effects) || !s.trainer.compare(s.refitted, h, s.all.size()).significant)
      continue;
    if (const double odds = w.odds_for(h); odds > most) most = odds, best = &h;
  }
  return best;
}

/// Of larger sets that were fitted the most likely one, if it is ten times as likely as the chosen one by the motion under disturbances, and removes
/// what counts. Squares of free runs, which these dominate, ask for more.
const Hypothesis* larger(const SearchState& s, const Weighing& w) {
  if (!w.knows_motion()) return nullptr;
  const Hypothesis* best = nullptr;
  double most = kTenTimes;
  for (const auto& [effects, h] : s.known) {
    if (effects.size() <= s.chosen.effects.size() || effects.size() > kMostEffects || !h.meaningful ||
        names_twice(s.model(), effects) || !s.trainer.compare(s.chosen, h, s.all.size()).counts)
      continue;
    const std::optional<double> motion = w.of_motion(h);
    if (!motion) continue;
    if (const double odds = w.odds_for(h, motion); odds > most) most = odds, best = &h;
  }
  return best;
}

/// A Stribeck curve in the place of dry friction of one size. Its values may be known in combination alone: then the windows' scatter does
/// not tell its two sizes apart, and the likelihood under what disturbs does, if it is ten times as likely and worth its two parameters.
std::optional<Hypothesis> falling_friction(const SearchState& s, const Weighing& w) {
  const EffectSet& members = s.chosen.effects;
  if (!w.knows_motion() || !holds(members, Effect::coulomb_friction)) return std::nullopt;
  const EffectSet falling = with(without(members, Effect::coulomb_friction), Effect::stribeck_friction);
  const auto known = s.known.find(falling);
  Hypothesis h = known != s.known.end() ? known->second : s.trainer.fit_if_it_runs(falling, s.chosen);
  if (h.failed || h.meaningful) return std::nullopt;
  for (std::size_t i = 0; i < h.unknowns.size(); ++i)
    if (h.unknowns[i].of_effect && h.fit.at_bound[i]) return std::nullopt;
  if (w.odds_for(h) < kTenTimes + chi_square_point(static_cast<double>(s.all.size()), 2.0))
    return std::nullopt;
  h.meaningful = true;
  return h;
}

/// Whether a member is worth little, and of no plain help on recordings that its fit has not seen: what is left of a large cause looks
/// like a small one of another sort. Or of no help there at all.
bool is_little(const SearchState& s, const Hypothesis& without_it) {
  // Of runs that jump a linear step tells nothing; nor does one recording in one piece, nor one that a slip spoils.
  const Units units = units_of(s.trainer.training.windows);
  if (holds(s.chosen.effects, Effect::encoder_slip) ||
      machines::rules(s.model().kind).cut == machines::Cut::releases || units.size() < 2)
    return false;
  const double worth =
      (squares_of_body(without_it) - squares_of_body(s.chosen)) / s.trainer.reference_squares;
  const double help = in_standard_errors(
      gains_unseen(without_it.fit, s.chosen.fit, s.trainer.training.windows, s.trainer.recordings.size()),
      units);
  return help < (worth < kLittle ? kPlainly : kAtAll);
}

/// Of several causes the set without one of which there may be none, that is of little help, or that the recordings do not agree on:
/// by evidence that is worth the less the more their pulls scatter, as in a confidence, that set is ten times as likely.
const Hypothesis* without_the_least_agreed(const SearchState& s, const Weighing& w) {
  const EffectSet& members = s.chosen.effects;
  if (members.size() < 2) return nullptr;
  const Hypothesis* best = nullptr;
  double most = kTenTimes;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const Hypothesis& h = s.without[i];
    if (h.meaningful && judged_on(members[i], s.trainer.recordings) == identify::Channel::motion &&
        (may_be_none(s.chosen, s.model(), members[i]) || is_little(s, h)))
      return &h;
    if (!h.meaningful) continue;
    if (const double odds = w.odds_for(h); odds > most) most = odds, best = &h;
  }
  return best;
}

/// Of the sets that explain as much the likeliest one, if it is likelier than the chosen one; of another name of one law, clearly.
const Hypothesis* likeliest_rival(const SearchState& s, const Weighing& w) {
  const Hypothesis* best = nullptr;
  double most = 0.0;
  for (const auto& r : s.equals) {
    const double odds =
        w.odds_for(r.hypothesis) - (one_law(s.model(), r.hypothesis, s.chosen) ? kEqualEvidence : 0.0);
    if (odds > most) most = odds, best = &r.hypothesis;
  }
  return best;
}

struct Step {
  Hypothesis to;
  Rule by;
};

/// What takes the chosen set's place next. Sets s.equals, unless a member goes.
std::optional<Step> next_step(SearchState& s, bool may_step) {
  const Weighing w(s);
  if (may_step && s.keeps(Rule::least_agreed))
    if (const Hypothesis* fewer = without_the_least_agreed(s, w)) return Step{*fewer, Rule::least_agreed};
  s.equals = rivals(s, w);
  if (!may_step) return std::nullopt;
  if (s.keeps(Rule::rivals))
    if (const Hypothesis* rival = likeliest_rival(s, w)) return Step{*rival, Rule::rivals};
  if (s.keeps(Rule::heaviest))
    if (const Hypothesis* other = heaviest(s, w)) return Step{*other, Rule::heaviest};
  if (s.keeps(Rule::larger))
    if (const Hypothesis* more = larger(s, w)) return Step{*more, Rule::larger};
  if (s.keeps(Rule::falling_friction))
    if (std::optional<Hypothesis> falling = falling_friction(s, w))
      return Step{std::move(*falling), Rule::falling_friction};
  return std::nullopt;
}

}  // namespace

void exchange(SearchState& s) {
  for (int round = 0;; ++round) {
    s.tell(0.8 + 0.05 * round, "what cannot be told apart");
    if (s.keeps(Rule::friction_that_pushes)) put_friction_that_pushes_otherwise(s);
    s.fit_without_each();
    std::optional<Step> step = next_step(s, round < kMostExchanges);
    if (!step) return;
    s.chosen = std::move(step->to);
    s.remember(s.chosen);
    s.acted.insert(step->by);
    if (step->by == Rule::rivals || step->by == Rule::heaviest) prune(s);
  }
}

}  // namespace furcula::diagnose
