// `furcula walk`, with a search on other processes.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "host/walk/search.hpp"

namespace furcula::cli {

/// Has a search's generations run elsewhere (SearchOptions::run).
using Distribute = std::function<void(const dynamics::biped::Description&, walk::SearchOptions&)>;
/// The command `walk`. Without --threads a search that is distributed has one thread a process.
CLI::App* add_walk_command(CLI::App& app, Distribute distribute);

}  // namespace furcula::cli
