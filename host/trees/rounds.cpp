#include "host/trees/rounds.hpp"

#include <algorithm>
#include <utility>

#include "host/trees/picks.hpp"
#include "host/trees/pruning.hpp"
#include "host/trees/sharing.hpp"
#include "host/trees/swings.hpp"

namespace furcula::trees {
namespace {

/// Beside common laws a rare cause must help the recordings to predict each other.
bool is_worth_it(const SearchState& s, const Fit& with, const Fit& fit) {
  const auto rare = [](const Fit& f) {
    return std::count_if(f.at.causes.begin(), f.at.causes.end(),
                         [](const Cause& c) { return !is_common(c.effect); });
  };
  return !s.beside_common || rare(with) <= rare(fit) ||
         with.held_out_loss < (1.0 - kPredicts) * fit.held_out_loss;
}

/// The hypothesis with these candidates at the sizes that the linear test says.
Hypothesis with_picks(const TreeModel& model, const Hypothesis& h, const ScoreTest& linear,
                      const std::vector<ScoreTest::Score>& picks) {
  Hypothesis next = h;
  std::vector<std::ptrdiff_t> replaced;
  for (const auto& score : picks) {
    Candidate c = linear.candidates()[score.candidate];
    if (c.replaces >= 0) {
      // Those before it in the list have moved up.
      std::ptrdiff_t shift = 0;
      for (const std::ptrdiff_t r : replaced) shift += r < c.replaces ? 1 : 0;
      replaced.push_back(c.replaces);
      c.replaces -= shift;
    }
    next = with_candidate(model, next, c, coefficients(score));
  }
  return next;
}

}  // namespace

Fit rounds(SearchState& s, Fit fit, int most, Found* found) {
  std::set<std::string> refused;  // proposed, and gone in the fit
  s.springs.clear();
  s.ripples.clear();
  bool looked_for_swings = false;  // since something was found
  bool first_alone = false;        // of the picks
  // A spring that is not there yet makes everything else look wrong.
  if (found != nullptr && s.swings) s.springs = likely_springs(s.problem, fit);
  for (int round = 0; round < most && !s.problem.spent(); ++round) {
    s.say(0.08 + 0.09 * round, "testing causes at sites");
    const ScoreTest linear(s.problem, fit.at, fit.unknowns, tried(s, fit.at));
    if (found != nullptr) found->tried = std::max(found->tried, linear.candidates().size());
    std::vector<ScoreTest::Score> picks = pick(s, linear, fit, refused, round == 0 ? found : nullptr);
    if (first_alone && !picks.empty()) picks.resize(1);
    if (picks.empty()) {
      if (looked_for_swings) break;
      if (s.swings) {
        s.springs = likely_springs(s.problem, fit);
        s.ripples = likely_ripples(s.problem, fit);
      }
      looked_for_swings = true;
      continue;
    }
    const std::size_t before = fit.at.causes.size();
    if (!s.first_pick) s.first_pick = linear.candidates()[picks.front().candidate];
    const Hypothesis next = with_picks(s.problem.model(), fit.at, linear, picks);
    s.say(0.12 + 0.09 * round,
          "fitting " + std::to_string(next.causes.size()) + (next.causes.size() == 1 ? " cause" : " causes"));
    const bool spring = springs_in(next) != springs_in(fit.at);
    if (spring) {
      s.problem.weigh(fit.at, &next);
      fit = s.problem.fit(fit.at, 1);
    }
    Fit with = prune(s, s.problem.fit(next, 6), false);
    if ((with.loss > fit.loss * (1.0 - kWorth) && with.at.causes.size() >= before) ||
        !is_worth_it(s, with, fit)) {
      // What was taken beside the first may be what spoils it.
      first_alone = picks.size() > 1;
      if (!first_alone)
        refused.insert(
            cause_name(s.problem.model(), linear.candidates()[picks.front().candidate].columns.front()));
      if (spring) {
        s.problem.weigh(fit.at);
        fit = s.problem.fit(fit.at, 1);
      }
      continue;
    }
    fit = std::move(with);
    looked_for_swings = first_alone = false;
    s.problem.weigh(fit.at);
    fit = apart(s, s.problem.fit(fit.at, 3));
  }
  return fit;
}

Fit fitted_anew(Problem& problem, const Hypothesis& h) {
  problem.weigh(h);
  const Fit fit = problem.fit(h, 6);
  problem.weigh(fit.at);
  return problem.fit(fit.at, 4);
}

}  // namespace furcula::trees
