// `furcula-gait/1`: what a search for a gait found (docs/contracts.md).
#pragma once

#include <string>

#include "host/gait/search.hpp"

namespace furcula::gait {

/// Of a search that found a gait.
std::string to_json_text(const Search& search);

}  // namespace furcula::gait
