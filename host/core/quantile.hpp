// Quantiles: of a list, and of the distributions that tests are made with.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace furcula::core {

/// The value that `share` (0 to 1) of the values lie below; 0 of none.
inline double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The upper one of the two in the middle of an even number; of at least one value.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// What a chi-square of `freedom` > 0 degrees exceeds with the probability `level`, 0 < level < 1.
double chi_square_above(double level, double freedom);

/// With which probability a chi-square of `freedom` > 0 degrees exceeds `value` >= 0.
double chi_square_beyond(double value, double freedom);

/// Student's t of `freedom` > 0 degrees lies within +- this with the probability `share`, 0 < share < 1.
double student_t_within(double share, double freedom);

}  // namespace furcula::core
