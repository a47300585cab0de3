#include "host/trees/picks.hpp"

#include <algorithm>
#include <utility>

#include "host/trees/compared_fits.hpp"
#include "host/trees/missing_torque.hpp"
#include "host/trees/swings.hpp"

namespace furcula::trees {
namespace {

using Index = Eigen::Index;

/// So many are fitted before one is taken.
constexpr std::size_t kLeaders = 5;

bool overlap(const Candidate& a, const Candidate& b) {
  return a.effect == b.effect && std::any_of(a.sites.begin(), a.sites.end(), [&](std::size_t site) {
           return std::find(b.sites.begin(), b.sites.end(), site) != b.sites.end();
         });
}

LocationType location_type_of(const Candidate& c) {
  const LocationType type = info(c.effect).location_type;
  return is_of_joints(type) ? LocationType::joint : type;
}

/// Of the first few by the linear test, the one that is best when it is fitted.
const ScoreTest::Score* best_fitted(const Problem& problem, const ScoreTest& linear, const Fit& fit,
                                    const std::vector<const ScoreTest::Score*>& leaders) {
  const ScoreTest::Score* best = leaders.front();
  double least = 1e300;
  for (const ScoreTest::Score* score : leaders) {
    if (score->gain < 0.5 * leaders.front()->gain) continue;
    const Hypothesis h =
        with_candidate(problem.model(), fit.at, linear.candidates()[score->candidate], coefficients(*score));
    const Fit with = fit_beside(problem, h, fit, 4);
    // A parameter more must be worth a hundredth of the residuals.
    const double loss = with.loss * (1.0 + kOfParameter * static_cast<double>(with.unknowns.size()));
    if (loss < least) {
      least = loss;
      best = score;
    }
  }
  return best;
}

}  // namespace

std::span<const double> coefficients(const ScoreTest::Score& score) {
  return {score.coefficients.data(), static_cast<std::size_t>(score.coefficients.size())};
}

Guesses guesses(const SearchState& s, const Hypothesis& h) {
  const std::vector<TorqueSamples> samples =
      missing_torque(s.problem, s.problem.recordings(), h, s.problem.windows().front().span_s, 3000);
  Guesses out{ripple_cycles(s.problem, samples), limits_nm(samples), s.springs};
  for (const Candidate& c : s.ripples) {
    std::vector<double>& cycles = out.ripple_cycles[c.sites.front()];
    const double n = c.columns.front().values[1];
    if (std::find(cycles.begin(), cycles.end(), n) == cycles.end()) cycles.push_back(n);
  }
  return out;
}

std::vector<Candidate> tried(const SearchState& s, const Hypothesis& h) {
  std::vector<Candidate> out = candidates(s.problem, h, guesses(s, h));
  std::erase_if(out, [&](const Candidate& c) {
    if (s.not_first && h.causes.size() == s.problem.model().causes.size() && overlap(c, *s.not_first))
      return true;
    if (s.dropped.contains(cause_name(s.problem.model(), c.columns.front()))) return true;
    if (c.effect != Effect::position_gain_error && c.effect != Effect::damping_error) return false;
    const Effect other =
        c.effect == Effect::damping_error ? Effect::position_gain_error : Effect::damping_error;
    return std::any_of(h.causes.begin(), h.causes.end(), [&](const Cause& found) {
      return found.effect == other && std::any_of(c.sites.begin(), c.sites.end(), [&](std::size_t site) {
               return std::find(found.sites.begin(), found.sites.end(), site) != found.sites.end();
             });
    });
  });
  return out;
}

std::vector<ScoreTest::Score> pick(SearchState& s, const ScoreTest& linear, const Fit& fit,
                                   const std::set<std::string>& refused, Found* table) {
  std::vector<ScoreTest::Score> out;
  ScoreTest::Columns base = linear.fitted();
  std::set<std::pair<LocationType, std::size_t>> taken;
  for (std::size_t k = 0; k < s.problem.joints() + 1; ++k) {
    double sure = 0.0;
    const auto scores = linear.scores(base, 40, &sure);
    if (k == 0) s.disputed = sure;
    const ScoreTest::Score* best = nullptr;
    std::vector<const ScoreTest::Score*> leaders;
    std::set<std::string> seen;
    for (const auto& score : scores) {
      const Candidate& c = linear.candidates()[score.candidate];
      // Of one name the best; but a spring of another stiffness is another one.
      if (!seen.insert(cause_name(s.problem.model(), c.columns.front())).second && !c.of_one_size) continue;
      const bool free = std::none_of(c.sites.begin(), c.sites.end(), [&](std::size_t site) {
        return taken.contains({location_type_of(c), site});
      });
      if (!free || refused.contains(cause_name(s.problem.model(), c.columns.front()))) continue;
      if (best == nullptr) best = &score;
      leaders.push_back(&score);
      if (k > 0 || leaders.size() == kLeaders) break;
    }
    if (table != nullptr && k == 0 && table->table.empty())
      for (const auto& score : scores)
        table->table.push_back(
            {linear.candidates()[score.candidate].columns.front(), score.gain / linear.loss()});
    if (leaders.size() > 1) best = best_fitted(s.problem, linear, fit, leaders);
    // The linear test is about the wrong model yet: what is small beside the best waits for the next round.
    if (best == nullptr || (!out.empty() && best->gain < 0.2 * out.front().gain)) break;
    out.push_back(*best);
    const Candidate& c = linear.candidates()[best->candidate];
    for (const std::size_t site : c.sites) taken.insert({location_type_of(c), site});
    for (const Index column : linear.columns_of(best->candidate)) base.push_back(column);
  }
  return out;
}

}  // namespace furcula::trees
