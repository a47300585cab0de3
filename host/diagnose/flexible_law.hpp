// A flexible law of the state, learned from what a model leaves of training recordings: how much of the rest it predicts.
#pragma once

#include <vector>

#include "host/diagnose/disturbance.hpp"
#include "host/diagnose/linear_runs.hpp"
#include "host/diagnose/predictable.hpp"
#include "host/diagnose/whiteness.hpp"

namespace furcula::diagnose {

struct PredictedByLaw {
  Predictable crossed;      ///< on each training recording (or stretch), by what the others teach
  Predictable predictable;  ///< on the held-out runs, by what all training runs teach
  Whiteness new_finds;      ///< of what the filter finds new from row to row on the held-out runs
};

/// The law is fitted to what the filter of `disturbance` finds new from row to row of the training runs (four at least). `driven`: the machine
/// has an input; `leg`: it has touch-downs. Without held-out runs what is said of those stays zero.
PredictedByLaw predict_by_flexible_law(const std::vector<LinearRun>& training,
                                       const std::vector<LinearRun>& held_out, const Disturbance& disturbance,
                                       bool driven, bool leg, double typical_force);

}  // namespace furcula::diagnose
