// Of more windows than a fit needs, those that tell most: so that a long recording takes no longer than a short one.
#pragma once

#include <vector>

#include "host/identify/recording.hpp"
#include "host/identify/windows.hpp"

namespace furcula::identify {

/// As many rows as a search for causes is made on. More of the same tells it little: values are then known to a part of a percent, and what
/// limits a diagnosis is what the machine does not repeat. At least kFewestChosen windows whatever their length.
inline constexpr std::size_t kMostRowsOfFit = 48'000;
inline constexpr std::size_t kFewestChosen = 24;

/// The windows themselves where they hold no more than `most_rows` rows. Else so many of them:
/// - half lie evenly over all recordings, each of which has one at least while there is room;
/// - a sixth are those that the model, re-fitted on these, predicts worst: what happens seldom stands out there;
/// - the others add most to what is known of forces that hang on speed, place, direction, input, acceleration and time (a greedy D-optimal
///   choice): the ends of the travel, the largest inputs, turning points.
/// They stand in the order of `all`, which has one layer then.
TrainingWindows informative_windows(const std::vector<Recording>& recordings, const model::Model& model,
                                    TrainingWindows all, std::size_t most_rows = kMostRowsOfFit);

/// Of so many windows some that lie evenly, with at most so many rows, but `fewest` at least. For what wants no more than a sample.
std::vector<Window> evenly(const std::vector<Window>& windows, std::size_t most_rows, std::size_t fewest);

}  // namespace furcula::identify
