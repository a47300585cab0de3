// Parameters that are known as intervals alone, through to a gait's figures: the gait is found anew at each corner.
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "host/gait/search.hpp"

namespace furcula::gait {

struct Interval {
  double low = 0.0, high = 0.0;
};

/// Over the corners of the machine's open parameters; the gait of the values as given counts too.
struct OpenFigures {
  unsigned corners = 0, without = 0;                          ///< without: corners with no gait
  Interval cost_j, cot, eta, touchdown_knee_rad, multiplier;  ///< multiplier: the largest, without a feedback
};
/// Nothing (corners 0) where the machine has no open parameters.
OpenFigures open_figures(const Query& query, const Search& found);

}  // namespace furcula::gait
