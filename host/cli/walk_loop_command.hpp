// `furcula walk loop`.
#pragma once

#include <CLI/CLI.hpp>

namespace furcula::cli {

/// Under `furcula walk`.
void add_walk_loop_command(CLI::App& walk);

}  // namespace furcula::cli
