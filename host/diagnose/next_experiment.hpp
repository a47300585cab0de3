// Which experiment that the rig can do would tell the remaining candidates apart: each of a library of them
// is simulated with every candidate as the truth, and the others are fitted to what it would record.
#pragma once

#include <vector>

#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/selection.hpp"

namespace furcula::diagnose {

/// Experiments that a rig can do that has recorded these: with inputs, places and speeds as they hold.
std::vector<Experiment> library(const model::Model& model,
                                const std::vector<identify::Recording>& recordings);

/// The chosen set and of its rivals four at most, that are other laws than all before them.
std::vector<const Hypothesis*> to_be_told_apart(const model::Model& model, const Selection& selection);

/// The library's experiments that can be simulated, the most telling first, each evaluated for the candidates
/// (two or more, fitted to `recordings` over `training`). Deterministic.
std::vector<Experiment> experiments_that_tell(const model::Model& model,
                                              const std::vector<const Hypothesis*>& candidates,
                                              const std::vector<identify::Recording>& recordings,
                                              const identify::TrainingWindows& training, double window_s,
                                              unsigned threads);

}  // namespace furcula::diagnose
