// What `furcula excite` writes: set points, scenarios, `excitation.json`.
#pragma once

#include <string>
#include <vector>

#include "host/core/atomic_file.hpp"
#include "host/excite/check.hpp"
#include "host/excite/design.hpp"

namespace furcula::excite {

/// All that one call found. Without designed recordings `design.scenarios` is empty.
struct Result {
  trees::TreeModel model;
  std::vector<JointLimits> limits;
  Options options;
  Design design;
  Check check;
  std::vector<std::string> logs;  ///< that were checked
};

/// time_s, then of each joint where it should be and how fast, as a controller that follows it wants them.
std::string setpoints_csv(const trees::TreeModel& model, const trees::Scenario& scenario);

/// `furcula-excitation/1`.
std::string to_json_text(const Result& result);

/// setpoints_1.csv, scenario_1.toml, ..., excitation.json in the folder.
std::vector<core::NewFile> files(const Result& result, const std::string& folder);

/// For a terminal: limits and what motions use of them, intervals, what cannot be told apart.
std::string summary(const Result& result);

}  // namespace furcula::excite
