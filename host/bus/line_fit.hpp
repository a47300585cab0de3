// A straight line through pairs of which a few may be wrong.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

namespace furcula::bus {

struct Pair {
  double x, y;
  double x_error;  ///< what x may be off by; above 0
};

/// At most so many pairs of any number, evenly: where it is full every other one is dropped.
class PairSample {
 public:
  static constexpr std::size_t kMost = 8192;
  void add(const Pair& pair);
  const std::vector<Pair>& pairs() const { return pairs_; }

 private:
  std::vector<Pair> pairs_;
  std::uint64_t seen_ = 0, every_ = 1;
};

struct Line {
  double slope, offset;
  double slope_error;  ///< standard error
  std::size_t pairs, excluded;

  double x_mean, y_mean;  ///< of the pairs, weighted
  /// With this slope, through the middle of the pairs.
  double offset_at(double other_slope) const { return y_mean - other_slope * x_mean; }
};

/// By weighted least squares; `y_step`: of the numbers y. A pair that is farther off than twice what its errors can make of it is left out:
/// a first line, of medians, tells. Nothing: fewer than 3 pairs, all at one x, or half of them and more on no line.
std::optional<Line> fit_line(std::vector<Pair> pairs, double y_step);

}  // namespace furcula::bus
