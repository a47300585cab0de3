#include "host/trees/pruning.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/quantile.hpp"
#include "host/trees/compared_fits.hpp"
#include "host/trees/friction_at_rest.hpp"
#include "host/trees/linear.hpp"
#include "host/trees/score_test.hpp"
#include "host/trees/swings.hpp"

namespace furcula::trees {
namespace {

using Index = Eigen::Index;

/// A cause without which the loss is so many times as much stays.
constexpr double kMissed = 2.0;
/// At the end a cause is dropped, too, whose size the recordings agree on by less than this share of what the linear test asks: half of that
/// where they predict each other with it better by kPredicts.
constexpr double kAgree = 0.7;
/// A cause alone that makes the recordings predict each other better by this share is no chance, however few they are.
constexpr double kPredictsMuch = 0.15;
/// At the end a cause must be as far from none as chance is with this probability, all its parameters together, by windows and recordings:
/// five standard deviations of one. A hundred causes are tried, and neighbouring windows are not independent.
constexpr double kChance = 5.7e-7;
/// And it must be worth so much of what all causes are, by squares.
constexpr double kOfAll = 0.004;
/// What a spring is worth of a joint's share of the loss counts, where it is so many times its scatter from window to window.
constexpr double kRingsSurely = 3.5;
/// A delay, lag or skew of less than this share of the rows' interval is none: a time anywhere in it, of which a row does not tell, scatters by
/// as much, one over the square root of twelve.
constexpr double kResolved = 0.2887;

/// How far the cause's parameters are from having no effect, in their own scatter, squared.
/// `steady`: what the recordings must agree on its size, of what the linear test asks.
double distance(const Problem& problem, const Fit& fit, std::size_t cause, double steady) {
  double most = 0.0;
  const Cause& c = fit.at.causes[cause];
  if (is_unresolved(problem, c)) return 0.0;
  std::size_t moving = 0;
  for (std::size_t k = 0; k < fit.unknowns.size(); ++k)
    if (fit.unknowns[k].of_cause && fit.unknowns[k].cause == cause &&
        fit.covariance(static_cast<Index>(k), static_cast<Index>(k)) > 0.0)
      ++moving;
  for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
    const Unknown& u = fit.unknowns[k];
    if (!u.of_cause || u.cause != cause) continue;
    const double neutral = neutral_value(problem.model(), c.effect, u.parameter, c.sites.front());
    if (std::isnan(neutral)) continue;
    const double variance = fit.covariance(static_cast<Index>(k), static_cast<Index>(k));
    const double away = value_of(fit.at, u) - neutral;
    std::vector<double> apart = fit.fold_value[k];
    for (double& x : apart) x -= neutral;
    if (variance > 0.0 &&
        (steady == 0.0 || steadiness(apart, fit.fold_information[k]) > steady * agreement(moving, problem)))
      most = std::max(most, away * away / variance);
    if (fit.at_bound[k] && std::abs(away) > 0.5 * u.scale) most = std::max(most, 50.0);
  }
  if (c.effect == Effect::torque_saturation || c.effect == Effect::joint_elasticity)
    most = std::max(most, 50.0);
  return most;
}

bool by_chance(const Problem& problem, const Fit& fit, std::size_t cause, double Away::*by = &Away::squares) {
  const Away away = away_from_none(problem.model(), fit, cause);
  return away.parameters > 0 &&
         away.*by < core::chi_square_above(kChance, static_cast<double>(away.parameters));
}

void drop(SearchState& s, const std::string& name, const Fit& with, const Fit& off) {
  s.dropped.insert(name);
  s.dropped_worth = std::max(s.dropped_worth, (off.loss - with.loss) / off.loss);
}

/// A stiffness is never near to having no effect: what tells is how much is lost without it. The least first.
Fit without_doubtful_springs(SearchState& s, Fit fit) {
  for (;;) {
    std::optional<Fit> least;
    std::string name;
    for (std::size_t c = s.problem.model().causes.size(); c < fit.at.causes.size(); ++c) {
      if (fit.at.causes[c].effect != Effect::joint_elasticity) continue;
      Fit off = s.problem.fit(without(fit.at, c), 4, &fit);
      const double share = kRings / static_cast<double>(s.problem.joints());
      const bool much = off.loss > (1.0 + kRings) * fit.loss,
                 surely = off.loss > (1.0 + share) * fit.loss && against(fit, off) > kRingsSurely;
      if (much || surely || (least && off.loss > least->loss)) continue;
      least = std::move(off);
      name = cause_name(s.problem.model(), fit.at.causes[c]);
    }
    if (!least) return fit;
    drop(s, name, fit, *least);
    fit = std::move(*least);
  }
}

/// Dry friction must gain where its joint moves.
Fit without_friction_at_rest(SearchState& s, Fit fit) {
  const std::size_t given = s.problem.model().causes.size();
  for (std::size_t c = given; c < fit.at.causes.size();) {
    const Cause cause = fit.at.causes[c];
    const std::vector<bool> moves =
        is_dry_friction(cause.effect) ? windows_in_motion(s.problem, cause) : std::vector<bool>{};
    if (std::find(moves.begin(), moves.end(), false) != moves.end()) {
      Fit off = s.problem.fit(without(fit.at, c), 4, &fit);
      if (!gains_in_motion(fit, off, moves)) {
        s.dropped.insert(cause_name(s.problem.model(), cause));
        fit = std::move(off);
        c = given;
        continue;
      }
    }
    ++c;
  }
  return fit;
}

}  // namespace

