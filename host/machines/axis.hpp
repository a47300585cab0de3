// What the axes that a motor drives share.
#pragma once

#include "host/machines/rules.hpp"

namespace furcula::machines {

/// At rest at 0, driven with 1 N or 1 N m and 1 s.
Run usual_run_of_axis(const model::Model& model);

/// Driven harmonically, left alone (a rotary one swings, a linear one coasts), and for long.
void experiments_of_axis(ExperimentLibrary& experiment_library, const model::Model& model,
                         const Reach& reach);

}  // namespace furcula::machines
