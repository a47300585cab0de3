// Which motion would tell causes apart that the recordings cannot: paths of one joint or of all, within the URDF's limits.
#pragma once

#include <string>
#include <vector>

#include "host/trees/diagnosis.hpp"
#include "host/trees/recording.hpp"

namespace furcula::trees {

/// Each path is given the inputs with which `named` follows it, and the others are run on these, in windows like those of a
/// diagnosis; the most telling first, at most `most`. What breaks a limit of speed or effort is left out.
std::vector<Experiment> next_experiments(const TreeModel& model, const std::vector<Recording>& recordings,
                                         const Hypothesis& named, const std::vector<Hypothesis>& others,
                                         double window_s, std::size_t most = 5);

/// Of a robot on a foot whose recordings all hop in place, or all run: that the other is worth a recording, and what it shows.
/// Empty where there are both, or no undriven joint goes along the ground.
std::string other_way_of_moving(const TreeModel& model, const std::vector<Recording>& recordings);

/// As a scenario for `furcula sim`.
std::string scenario_of(const TreeModel& model, const Experiment& experiment);

}  // namespace furcula::trees
