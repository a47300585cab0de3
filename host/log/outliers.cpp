// Outliers and wraps of a column, see outliers.hpp.
#include "host/log/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "host/core/quantile.hpp"

namespace furcula::log {
namespace {

constexpr std::size_t kLongestBurst = 8;
constexpr std::size_t kAround = 8;  // steps on either side that tell how fast the body moves

double distance(double value, double one, double other) {
  const auto [low, high] = std::minmax(one, other);
  return std::max({0.0, low - value, value - high});
}

/// Below this no value is out of line: twelve standard deviations of what neighbouring rows do not share (third
/// differences: a smooth motion has hardly any), four counts, and a ten-thousandth of the travel.
double least_distance(std::span<const double> x, double noise) {
  std::vector<double> third;
  third.reserve(x.size());
  double count = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double step = std::abs(x[i] - x[i - 1]);
    if (step > 0.0 && (count == 0.0 || step < count)) count = step;
    if (i >= 3) third.push_back(std::abs(x[i] - 3.0 * x[i - 1] + 3.0 * x[i - 2] - x[i - 3]));
  }
  // Median of |normal| is 0.6745 of its deviation; third differences of white noise have sqrt(20) of it.
  const double white = core::median(std::move(third)) / 0.6745 / std::sqrt(20.0);
  const std::vector<double> all(x.begin(), x.end());
  const double travel = core::quantile(all, 0.99) - core::quantile(all, 0.01);
  return std::max(12.0 * std::max({white, count / std::sqrt(12.0), noise}) + 4.0 * count, 1e-4 * travel);
}

/// Median speed over up to kAround steps from row `at` on, forwards or backwards, over rows that are not out.
double speed_from(std::span<const double> t, std::span<const double> x, const std::vector<bool>& out,
                  std::size_t at, bool forwards) {
  std::vector<double> speeds;
  std::size_t last = at;
  while (speeds.size() < kAround) {
    if (forwards ? last + 1 >= x.size() : last == 0) break;
    std::size_t next = forwards ? last + 1 : last - 1;
    while (out[next] && (forwards ? next + 1 < x.size() : next > 0)) forwards ? ++next : --next;
    if (out[next]) break;
    speeds.push_back(std::abs((x[next] - x[last]) / (t[next] - t[last])));
    last = next;
  }
  return speeds.empty() ? 0.0 : core::median(std::move(speeds));
}

}  // namespace

std::vector<std::size_t> steps_out_and_back(std::span<const double> t, std::span<const double> x,
                                            double noise) {
  constexpr double kWay = 2.0;           // times the way that the body goes
  constexpr double kWayAtEnd = 3.0;      // the same, on one side
  constexpr std::size_t kMostAtEnd = 3;  // rows
  const std::size_t n = x.size();
  std::vector<std::size_t> found;
  if (n < 3 * kAround) return found;
  const double least = least_distance(x, noise);
  std::vector<bool> out(n, false);

  // The ends: further from the next row than the body goes at the speed that it has in all but a twentieth.
  std::vector<double> steps;
  for (std::size_t i = 1; i < n; ++i) steps.push_back(std::abs((x[i] - x[i - 1]) / (t[i] - t[i - 1])));
  const double fast = core::quantile(steps, 0.95);
  const auto end = [&](bool first) {
    const auto row = [&](std::size_t k) { return first ? k : n - 1 - k; };
    for (std::size_t k = 1; k <= kMostAtEnd; ++k) {
      const std::size_t next = row(k);
      const double speed = std::max(fast, speed_from(t, x, out, next, first));
      const auto far = [&](std::size_t other) {
        return std::abs(x[other] - x[next]) > least + kWayAtEnd * speed * std::abs(t[next] - t[other]);
      };
      bool all = !far(row(k + 1));
      for (std::size_t j = 0; j < k; ++j) all = all && far(row(j));
      if (!all) continue;
      for (std::size_t j = 0; j < k; ++j) out[row(j)] = true;
      return;
    }
  };
  end(true);
  end(false);

  std::size_t before = 0;
  while (before < n && out[before]) ++before;
  for (std::size_t i = before + 1; i + 1 < n; ++i) {
    if (out[i]) continue;
    std::size_t burst = 0;
    if (std::abs(x[i] - x[before]) > least)
      for (std::size_t k = 1; k <= kLongestBurst && i + k < n && burst == 0; ++k) {
        const std::size_t after = i + k;
        if (out[after] || distance(x[i], x[before], x[after]) <= least) continue;
        const double speed =
            std::max(speed_from(t, x, out, before, false), speed_from(t, x, out, after, true));
        const double beyond = least + kWay * speed * (t[after] - t[before]);
        bool all = true;
        for (std::size_t j = i; j < after; ++j) all = all && distance(x[j], x[before], x[after]) > beyond;
        if (all) burst = k;
      }
    for (std::size_t j = i; j < i + burst; ++j) out[j] = true;
    if (burst == 0)
      before = i;
    else
      i += burst - 1;
  }
  for (std::size_t i = 0; i < n; ++i)
    if (out[i]) found.push_back(i);
  return found;
}

