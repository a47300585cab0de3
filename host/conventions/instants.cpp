// Local parabolas, see instants.hpp.
#include "host/conventions/instants.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/core/quantile.hpp"

namespace furcula::conventions {
namespace {

/// Rows on either side of an instant.
constexpr std::array<std::size_t, 9> kReach{3, 4, 6, 9, 13, 19, 28, 42, 63};
/// Curvature's noise over the curvature itself (RMS): the rest of an equation is then seen to a few percent.
constexpr double kNoiseShare = 0.1;
/// With fewer instants nothing is asked.
constexpr std::size_t kFewest = 40;

/// No row is missing, and none is a break, from row `first` to `last`.
std::vector<std::size_t> breaks_before(const Columns& c) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < c.time_s.size(); ++i) intervals.push_back(c.time_s[i] - c.time_s[i - 1]);
  const double longest = intervals.empty() ? 0.0 : 5.0 * core::median(intervals);
  std::vector<std::size_t> count(c.time_s.size(), 0);
  for (std::size_t i = 1; i < c.time_s.size(); ++i)
    count[i] = count[i - 1] + (intervals[i - 1] > longest || (!c.breaks.empty() && c.breaks[i - 1]) ? 1 : 0);
  return count;
}

/// Standard deviation of what neighbouring rows do not share (third differences of white noise have sqrt(20) of it), a count's at least.
double white_noise(const std::vector<double>& x) {
  std::vector<double> third;
  double count = 0.0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double step = std::abs(x[i] - x[i - 1]);
    if (step > 0.0 && (count == 0.0 || step < count)) count = step;
    if (i >= 3) third.push_back(std::abs(x[i] - 3.0 * x[i - 1] + 3.0 * x[i - 2] - x[i - 3]));
  }
  if (third.empty()) return 0.0;
  return std::max(core::median(std::move(third)) / 0.6745 / std::sqrt(20.0), count / std::sqrt(12.0));
}

/// The parabola through the rows [first, last] about row `at`: least squares, by powers made orthogonal there.
class Parabola {
 public:
  Parabola(const std::vector<double>& t, std::size_t first, std::size_t last, std::size_t at)
      : first_(first), unit_(std::max(t[last] - t[at], t[at] - t[first])) {
    double s0 = 0.0, s1 = 0.0, s2 = 0.0, s3 = 0.0;
    double sum = 0.0;
    for (std::size_t i = first; i <= last; ++i) {
      place_.push_back((t[i] - t[at]) / unit_);
      sum += place_.back();
    }
    mean_ = sum / static_cast<double>(place_.size());
    for (const double p : place_) {
      const double s = p - mean_;
      s0 += 1.0, s1 += s * s, s2 += s * s * s;
    }
    bend_ = s2 / s1, level_ = s1 / s0;
    for (const double p : place_) s3 += second(p) * second(p);
    slopes_ = s1, curves_ = s3;
    double weights = 0.0;
    for (std::size_t k = 0; k < place_.size(); ++k) {
      // An input holds from its row to the next.
      const double middle = k + 1 < place_.size() ? 0.5 * (place_[k] + place_[k + 1]) : 1.0;
      const double inside = std::max(0.0, 1.0 - middle * middle);
      weight_.push_back(inside * inside);
      weights += weight_.back();
    }
    for (double& w : weight_) w /= weights;
  }
  Sample of(const std::vector<double>& x) const {
    Sample out;
    double sum = 0.0, slope = 0.0, curve = 0.0;
    out.low = out.high = x[first_];
    for (std::size_t k = 0; k < place_.size(); ++k) {
      const double y = x[first_ + k] - x[first_];
      sum += y;
      slope += (place_[k] - mean_) * y;
      curve += second(place_[k]) * y;
      out.mean += weight_[k] * x[first_ + k];
      out.low = std::min(out.low, x[first_ + k]);
      out.high = std::max(out.high, x[first_ + k]);
    }
    sum /= static_cast<double>(place_.size());
    slope /= slopes_, curve /= curves_;
    out.value = x[first_] + sum + slope * (0.0 - mean_) + curve * second(0.0);
    out.slope = (slope + curve * (2.0 * (0.0 - mean_) - bend_)) / unit_;
    out.curvature = 2.0 * curve / (unit_ * unit_);
    return out;
  }

 private:
  double second(double place) const {
    const double s = place - mean_;
    return s * s - bend_ * s - level_;
  }
  std::size_t first_;
  double unit_, mean_ = 0.0, bend_ = 0.0, level_ = 0.0, slopes_ = 1.0, curves_ = 1.0;
  std::vector<double> place_, weight_;
};

struct Place {
  std::size_t recording, row;
};

std::vector<Place> places_of(std::span<const Columns> recordings,
                             const std::vector<std::vector<std::size_t>>& breaks, std::size_t reach,
                             std::size_t most) {
  std::vector<Place> all;
  for (std::size_t r = 0; r < recordings.size(); ++r)
    for (std::size_t i = reach; i + reach < recordings[r].time_s.size(); ++i)
      if (breaks[r][i + reach] == breaks[r][i - reach]) all.push_back({r, i});
  const std::size_t step = std::max(reach, all.size() / std::max<std::size_t>(most, 1) + 1);
  std::vector<Place> some;
  for (std::size_t k = 0; k < all.size(); k += step) some.push_back(all[k]);
  return some;
}

}  // namespace

std::vector<Instant> instants_of(std::span<const Columns> recordings,
                                 const std::vector<std::vector<const std::vector<double>*>>& signals,
                                 std::span<const std::size_t> moving, std::size_t most) {
  std::vector<std::vector<std::size_t>> breaks;
  for (const Columns& c : recordings) breaks.push_back(breaks_before(c));
  std::vector<double> noise;  // of each moving signal
  for (const std::size_t s : moving) {
    double squares = 0.0;
    for (const auto* column : signals[s])
      squares += std::pow(white_noise(*column), 2) / static_cast<double>(recordings.size());
    noise.push_back(std::sqrt(squares));
  }
  std::vector<Instant> best;
  for (const std::size_t reach : kReach) {
    const std::vector<Place> places = places_of(recordings, breaks, reach, most);
    if (places.size() < kFewest) break;
    std::vector<Instant> now;
    std::vector<double> variance;  // of the curvature, for noise of unit size
    for (const Place& p : places) {
      const Columns& c = recordings[p.recording];
      const Parabola parabola(c.time_s, p.row - reach, p.row + reach, p.row);
      Instant instant;
      for (const auto& signal : signals) instant.push_back(parabola.of(*signal[p.recording]));
      now.push_back(std::move(instant));
      const double span = c.time_s[p.row + reach] - c.time_s[p.row - reach];
      // Of 2 m + 1 even rows: 720 over their fifth power times the interval's fourth.
      variance.push_back(720.0 / static_cast<double>(2 * reach + 1) / std::pow(span, 4));
    }
    bool seen = true;
    for (std::size_t k = 0; k < moving.size(); ++k) {
      double squares = 0.0, of_noise = 0.0;
      for (std::size_t i = 0; i < now.size(); ++i) {
        squares += std::pow(now[i][moving[k]].curvature, 2);
        of_noise += variance[i] * noise[k] * noise[k];
      }
      seen = seen && of_noise <= kNoiseShare * kNoiseShare * squares;
    }
    best = std::move(now);
    if (seen) break;
  }
  return best;
}

}  // namespace furcula::conventions
