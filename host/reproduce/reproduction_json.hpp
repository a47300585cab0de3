// A reproduction as JSON, `furcula-reproduction/1`.
#pragma once

#include <string>

#include "host/reproduce/reproduction.hpp"

namespace furcula::reproduce {

/// Without times: the same for any number of threads. Numbers that are not finite are null.
std::string to_json_text(const Reproduction& r);

}  // namespace furcula::reproduce