bool is_unresolved(const Problem& problem, const Cause& c) {
  return (c.effect == Effect::actuator_delay || c.effect == Effect::actuator_lag ||
          c.effect == Effect::time_skew) &&
         std::abs(c.values[0]) < kResolved * problem.interval_s();
}

Fit prune(SearchState& s, Fit fit, bool strict) {
  if (strict) fit = without_friction_at_rest(s, without_doubtful_springs(s, std::move(fit)));
  std::set<std::string> predicts;
  for (;;) {
    std::size_t weakest = fit.at.causes.size();
    double least = kHolds;
    for (std::size_t c = s.problem.model().causes.size(); c < fit.at.causes.size(); ++c) {
      const double d =
          strict && by_chance(s.problem, fit, c) ? 0.0 : distance(s.problem, fit, c, strict ? kAgree : 0.0);
      if (d >= least || predicts.contains(cause_name(s.problem.model(), fit.at.causes[c]))) continue;
      least = d;
      weakest = c;
    }
    if (weakest == fit.at.causes.size()) return fit;
    Fit off = s.problem.fit(without(fit.at, weakest), 4, &fit);
    const bool unresolved = is_unresolved(s.problem, fit.at.causes[weakest]);
    // Much is there in a few windows only: their scatter then says little.
    if (!strict && !unresolved && off.loss > kMissed * fit.loss) return fit;
    const std::string name = cause_name(s.problem.model(), fit.at.causes[weakest]);
    const double predicts_more = off.held_out_loss / fit.held_out_loss - 1.0;
    const bool alone = fit.at.causes.size() == s.problem.model().causes.size() + 1;
    if (strict && !unresolved &&
        ((alone && predicts_more > kPredictsMuch) ||
         (!by_chance(s.problem, fit, weakest) && distance(s.problem, fit, weakest, 0.5 * kAgree) >= kHolds &&
          predicts_more > kPredicts))) {
      predicts.insert(name);
      continue;
    }
    // What chance makes in windows alone is nothing; what the windows are sure of and the recordings are not is something.
    if (strict && !by_chance(s.problem, fit, weakest, &Away::by_windows)) drop(s, name, fit, off);
    if (strict) s.dropped.insert(name);
    fit = std::move(off);
  }
}

Fit without_doubtful_latches(const Problem& problem, Fit fit) {
  for (std::size_t c = fit.at.causes.size(); c-- > problem.model().causes.size();) {
    const Effect e = fit.at.causes[c].effect;
    if (e != Effect::latch_delay && e != Effect::latch_offset) continue;
    if (away_from_none(problem.model(), fit, c).squares < kHolds)
      fit = problem.fit(without(fit.at, c), 4, &fit);
  }
  return fit;
}

Fit without_negligible(Problem& problem, Fit fit) {
  for (;;) {
    problem.weigh(fit.at);
    fit = problem.fit(fit.at, 4);
    std::optional<Fit> least;
    double all = 0.0;
    for (std::size_t c = problem.model().causes.size(); c < fit.at.causes.size(); ++c) {
      Fit off = problem.fit(without(fit.at, c), 4, &fit);
      all += std::max(0.0, off.loss - fit.loss);
      if (!least || off.loss < least->loss) least = std::move(off);
    }
    if (!least || least->at.causes.size() == problem.model().causes.size() ||
        least->loss - fit.loss >= kOfAll * all)
      return fit;
    fit = std::move(*least);
  }
}

}  // namespace furcula::trees
