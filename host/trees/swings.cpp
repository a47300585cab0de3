// Springs and ripples that may be, see swings.hpp.
#include "host/trees/swings.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "host/trees/score_test.hpp"

namespace furcula::trees {
namespace {

Problem some_windows(const Problem& problem, const Fit& fit) {
  constexpr std::size_t kWindows = 24;
  Problem some = problem.thinned(std::max<std::size_t>(1, problem.windows().size() / kWindows));
  some.weigh(fit.at);
  return some;
}

}  // namespace

std::vector<Candidate> likely_springs(const Problem& problem, const Fit& fit) {
  constexpr std::size_t kSprings = 4;
  constexpr double kApart = 0.1;  // logarithms
  constexpr double kAsMuch = 0.4;
  const Problem some = some_windows(problem, fit);
  std::vector<std::vector<std::pair<double, Candidate>>> by_joint;  // with its gain
  double most = 0.0;
  for (std::size_t j = 0; j < problem.joints(); ++j) {
    const std::vector<Candidate> all = springs(problem, fit.at, j);
    if (all.empty()) continue;
    const ScoreTest linear(some, fit.at, fit.unknowns, all);
    auto& best = by_joint.emplace_back();
    for (const ScoreTest::Score& s : linear.scores(linear.fitted(), 40 * kSprings)) {
      const Candidate& c = all[s.candidate];
      const double stiffness = c.columns.front().values[0];
      if (std::any_of(best.begin(), best.end(), [&](const auto& o) {
            return std::abs(std::log(o.second.columns.front().values[0] / stiffness)) < kApart;
          }))
        continue;
      best.emplace_back(s.gain / linear.loss(), c);
      if (best.size() == kSprings) break;
    }
    if (!best.empty()) most = std::max(most, best.front().first);
  }
  std::vector<Candidate> out;
  for (const auto& of_joint : by_joint) {
    std::optional<Candidate> best;
    double gain = 0.5 * kRings / static_cast<double>(problem.joints());
    for (const auto& [linear_gain, c] : of_joint) {
      if (linear_gain < kAsMuch * most) continue;
      const Fit with = fit_beside(some, with_candidate(problem.model(), fit.at, c, {}), fit, 5);
      if (1.0 - with.loss / fit.loss <= gain) continue;
      gain = 1.0 - with.loss / fit.loss;
      best = c;
      best->columns.front().values[0] = with.at.causes.back().values[0];
      best->fitted_gain = gain;
    }
    if (best) out.push_back(std::move(*best));
  }
  return out;
}

std::vector<Candidate> likely_ripples(const Problem& problem, const Fit& fit) {
  constexpr std::size_t kRipples = 2;
  const std::vector<Candidate> all = ripples(problem, fit.at);
  std::vector<Candidate> out;
  if (all.empty()) return out;
  const Problem some = some_windows(problem, fit);
  const ScoreTest linear(some, fit.at, fit.unknowns, all);
  std::vector<std::size_t> taken(problem.joints());
  for (const ScoreTest::Score& s : linear.gains(linear.fitted()))
    if (taken[all[s.candidate].sites.front()]++ < kRipples) out.push_back(all[s.candidate]);
  return out;
}

std::size_t springs_in(const Hypothesis& h) {
  return static_cast<std::size_t>(std::count_if(
      h.causes.begin(), h.causes.end(), [](const Cause& c) { return c.effect == Effect::joint_elasticity; }));
}

Fit fit_beside(const Problem& problem, const Hypothesis& h, const Fit& fit, int iterations) {
  if (springs_in(h) == springs_in(fit.at)) return problem.fit(h, iterations, &fit);
  Problem own = problem;
  own.weigh(fit.at, &h);
  Fit out = own.fit(h, iterations);
  out.loss *= fit.loss / own.fit(fit.at, 1).loss;
  return out;
}

}  // namespace furcula::trees
