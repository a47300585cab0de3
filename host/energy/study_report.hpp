// The energy study as one page that works offline.
#pragma once

#include <string>

#include "host/energy/study.hpp"

namespace furcula::energy {

/// `command` writes the same page again.
std::string render_energy_report(const Study& study, const std::string& command);

}  // namespace furcula::energy
