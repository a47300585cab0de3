// A reproduction as one HTML page.
#pragma once

#include <string>

#include "host/reproduce/reproduction.hpp"

namespace furcula::reproduce {

/// `command` writes the page again.
std::string render_reproduction_report(const Reproduction& r, const std::string& command);

}  // namespace furcula::reproduce
