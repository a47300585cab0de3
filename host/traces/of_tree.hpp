// Traces of a robot of several joints.
#pragma once

#include <string>
#include <vector>

#include "host/log/log.hpp"
#include "host/traces/traces.hpp"
#include "host/trees/hypothesis.hpp"
#include "host/trees/model.hpp"

namespace furcula::traces {

struct TreeHypothesis {
  std::string name;  ///< "given", "refitted", "extended", "predicted"
  trees::Hypothesis of;
};

/// The angle (position) of each joint over windows of `window_s`.
/// @throws core::DataError what recording_of throws.
Traces of_tree(const trees::TreeModel& model, const std::vector<TreeHypothesis>& hypotheses,
               const std::vector<log::Log>& training, const std::vector<log::Log>& held_out, double window_s);

}  // namespace furcula::traces
