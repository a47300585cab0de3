// Straight lines, see line_fit.hpp.
#include "host/bus/line_fit.hpp"

#include <algorithm>
#include <cmath>

namespace furcula::bus {
namespace {

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

void PairSample::add(const Pair& pair) {
  if (seen_++ % every_ != 0) return;
  pairs_.push_back(pair);
  if (pairs_.size() < kMost) return;
  for (std::size_t i = 0; 2 * i < pairs_.size(); ++i) pairs_[i] = pairs_[2 * i];
  pairs_.resize((pairs_.size() + 1) / 2);
  every_ *= 2;
}

std::optional<Line> fit_line(std::vector<Pair> pairs, double y_step) {
  const std::size_t all = pairs.size();
  if (all < 3) return std::nullopt;
  // From a point among them: counts of an encoder may be large, and their differences matter.
  const double x0 = pairs.front().x, y0 = pairs.front().y;
  for (Pair& p : pairs) {
    p.x -= x0;
    p.y -= y0;
  }
  // H. Theil and P. Sen, with each pair beside the one half of all farther along x: up to a quarter may be wrong.
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.x < b.x; });
  std::vector<double> slopes, offsets;
  for (std::size_t i = 0; i + all / 2 < all; ++i) {
    const Pair &a = pairs[i], &b = pairs[i + all / 2];
    if (b.x > a.x) slopes.push_back((b.y - a.y) / (b.x - a.x));
  }
  if (slopes.empty()) return std::nullopt;
  const double first = median(slopes);
  for (const Pair& p : pairs) offsets.push_back(p.y - first * p.x);
  const double middle = median(offsets);
  std::erase_if(pairs, [&](const Pair& p) {
    return std::abs(p.y - first * p.x - middle) > 2.0 * (y_step / 2.0 + std::abs(first) * p.x_error);
  });
  if (pairs.size() < 3 || 2 * pairs.size() <= all) return std::nullopt;

  double w = 0.0, wx = 0.0, wy = 0.0, wxx = 0.0, wxy = 0.0, squares = 0.0;
  for (const Pair& p : pairs) {
    const double weight = 1.0 / (p.x_error * p.x_error);
    w += weight;
    wx += weight * p.x;
    wy += weight * p.y;
  }
  const double x_mean = wx / w, y_mean = wy / w;
  for (const Pair& p : pairs) {
    const double weight = 1.0 / (p.x_error * p.x_error);
    wxx += weight * (p.x - x_mean) * (p.x - x_mean);
    wxy += weight * (p.x - x_mean) * (p.y - y_mean);
  }
  if (!(wxx > 0.0)) return std::nullopt;
  const double slope = wxy / wxx;
  for (const Pair& p : pairs) {
    const double rest = p.y - y_mean - slope * (p.x - x_mean);
    squares += rest * rest / (p.x_error * p.x_error);
  }
  // What is left, or what the errors of x make of it where by chance less is.
  const double variance = std::max(squares / static_cast<double>(pairs.size() - 2), slope * slope / 12.0);
  return Line{slope,
              y0 + y_mean - slope * (x0 + x_mean),
              std::sqrt(variance / wxx),
              pairs.size(),
              all - pairs.size(),
              x0 + x_mean,
              y0 + y_mean};
}

}  // namespace furcula::bus
