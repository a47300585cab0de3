#include "host/trees/judging.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "host/trees/compared_fits.hpp"
#include "host/trees/missing_torque.hpp"
#include "host/trees/picks.hpp"
#include "host/trees/pruning.hpp"

namespace furcula::trees {
namespace {

using Index = Eigen::Index;

/// So often does a rival that fits better take a cause's place.
constexpr int kMostSwaps = 4;
/// So many rivals of a cause are fitted; so many of them since they change the motion as it does, by this share of its squares.
constexpr std::size_t kMostRivals = 5, kMostAlike = 3;
constexpr double kNearlyOneLaw = 0.5;

/// A common law in the place of a rare one at the same joints, where the squares are less with it.
Fit with_common_laws(const Problem& problem, Fit fit) {
  const std::vector<Candidate> all = candidates(problem, fit.at, {});
  for (std::size_t c = problem.model().causes.size(); c < fit.at.causes.size(); ++c)
    for (const Candidate& candidate : all) {
      const Cause& rare = fit.at.causes[c];
      if (is_common(rare.effect) || !is_common(candidate.effect) || candidate.sites != rare.sites ||
          candidate.replaces >= 0)
        continue;
      Hypothesis h = fit.at;
      h.causes[c] = candidate.columns.front();
      if (Fit other = problem.fit(h, 6); other.loss < fit.loss) fit = std::move(other);
    }
  return fit;
}

/// A fit by the likelihood under what disturbs; what that is depends on the fit. Where what is left is not random, by squares: of wrong
/// models they find the one that predicts best.
Fit settled(SearchState& s, const Hypothesis& h) {
  s.problem.weigh(h);
  Fit fit = s.problem.fit(h, 4);
  for (int again = 0; s.random && again < 2; ++again) {
    s.problem.whiten(fit.at);
    fit = s.problem.fit(fit.at, 6);
  }
  return fit;
}

/// The cause for which the odds are least, where the recordings hardly tell that it is there; else their number.
std::size_t doubtful(const SearchState& s, const Fit& fit, const std::vector<Fit>& offs) {
  std::size_t least = offs.size();
  double odds = s.random ? kOdds : kOddsOfWrong;
  for (std::size_t c = 0; c < offs.size(); ++c)
    if (const double with = log_odds(s.problem, fit, offs[c]); with < odds) {
      odds = with;
      least = c;
    }
  return least;
}

/// What stands for either of two causes may stand for both: then it is the one.
bool one_for_two(SearchState& s, const Found& found, Fit& fit) {
  const std::size_t given = s.problem.model().causes.size();
  for (std::size_t a = 0; a < found.rivals.size(); ++a)
    for (std::size_t b = a + 1; b < found.rivals.size(); ++b)
      for (const Rival& of_a : found.rivals[a])
        for (const Rival& of_b : found.rivals[b]) {
          const Cause& cause = of_a.causes.front();
          if (!of_a.stands() || !of_b.stands() || cause.effect != of_b.causes.front().effect ||
              cause.sites != of_b.causes.front().sites)
            continue;
          // In it `a` is gone already, and what stands for it is there.
          Fit one = s.problem.fit(without(of_a.at, given + b - 1), 6);
          if (log_odds(s.problem, fit, one) > 0.0) continue;
          fit = settled(s, one.at);
          return true;
        }
  return false;
}

/// What is tried in the place of a cause: common laws at its sites where it is a rare one, what is nearly one law with it, and what would
/// gain about as much. `off`: the fit without it.
std::vector<Hypothesis> in_place_of(const TreeModel& model, const ScoreTest& all, const Fit& fit,
                                    std::size_t cause, const Fit& off) {
  const std::size_t out = cause - model.causes.size();
  const ScoreTest linear = all.seen_from(out);
  ScoreTest::Columns others_fitted;
  for (const Index column : linear.fitted()) {
    const Unknown& u = fit.unknowns[static_cast<std::size_t>(column - 1)];
    if (!u.of_cause || u.cause != cause) others_fitted.push_back(column);
  }
  std::vector<ScoreTest::Score> scores = all.in_place_of(out, others_fitted, kNearlyOneLaw);
  const std::size_t alike = scores.size();
  std::vector<ScoreTest::Score> by_gain = linear.scores(others_fitted, 60);
  std::stable_sort(by_gain.begin(), by_gain.end(),
                   [](const auto& a, const auto& b) { return a.gain > b.gain; });
  scores.insert(scores.end(), by_gain.begin(), by_gain.end());
  const Cause& its = fit.at.causes[cause];
  std::set<std::string> seen{cause_name(model, its)};
  std::vector<Hypothesis> others;
  const auto add = [&](const Candidate& candidate, std::span<const double> size) {
    if (candidate.replaces < 0 && seen.insert(cause_name(model, candidate.columns.front())).second)
      others.push_back(with_candidate(model, off.at, candidate, size));
  };
  // The common laws whatever the linear problem says.
  for (const Candidate& candidate : linear.candidates())
    if (!is_common(its.effect) && is_common(candidate.effect) && candidate.sites == its.sites)
      add(candidate, std::vector<double>(candidate.columns.size(), 1.0));
  const std::size_t common = others.size();
  for (std::size_t k = 0; k < scores.size() && others.size() < common + kMostRivals; ++k) {
    if (k < alike ? others.size() == common + kMostAlike : scores[k].gain < 0.3 * (off.loss - fit.loss))
      continue;
    add(linear.candidates()[scores[k].candidate], coefficients(scores[k]));
  }
  return others;
}

}  // namespace

bool much_is_missing(const SearchState& s, const Hypothesis& h, const Hypothesis& refitted) {
  if (std::max(s.disputed, s.dropped_worth) > kDisputed) return true;
  const auto lacking = [&](const Hypothesis& of) {
    return missing_torque(s.problem, s.problem.recordings(), of, s.problem.windows().front().span_s);
  };
  const std::vector<TorqueSamples> before = lacking(refitted), after = lacking(h);
  double of_before = 0.0, of_after = 0.0;
  bool structured = false;
  for (std::size_t j = 0; j < s.problem.joints(); ++j) {
    const double torque_nm = s.problem.scales().torque_nm[j];
    const Remainder was = remainder_of(before[j], s.problem.recordings().size()),
                    left = remainder_of(after[j], s.problem.recordings().size());
    if (left.is_another(torque_nm) || left.lasts(torque_nm)) return true;
    structured |= left.is_structured(torque_nm);
    // What one recording alone has nothing predicts from the others: then by what is gone.
    const double gone = (std::pow(was.rms_nm, 2) - std::pow(left.rms_nm, 2)) / std::pow(torque_nm, 2);
    of_after += std::pow(left.predictable_nm() / torque_nm, 2);
    of_before += std::max(std::pow(was.predictable_nm() / torque_nm, 2), gone);
  }
  return structured && of_after > kOfBefore * of_before;
}

void judge(SearchState& s, Found& found, Fit fit, std::size_t steps) {
  const Problem& problem = s.problem;
  fit = with_common_laws(problem, without_negligible(s.problem, std::move(fit)));
  s.random = !much_is_missing(s, fit.at, found.refitted.at);
  fit = settled(s, fit.at);
  problem.stop_after(problem.steps() + steps);
  const std::size_t given = problem.model().causes.size();
  for (int swaps = 0; swaps <= kMostSwaps; ++swaps) {
    found.gain.clear();
    found.rivals.clear();
    bool swapped = false;
    // All in one linear problem, at the whole hypothesis: each cause taken out of it, and what stands in for it.
    std::vector<Hypothesis> outs;
    std::vector<Fit> offs;
    for (std::size_t c = given; c < fit.at.causes.size(); ++c) {
      outs.push_back(without(fit.at, c));
      offs.push_back(problem.fit(outs.back(), 4, &fit));
    }
    if (outs.empty()) break;
    if (const std::size_t least = doubtful(s, fit, offs); least < offs.size() && !problem.spent()) {
      fit = settled(s, offs[least].at);
      --swaps;
      continue;
    }
    s.say(0.72, "comparing the causes with the others");
    const ScoreTest all(problem, fit.at, fit.unknowns, candidates(problem, fit.at, guesses(s, fit.at)), outs);
    for (std::size_t c = given; c < fit.at.causes.size() && !swapped; ++c) {
      s.say(0.75 + 0.2 * static_cast<double>(c - given) / static_cast<double>(fit.at.causes.size()),
            "comparing " + cause_name(problem.model(), fit.at.causes[c]) + " with the others");
      const Fit& off = offs[c - given];
      found.gain.push_back((off.loss - fit.loss) / fit.loss);
      std::vector<Rival> rivals;
      for (const Hypothesis& h : in_place_of(problem.model(), all, fit, c, off)) {
        const Fit other = problem.fit(h, 5, &off);
        if (is_unresolved(problem, other.at.causes.back())) continue;
        // The same law in another dress has the name that it had before.
        const Rival r{{other.at.causes.back()},
                      other.at,
                      log_odds(problem, fit, other),
                      s.random ? kOdds : kOddsOfWrong};
        if (swaps < kMostSwaps && r.log_odds < 0.0 && !problem.spent()) {
          fit = settled(s, other.at);
          swapped = true;
          break;
        }
        rivals.push_back(r);
      }
      found.rivals.push_back(std::move(rivals));
    }
    if (!swapped && (problem.spent() || !(swaps < kMostSwaps && one_for_two(s, found, fit)))) break;
  }
  found.unjudged = problem.spent();
  problem.stop_after(std::numeric_limits<std::size_t>::max());
  found.fit = std::move(fit);
}

}  // namespace furcula::trees
