// gait.json, `furcula-walk-gait/1`: a gait by gradients in figures.
#pragma once

#include <string>

#include "host/walk/gait_walk.hpp"
#include "host/walk/walk_file.hpp"

namespace furcula::walk {

/// `walk` and what it did, where a gait was found.
std::string to_json_text(const GaitResult& found, const GaitTask& task, const Model& model,
                         const GaitWalk* walk, const Rollout* rollout);

/// Where no gait was found: what stands against it, in words.
std::string against_gait(const GaitResult& found, const GaitTask& task);

}  // namespace furcula::walk
