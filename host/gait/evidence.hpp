// What is said of a gait beside its figures: whether it can be kept up, what a stable one costs, how far open digits move it.
#pragma once

#include <optional>

#include "host/gait/disturbed.hpp"
#include "host/gait/open_digits.hpp"
#include "host/gait/stability.hpp"

namespace furcula::gait {

struct Evidence {
  Stability stability;
  std::optional<StableGait> stable;  ///< empty: none was found
  /// On the board's controller, with and without the feedback; no strides where the spring does not catch at once.
  Disturbed disturbed, disturbed_open_loop;
  OpenFigures open;
};
/// Of a search that found a gait. Tells its progress as the query asks.
Evidence evidence_of(const Query& query, const Search& found);

}  // namespace furcula::gait