std::vector<std::size_t> off_at_ends(std::span<const double> t, std::span<const double> x) {
  constexpr std::size_t kMostRows = 8, kFit = 8, kPlaces = 2000;
  constexpr double kFar = 4.0, kWay = 1.5, kAlike = 0.6, kFits = 0.25;
  const std::size_t n = x.size();
  std::vector<std::size_t> found;
  if (n < 4 * kFit) return found;
  // How far row `at` is from the parabola through the kFit rows from `from` on: least squares, by powers that are made orthogonal there.
  const auto off = [&](std::size_t from, std::size_t at) {
    const double unit = t[from + kFit - 1] - t[from];
    double s1 = 0.0, s2 = 0.0, s3 = 0.0;
    const auto from_mean = [&, mean = std::accumulate(t.begin() + static_cast<std::ptrdiff_t>(from),
                                                      t.begin() + static_cast<std::ptrdiff_t>(from + kFit),
                                                      0.0) /
                                      kFit](std::size_t k) { return (t[k] - mean) / unit; };
    for (std::size_t k = from; k < from + kFit; ++k) {
      const double s = from_mean(k);
      s1 += s * s;
      s2 += s * s * s;
    }
    const double bend = s2 / s1, level = s1 / kFit;
    const auto second = [&](std::size_t k) {
      const double s = from_mean(k);
      return s * s - bend * s - level;
    };
    double sum = 0.0, slope = 0.0, curve = 0.0;
    for (std::size_t k = from; k < from + kFit; ++k) {
      const double y = x[k] - x[from];
      sum += y;
      slope += from_mean(k) * y;
      curve += second(k) * y;
      s3 += second(k) * second(k);
    }
    return x[at] - x[from] - sum / kFit - slope / s1 * from_mean(at) - curve / s3 * second(at);
  };
  std::vector<double> usual;
  const std::size_t step = std::max<std::size_t>(1, n / kPlaces);
  for (std::size_t i = 0; i + kFit < n; i += step) {
    usual.push_back(std::abs(off(i, i + kFit)));
    usual.push_back(std::abs(off(i + 1, i)));
  }
  const double far = std::max(least_distance(x, 0.0), kFar * core::quantile(std::move(usual), 0.99));
  for (const bool first : {true, false})
    for (std::size_t k = kMostRows; k > 0; --k) {
      const auto row = [&](std::size_t j) { return first ? j : n - 1 - j; };  // counted from the end
      const std::size_t from = first ? k : n - k - kFit;
      const double next = off(from, row(k - 1)), way = std::abs(x[row(k + 1)] - x[row(k)]);
      if (std::abs(next) <= far + kWay * way) continue;
      // A knock among those rows is no parabola.
      bool all = true;
      for (std::size_t i = from; i < from + kFit; ++i)
        all = all && std::abs(off(from, i)) < kFits * std::abs(next);
      for (std::size_t j = k - std::min<std::size_t>(k, 2); j + 1 < k; ++j)
        all = all && std::abs(off(from, row(j)) - next) < kAlike * std::abs(next);
      if (!all) continue;
      for (std::size_t j = 0; j < k; ++j) found.push_back(row(j));
      break;
    }
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::size_t> stuck(std::span<const double> t, std::span<const double> x) {
  constexpr std::size_t kFewest = 10;
  constexpr double kWay = 3.0, kOfSpeed = 0.2, kMoves = 0.02;
  const std::size_t n = x.size();
  std::vector<std::size_t> found;
  if (n < 3 * kAround) return found;
  const double least = least_distance(x, 0.0);
  const std::vector<bool> none(n, false);
  for (std::size_t first = 0; first + 1 < n;) {
    std::size_t end = first + 1;  // the first row of another value
    while (end < n && x[end] == x[first]) ++end;
    if (end < n && end - first >= kFewest) {
      const double before = speed_from(t, x, none, first, false), after = speed_from(t, x, none, end, true),
                   jump = std::abs(x[end] - x[first]), needed = jump / (t[end] - t[first]);
      if (jump > least + kWay * after * (t[end] - t[end - 1]) &&
          std::max(before, after) > kOfSpeed * needed && std::min(before, after) > kMoves * needed)
        for (std::size_t k = first + 1; k < end; ++k) found.push_back(k);
    }
    first = end;
  }
  return found;
}

std::vector<std::size_t> far_beyond_others(std::span<const double> values) {
  constexpr double kFar = 50.0;
  constexpr double kMost = 0.05;  // of the rows
  constexpr std::size_t kMostInARow = 3;
  std::vector<std::size_t> found;
  std::vector<double> sizes;
  for (const double v : values) sizes.push_back(std::abs(v));
  std::sort(sizes.begin(), sizes.end());
  double beyond = 0.0;
  for (std::size_t i = static_cast<std::size_t>((1.0 - kMost) * static_cast<double>(sizes.size()));
       i + 1 < sizes.size() && beyond == 0.0; ++i)
    if (sizes[i] > 0.0 && sizes[i + 1] > kFar * sizes[i]) beyond = sizes[i + 1];
  if (beyond == 0.0) return found;
  for (std::size_t i = 0; i < values.size();) {
    std::size_t end = i;
    while (end < values.size() && std::abs(values[end]) >= beyond) ++end;
    if (end - i <= kMostInARow)
      for (std::size_t k = i; k < end; ++k) found.push_back(k);
    i = std::max(end, i + 1);
  }
  return found;
}

double wrap_span(std::span<const double> t, std::span<const double> x, double turn) {
  constexpr double kOfRange = 0.6;
  constexpr double kSame = 0.02;
  if (x.size() < 3 * kAround) return 0.0;
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  const double range = *high - *low;
  if (!(range > 0.0)) return 0.0;
  const std::vector<bool> none(x.size(), false);
  std::vector<double> spans;
  std::size_t against = 0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double step = x[i] - x[i - 1];
    if (std::abs(step) < kOfRange * range) continue;
    // How the body moves there, by a median over the steps around.
    std::vector<double> around;
    for (std::size_t k = i > kAround ? i - kAround : 1; k < std::min(x.size(), i + kAround + 1); ++k)
      if (k != i) around.push_back((x[k] - x[k - 1]) / (t[k] - t[k - 1]));
    const double goes = core::median(std::move(around)) * (t[i] - t[i - 1]);
    spans.push_back(std::abs(step - goes));
    if (step * goes < 0.0) ++against;
  }
  if (spans.empty()) return 0.0;
  double span = core::median(spans);
  const bool is_turn = turn > 0.0 && std::abs(span - turn) < kSame * turn;
  if (is_turn) span = turn;
  for (const double s : spans)
    if (std::abs(s - span) > kSame * span) return 0.0;
  // About an end it may jump to and fro with the noise: most jumps go against the motion.
  const bool wraps = range < (1.0 + kSame) * span && 5 * against >= 4 * spans.size();
  return wraps && (is_turn || spans.size() >= 2) ? span : 0.0;
}

std::vector<double> unwrapped(std::span<const double> values, double span) {
  std::vector<double> out(values.begin(), values.end());
  double turns = 0.0;
  for (std::size_t i = 1; i < out.size(); ++i) {
    const double step = values[i] - values[i - 1];
    if (step > 0.5 * span) turns -= 1.0;
    if (step < -0.5 * span) turns += 1.0;
    out[i] += turns * span;
  }
  return out;
}

}  // namespace furcula::log
