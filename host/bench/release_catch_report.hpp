// The release/catch test as one page that works offline.
#pragma once

#include <string>

#include "host/bench/release_catch.hpp"

namespace furcula::bench {

/// `command` writes the same page again.
std::string render_release_catch_report(const ReleaseCatch& result, double metres_per_count,
                                        const std::string& command);

}  // namespace furcula::bench
