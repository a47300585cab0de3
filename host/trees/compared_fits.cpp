#include "host/trees/compared_fits.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "host/trees/search.hpp"

namespace furcula::trees {
namespace {

/// Of a rare law in a common one's place, the odds against it beforehand; of every other, one.
constexpr double kRare = 20.0;

}  // namespace

double against(const Fit& fit, const Fit& other) {
  const std::size_t n = fit.window_loss.size();
  std::vector<double> d(n);
  for (std::size_t i = 0; i < n; ++i) d[i] = other.window_loss[i] - fit.window_loss[i];
  const double mean = std::accumulate(d.begin(), d.end(), 0.0) / static_cast<double>(n);
  double squares = 0.0;
  for (const double x : d) squares += (x - mean) * (x - mean);
  return mean * static_cast<double>(n) / std::sqrt(std::max(squares, 1e-300));
}

double log_odds(const Problem& problem, const Fit& fit, const Fit& other) {
  const double size = static_cast<double>(problem.windows().front().measured.size());
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < fit.window_loss.size(); ++i) {
    const double more =
        2.0 * size * (std::log(size + other.window_loss[i]) - std::log(size + fit.window_loss[i]));
    sum += more;
    squares += more * more;
  }
  const double n = static_cast<double>(fit.window_loss.size());
  const double of_scatter = 2.0 * sum * sum / std::max(squares - sum * sum / n, 1e-300);
  const auto beforehand = [&](const Fit& f) {
    double out = 0.5 * static_cast<double>(f.unknowns.size()) * std::log(n);
    for (const Cause& c : f.at.causes) out += is_common(c.effect) ? 0.0 : std::log(kRare);
    return out;
  };
  return std::copysign(std::min(0.5 * std::abs(sum), of_scatter), sum) + beforehand(other) - beforehand(fit);
}

bool better(Problem& problem, const Fit& a, const Fit& b) {
  for (const Hypothesis* weighed : {&a.at, &b.at}) {
    problem.weigh(*weighed);
    const Fit of_a = problem.fit(a.at, 2), of_b = problem.fit(b.at, 2);
    const auto worth = [](const Fit& f) {
      return f.loss * (1.0 + kOfParameter * static_cast<double>(f.unknowns.size()));
    };
    if (worth(of_a) > worth(of_b)) return false;
  }
  return true;
}

}  // namespace furcula::trees
