// The files of a walk: the model (TOML of kind biped, which names a URDF), walk.toml (walk_toml.hpp), and walk.json.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/biped/machine.hpp"
#include "host/walk/robustness.hpp"
#include "host/walk/search.hpp"
#include "host/walk/walk_toml.hpp"

namespace furcula::walk {

struct Model {
  std::string file, name;                   ///< of the model file; of the robot, as its URDF says
  std::string urdf;                         ///< as the model file names it
  dynamics::biped::Description robot;       ///< with the deviations that a walk is simulated with
  furcula::biped::Machine machine;          ///< and what else the model file says of it
  dynamics::biped::Description undeviated;  ///< as its URDF and the design have it
  WalkLimits limits;
};

/// A limit as a key of [limits], and what it may be.
struct LimitKey {
  std::string_view name, unit;
  double WalkLimits::*of;
  double least, most;
};
inline constexpr std::array<LimitKey, 7> kLimitKeys{
    {{"torque_nm", "N m", &WalkLimits::torque_nm, 1.0, 1e4},
     {"speed_radps", "rad/s", &WalkLimits::speed_radps, 0.1, 100.0},
     {"moment_nm", "N m", &WalkLimits::moment_nm, 1.0, 1e4},
     {"height_m", "m", &WalkLimits::height_m, 0.1, 2.0},
     {"range_rad", "rad", &WalkLimits::range_rad, 0.1, 3.1},
     {"apart_m", "m", &WalkLimits::apart_m, 0.0, 1.0},
     {"along_m", "m", &WalkLimits::along_m, 0.0, 1.0}}};

/// A model file of kind biped (docs/biped.md). @throws core::DataError, and what biped::read_biped throws.
Model read_model(const std::string& path);

/// The text of a model file in `folder` of the same robot and limits, with the deviations that `machine` has.
std::string format_model(const Model& model, const furcula::biped::Machine& machine,
                         const std::string& folder);

/// Of a walk of this model, all else as RolloutOptions has it. The controller is a board's, which knows the robot without deviations.
RolloutOptions rollout_of(const Model& model, WalkMode mode, double walk_until_s);

/// What a board gets of a walk that was found so.
inline Walk walk_of(const Model& model, const RolloutOptions& options, const Parameters& found) {
  return {model.name, options.mode, options.walk_until_s, found,
          std::min(options.command_delay_s, kMostCommandDelay_s)};
}

/// Robots about the model that no search has seen, for robustness_of.
std::vector<Member> unseen_robots(const Model& model, WalkMode mode);

/// What of the limits is not kept, in words.
std::vector<std::string> broken_limits(const Rollout& rollout, const WalkLimits& limits);

/// walk.json, `furcula-walk/1` (docs/contracts.md).
std::string to_json_text(const SearchResult& found, const std::optional<Robustness>& robustness,
                         const SearchOptions& options, const Model& model);

}  // namespace furcula::walk
