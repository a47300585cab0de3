// The release/catch test as JSON (furcula-release-catch/1).
#pragma once

#include <string>

#include "host/bench/release_catch.hpp"

namespace furcula::bench {

/// SI units; null where there is no value.
std::string to_json_text(const ReleaseCatch& result);

}  // namespace furcula::bench
