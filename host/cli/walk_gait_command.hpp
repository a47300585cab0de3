// `furcula walk gait`.
#pragma once

#include <CLI/CLI.hpp>

namespace furcula::cli {

/// Under `furcula walk`.
void add_walk_gait_command(CLI::App& walk);

}  // namespace furcula::cli
