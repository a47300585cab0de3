// Which set of causes is the most likely one under what disturbs the machine.
#pragma once

#include <optional>

#include "host/diagnose/selection.hpp"

namespace furcula::diagnose {

/// From `first` on, by moves that add a cause, take one out, or put one in another's place. A random force makes the residuals of a free run grow along
/// its window; what a Kalman filter finds new in them from row to row (identify::Whitening) does not, and by that all is fitted, proposed and weighed.
/// @returns values and intervals of these fits, with the squares that free runs leave at them; nothing where free runs leave the sensors' noise alone, or
/// the windows cannot be linearised (encoder slips, a clutch bench, joints that stand still), or there are fewer than three recordings.
std::optional<Selection> select_by_likelihood(const model::Model& model,
                                              const std::vector<identify::Recording>& recordings,
                                              const identify::TrainingWindows& training, unsigned threads,
                                              const Progress& progress, const Selection& first);

}  // namespace furcula::diagnose
