// Intervals of figures that are made of sums over recordings: the recordings are drawn anew, with replacement,
// and the figure is calculated from each draw (Efron's percentile bootstrap).
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "host/identify/windows.hpp"

namespace furcula::diagnose {

/// Indices of windows that are drawn together.
using Units = std::vector<std::vector<std::size_t>>;

/// The recordings, where there are four or more that hold a window; else blocks of windows that follow one
/// another within a recording, about ten in all: neighbouring windows are not independent.
Units units_of(const std::vector<identify::Window>& windows);

/// The mean in standard errors of it; 0 of a single value: one of a kind is no measure.
double in_standard_errors(const std::vector<double>& values);
/// The same over units, of the sums of what stands for each window.
double in_standard_errors(const std::vector<double>& of_window, const Units& units);

struct Interval {
  double lower = 0.0, upper = 0.0;
};

/// The 95 % interval of `figure`, which is told how often each unit was drawn. Always the same draws. Nothing
/// of fewer than two units.
std::optional<Interval> bootstrap(std::size_t units,
                                  const std::function<double(const std::vector<double>&)>& figure);

}  // namespace furcula::diagnose
