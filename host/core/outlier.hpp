// One of some positive numbers that is far above the others.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "host/core/quantile.hpp"

namespace furcula::core {

/// How much faster, and how much harder driven, a recording may be than the others: another machine may need another torque for the
/// same motion.
inline constexpr double kFaster = 1.5, kHarder = 2.5;

struct Outlier {
  double times = 0.0;  ///< over the others' median
  bool far =
      false;  ///< eight times that, and six standard deviations of their logarithms (robustly; a third at least, one at most)
};

/// Of at least five numbers; of fewer, or of one that is not above 0, nothing is said.
inline Outlier outlier(const std::vector<double>& values, std::size_t index) {
  constexpr double kFar = 8.0, kDeviations = 6.0, kLeastScatter = 0.33, kMostScatter = 1.0;
  constexpr std::size_t kFewest = 5;
  std::vector<double> logs;
  for (std::size_t k = 0; k < values.size(); ++k)
    if (k != index && values[k] > 0.0) logs.push_back(std::log(values[k]));
  if (logs.size() + 1 < kFewest || !(values[index] > 0.0)) return {};
  const double middle = median(logs);
  for (double& l : logs) l = std::abs(l - middle);
  const double scatter = std::clamp(1.4826 * median(logs), kLeastScatter, kMostScatter);
  const double off = std::log(values[index]) - middle;
  return {std::exp(off), off > std::max(std::log(kFar), kDeviations * scatter)};
}

/// Whether the others span the size of one, but for a ratio. A recording that was driven otherwise may show what they do not.
inline bool within_others(const std::vector<double>& sizes, std::size_t index, double ratio) {
  double least = 0.0, most = 0.0;
  bool first = true;
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    if (k == index) continue;
    least = first ? sizes[k] : std::min(least, sizes[k]);
    most = first ? sizes[k] : std::max(most, sizes[k]);
    first = false;
  }
  return sizes[index] <= ratio * most && sizes[index] >= least / ratio;
}

}  // namespace furcula::core
