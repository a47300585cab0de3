// A search as a command runs it: with the robustness of the walk that it found, and with its files.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/core/atomic_file.hpp"
#include "host/walk/walk_file.hpp"

namespace furcula::walk {

struct Searched {
  SearchResult found;
  std::optional<Robustness> robustness;  ///< where a walk was found
};

/// @throws core::DataError: limits that no posture keeps.
void require_posture(const Model& model, const RolloutOptions& rollout);

/// Searches a walk of the model, and simulates the one that was found again, with errors. `options.progress` is told of both.
Searched searched(const Model& model, const SearchOptions& options);

/// walk.json, report.html and, the last one, walk.toml in `folder`. `command` is for the page.
std::vector<core::NewFile> files_of(const Model& model, const SearchOptions& options,
                                    const Searched& searched, const std::string& folder,
                                    const std::string& command);

}  // namespace furcula::walk
