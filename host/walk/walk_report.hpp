// The page of a walk: the robot walking, what it costs, its margins to the limits, what it stands, and the search.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "host/walk/robustness.hpp"
#include "host/walk/search.hpp"
#include "host/walk/walk_file.hpp"

namespace furcula::walk {

std::string mode_in_words(WalkMode mode);
/// Energy by motor, left then right, and of all of them: a table.
std::string motors_html(const std::array<JointEnergy, dynamics::biped::kJoints>& joints, const Rollout& all);

/// One HTML file that works offline. `history` is the search's, empty where there was none; `command` writes the page again.
std::string render_walk_report(const Model& model, const RolloutOptions& options, const Parameters& walk,
                               const Rollout& rollout, const std::vector<SearchPoint>& history,
                               const std::optional<Robustness>& robustness, const std::string& command);

}  // namespace furcula::walk
