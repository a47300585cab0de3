// The columns of a log at instants: value, slope and curvature of each by a parabola through the rows around.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "host/conventions/trial.hpp"

namespace furcula::conventions {

/// One signal at an instant, as logged (per row's unit of time).
struct Sample {
  double value = 0.0, slope = 0.0, curvature = 0.0;
  double mean = 0.0;  ///< over the rows around, weighted as the parabola's curvature weighs accelerations
  double low = 0.0, high = 0.0;
};

/// Of one instant: [signal], in the order of `signals` below.
using Instant = std::vector<Sample>;

/// signals[s][recording] is a column of that recording. `moving`: the indices of the signals whose noise and curvature say how many rows
/// an instant takes: as few as leave its noise a tenth of the curvature, so that fast motion is not smoothed away. About `most` instants.
std::vector<Instant> instants_of(std::span<const Columns> recordings,
                                 const std::vector<std::vector<const std::vector<double>*>>& signals,
                                 std::span<const std::size_t> moving, std::size_t most);

}  // namespace furcula::conventions
