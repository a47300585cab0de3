// `furcula walk identify`.
#pragma once

#include <CLI/CLI.hpp>

namespace furcula::cli {

/// Under `furcula walk`.
void add_walk_identify_command(CLI::App& walk);

}  // namespace furcula::cli
