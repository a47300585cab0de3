// Rows that runs of a fitted model refute: what their neighbours alone could not tell.
#pragma once

#include <functional>
#include <vector>

#include "host/identify/windows.hpp"
#include "host/log/clean.hpp"

namespace furcula::identify {

/// Of each recording the rows (of its log) whose positions step out of what a free run of the model leaves, and
/// back. The model's own errors are as slow as the machine; a row, or the first one of a window, is not. None
/// of a belt that teeth catch, where a run that is a tooth off leaves as much; and none of a recording of
/// which they would be more than log::kMostRefused.
std::vector<std::vector<log::Refuted>> refuted_rows(const model::Model& fitted,
                                                    const std::vector<Recording>& recordings,
                                                    const std::vector<Window>& windows);

/// Adds what was found to what was refused before. False where nothing was found.
bool add_refuted(std::vector<std::vector<log::Refuted>>& all,
                 const std::vector<std::vector<log::Refuted>>& more);

}  // namespace furcula::identify
