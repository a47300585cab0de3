// The page of `furcula walk loop`: prediction errors of each model on each trial, rounds, what changes over rounds.
#pragma once

#include <string>

#include "host/loop/loop.hpp"

namespace furcula::loop {

/// One HTML file that works offline, for `options.out`: its links are to files there. `robot`: its name. At least one round.
std::string render_loop_report(const std::string& robot, const LoopOptions& options,
                               const LoopResult& result);

/// Eq. 3 over whole walks, mrad: models below each other, trials side by side.
std::string whole_run_triangle_html(const LoopResult& result);

}  // namespace furcula::loop
