// The energy study as JSON (furcula-energy/1).
#pragma once

#include <string>

#include "host/energy/study.hpp"

namespace furcula::energy {

/// SI units; null where there is no value.
std::string to_json_text(const Study& study);

}  // namespace furcula::energy
