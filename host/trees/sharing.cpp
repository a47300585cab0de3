#include "host/trees/sharing.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/trees/pruning.hpp"
#include "host/trees/score_test.hpp"

namespace furcula::trees {

using Index = Eigen::Index;

Fit apart(SearchState& s, Fit fit) {
  Hypothesis h{fit.at.drives, {}, fit.at.bodies, fit.at.inputs_late_rows};
  for (std::size_t c = 0; c < fit.at.causes.size(); ++c) {
    const Cause& cause = fit.at.causes[c];
    for (const std::size_t site : cause.sites) {
      if (c >= s.problem.model().causes.size()) h.causes.push_back({cause.effect, {site}, cause.values});
    }
    if (c < s.problem.model().causes.size()) h.causes.push_back(cause);
  }
  if (h.causes.size() == fit.at.causes.size()) return fit;
  Fit each = prune(s, s.problem.fit(h, 4), false);
  each = merge(s.problem, std::move(each));
  return each.held_out_loss < (1.0 - kWorth) * fit.held_out_loss ? each : fit;
}

Fit merge(const Problem& problem, Fit fit) {
  for (;;) {
    bool merged = false;
    for (std::size_t a = problem.model().causes.size(); a < fit.at.causes.size() && !merged; ++a)
      for (std::size_t b = a + 1; b < fit.at.causes.size() && !merged; ++b) {
        const Cause &x = fit.at.causes[a], &y = fit.at.causes[b];
        const EffectInfo& e = info(x.effect);
        if (x.effect != y.effect || e.parameter_count != 1 || e.location_type == LocationType::link ||
            x.effect == Effect::force_offset || x.effect == Effect::encoder_offset)
          continue;
        double vx = 0.0, vy = 0.0, both = 0.0;
        for (std::size_t k = 0; k < fit.unknowns.size(); ++k)
          for (std::size_t l = 0; l < fit.unknowns.size(); ++l) {
            const Unknown &u = fit.unknowns[k], &w = fit.unknowns[l];
            if (!u.of_cause || !w.of_cause) continue;
            const double c = fit.covariance(static_cast<Index>(k), static_cast<Index>(l));
            if (u.cause == a && w.cause == a) vx = c;
            if (u.cause == b && w.cause == b) vy = c;
            if (u.cause == a && w.cause == b) both = c;
          }
        const double apart = x.values[0] - y.values[0],
                     neutral = neutral_value(problem.model(), x.effect, 0, x.sites.front());
        const double size = std::abs(0.5 * (x.values[0] + y.values[0]) - neutral);
        const double variance = vx + vy - 2.0 * both;
        if (!(variance > 0.0) || apart * apart > 4.0 * variance || std::abs(apart) > 0.25 * size) continue;
        Hypothesis h = without(fit.at, b);
        h.causes[a].sites.insert(h.causes[a].sites.end(), y.sites.begin(), y.sites.end());
        std::sort(h.causes[a].sites.begin(), h.causes[a].sites.end());
        h.causes[a].values[0] = 0.5 * (x.values[0] + y.values[0]);
        fit = problem.fit(h, 4);
        merged = true;
      }
    if (!merged) return fit;
  }
}

}  // namespace furcula::trees
