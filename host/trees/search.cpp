// The search for causes on a tree, see search.hpp.
#include "host/trees/search.hpp"

#include <algorithm>
#include <limits>
#include <optional>
#include <utility>

#include "host/trees/compared_fits.hpp"
#include "host/trees/friction_laws.hpp"
#include "host/trees/judging.hpp"
#include "host/trees/pruning.hpp"
#include "host/trees/rounds.hpp"
#include "host/trees/score_test.hpp"
#include "host/trees/search_state.hpp"
#include "host/trees/sharing.hpp"

namespace furcula::trees {
namespace {

/// A window's residuals over its motion, squared, from which on nothing is linear any more.
constexpr double kGrosslyWrong = 0.02;
/// A second search is given up after so many times the steps of the first.
constexpr std::size_t kMoreWork = 2;

/// From a fit to what the recordings agree on.
Fit path(SearchState& s, Fit fit, Found* found) {
  for (int again = 0; again < 3 && !s.problem.spent(); ++again) {
    const std::size_t pruned = fit.at.causes.size();
    fit = rounds(s, std::move(fit), again == 0 ? 7 : 3, again == 0 ? found : nullptr);
    const std::size_t before = fit.at.causes.size();
    if (before != pruned) s.dropped_worth = 0.0;  // something else may account for it
    fit = prune(s, merge(s.problem, std::move(fit)), true);
    if (fit.at.causes.size() == before || s.dropped.empty()) break;
    s.problem.weigh(fit.at);
    fit = s.problem.fit(fit.at, 4);
  }
  return without_falls(s.problem, friction_anew(s, std::move(fit)));
}

/// What was taken first, of a model that is still wrong, may have led astray. Where torque is missing at the end, another search begins
/// with something else; the better end of the two counts. It is given up where it takes many times the first one's `steps`.
Fit another_path(SearchState& s, Fit fit, Found& found, std::size_t steps) {
  if (!s.first_pick || !much_is_missing(s, fit.at, found.refitted.at)) return fit;
  SearchState other{s.problem, s.progress, s.swings};
  other.not_first = s.first_pick;
  s.problem.stop_after(s.problem.steps() + kMoreWork * steps);
  Fit anew = path(other, fitted_anew(s.problem, found.refitted.at), nullptr);
  const bool given_up = s.problem.spent();
  s.problem.stop_after(std::numeric_limits<std::size_t>::max());
  if (given_up || !better(s.problem, anew, fit)) {
    s.problem.weigh(fit.at);
    return s.problem.fit(fit.at, 4);
  }
  s.take_over(other);
  s.problem.weigh(anew.at);
  return s.problem.fit(anew.at, 4);
}

/// Without the common laws that do not help the recordings to predict each other.
Fit predictive(const Problem& problem, Fit fit) {
  for (;;) {
    std::optional<Fit> least;
    for (std::size_t c = problem.model().causes.size(); c < fit.at.causes.size(); ++c) {
      if (!is_common(fit.at.causes[c].effect)) continue;
      Fit off = problem.fit(without(fit.at, c), 4, &fit);
      if (!least || off.held_out_loss < least->held_out_loss) least = std::move(off);
    }
    if (!least || least->held_out_loss > (1.0 + kWorth) * fit.held_out_loss) return fit;
    fit = std::move(*least);
  }
}

/// Common laws that act together may look like rare ones, and the search be lost among these. Where it has not come to its end, or torque is
/// missing there, another begins with the common laws at every joint and adds what is worth it beside them. The better end of the two counts.
/// It takes at most so many `steps`.
Fit common_path(SearchState& s, Fit fit, Problem* coarse, Found& found, std::size_t steps) {
  if (!found.ended_early && !much_is_missing(s, fit.at, found.refitted.at)) return fit;
  s.say(0.65, "trying the common laws at every joint");
  // A late command is nearly one law with damping and inertia under a position law: it comes in where these leave something.
  Hypothesis h = found.refitted.at;
  for (const Candidate& c : candidates(s.problem, h, {}))
    if (is_common(c.effect) && c.effect != Effect::actuator_delay && c.sites.size() == 1 &&
        !s.problem.scales().still[c.sites.front()])
      h.causes.push_back(c.columns.front());
  if (coarse != nullptr && s.problem.misfit(found.refitted.at) > kGrosslyWrong) {
    coarse->weigh(h);
    h = coarse->fit(h, 8).at;
  }
  s.problem.stop_after(s.problem.steps() + steps);
  SearchState other{s.problem, s.progress, s.swings};
  other.beside_common = true;
  Fit common = predictive(s.problem, fitted_anew(s.problem, h));
  found.common = common.at;
  Fit anew = path(other, std::move(common), nullptr);
  const bool ended_early = s.problem.spent();
  s.problem.stop_after(std::numeric_limits<std::size_t>::max());
  if (!better(s.problem, anew, fit)) {
    s.problem.weigh(fit.at);
    return s.problem.fit(fit.at, 4);
  }
  found.ended_early = ended_early;
  s.take_over(other);
  s.problem.weigh(anew.at);
  return s.problem.fit(anew.at, 4);
}

}  // namespace

Found search(Problem& problem, Problem* coarse, const Progress& progress, std::size_t most_work) {
  SearchState s{problem, progress, true};
  Found found;
  Hypothesis h{problem.model().drives, problem.model().causes};
  s.say(0.02, "fitting the free parameters");
  problem.weigh(h);
  found.refitted = problem.fit(h, 8);
  problem.weigh(found.refitted.at);
  found.refitted = problem.fit(found.refitted.at, 4);
  Fit fit = found.refitted;
  if (coarse != nullptr && problem.misfit(fit.at) > kGrosslyWrong) {
    // Where the model flies apart within a window, nothing is linear: the large causes are found on short windows.
    SearchState on_short{*coarse, progress, false};
    fit = fitted_anew(problem, rounds(on_short, fitted_anew(*coarse, fit.at), 4, &found).at);
    s.first_pick = on_short.first_pick;
  }
  const std::size_t before = problem.steps();
  problem.stop_after(most_work * before);
  fit = path(s, std::move(fit), &found);
  found.ended_early = problem.spent();
  problem.stop_after(std::numeric_limits<std::size_t>::max());
  if (!found.ended_early) fit = another_path(s, std::move(fit), found, problem.steps() - before);
  fit = common_path(s, std::move(fit), coarse, found, most_work * before);
  for (Candidate& spring : s.springs) spring.fitted_gain = 0.0;  // that was beside fewer causes
  const std::size_t steps = most_work * before;
  judge(s, found, std::move(fit), steps);
  // Rivals that took a place may be two wrong laws of friction, too.
  const auto by_squares = [&] {
    problem.weigh(found.fit.at);
    return problem.fit(found.fit.at, 4);
  };
  if (!found.ended_early)
    if (Fit anew = without_falls(problem, friction_anew(s, by_squares()));
        names(problem.model(), anew.at) != names(problem.model(), found.fit.at))
      judge(s, found, std::move(anew), steps);
  if (Fit anew = without_doubtful_latches(problem, by_squares());
      names(problem.model(), anew.at) != names(problem.model(), found.fit.at))
    judge(s, found, std::move(anew), steps);
  found.ended_early = found.ended_early || found.unjudged;
  found.disputed = std::max(s.disputed, s.dropped_worth);
  return found;
}

}  // namespace furcula::trees
