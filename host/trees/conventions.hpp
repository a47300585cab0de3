// A tree's columns for the trial of conventions (host/conventions/trial.hpp).
#pragma once

#include <optional>
#include <vector>

#include "host/conventions/joint_search.hpp"
#include "host/conventions/trial.hpp"
#include "host/trees/recording.hpp"

namespace furcula::trees {

/// @throws core::DataError that says what the columns of these recordings seem to be, where that is not what their names say: another
/// unit, sign or zero, columns that are exchanged, gravity along another axis of the base. Of a robot with a foot, rows in flight count.
/// Where no window of `window_s` is free of gaps, time alone is asked about: nothing else would make one.
void require_conventions(const TreeModel& model, const std::vector<Recording>& recordings, double window_s);

/// What require_conventions() would say, as a finding; and how well the columns fit as they are named.
std::optional<conventions::Finding> find_convention(const TreeModel& model,
                                                    const std::vector<Recording>& recordings);
/// Signs and units of all joints at once.
std::optional<conventions::JointReadings> find_joint_readings(const TreeModel& model,
                                                              const std::vector<Recording>& recordings);
conventions::AsNamed as_named(const TreeModel& model, const std::vector<Recording>& recordings);

}  // namespace furcula::trees
