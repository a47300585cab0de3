// A recording that is of another robot than the others are.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/trees/fit.hpp"

namespace furcula::trees {

struct Disagreement {
  std::size_t recording = 0;
  std::string why;  ///< a sentence about it, that goes on after its name
};

/// The recording that disagrees with the others most, if one does grossly: with `chosen` fitted again on the others alone, runs leave
/// far more of its motion at one joint (by NMSE: core::outlier) and far more than noise, though each of its joints was driven, and
/// moved, as in the others. Of at least five recordings.
std::optional<Disagreement> disagreeing(const TreeModel& model, const std::vector<Recording>& recordings,
                                        const Hypothesis& chosen, double window_s, std::size_t most_windows,
                                        unsigned threads);

}  // namespace furcula::trees
