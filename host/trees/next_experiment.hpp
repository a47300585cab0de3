// Which motion would tell causes apart that the recordings cannot: paths of one joint or of all, within the URDF's limits.
#pragma once

#include <vector>

#include "host/trees/diagnosis.hpp"
#include "host/trees/recording.hpp"

namespace furcula::trees {

/// Each path is given the inputs with which `named` follows it, and the others are run on these, in windows like those of a
/// diagnosis; the most telling first, at most `most`. What breaks a limit of speed or effort is left out.
std::vector<Experiment> next_experiments(const TreeModel& model, const std::vector<Recording>& recordings,
                                         const Hypothesis& named, const std::vector<Hypothesis>& others,
                                         double window_s, std::size_t most = 5);

/// As a scenario for `furcula sim`.
std::string scenario_of(const TreeModel& model, const Experiment& experiment);

}  // namespace furcula::trees
