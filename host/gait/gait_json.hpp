// `furcula-gait/1`: what a search for a gait found (docs/gaits.md).
#pragma once

#include <string>

#include "host/gait/evidence.hpp"

namespace furcula::gait {

/// Of a search that found a gait.
std::string to_json_text(const Search& search, const Evidence& evidence);

}  // namespace furcula::gait
