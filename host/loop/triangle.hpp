// Prediction errors of each model of a loop on each trial: document 000, Figs. 7 and 8.
#pragma once

#include <map>
#include <tuple>

#include "host/floating/identify.hpp"

namespace furcula::loop {

constexpr int kGiven = -1;  ///< of Cell::model

/// A model on a trial.
struct Cell {
  int model =
      kGiven;  ///< kGiven: as given; n: identified after round n, 0: from the exercise before the first walk
  unsigned round = 1, repetition = 1;
  /// Whether the model was identified from the trial.
  bool training() const { return static_cast<int>(round) <= model; }
  bool operator<(const Cell& o) const {
    return std::tie(model, round, repetition) < std::tie(o.model, o.round, o.repetition);
  }
};

struct CellErrors {
  floating::WindowErrors windows;  ///< `predicted` is empty
  double whole_run_rad =
      0.0;  ///< Eq. 3 over the whole walk, the robot simulated with its controller (whole_run.hpp)
};

/// The model as given on all trials, every other one on those of its fit and of the round after it.
using Triangle = std::map<Cell, CellErrors>;

/// Root mean square over joint angles and attitude together: document 000, Eq. 3, over windows. The targets' term is left out: the logged
/// targets drive the simulation.
double model_error_rad(const floating::WindowErrors& errors);

}  // namespace furcula::loop
