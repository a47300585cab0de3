// The report of an identification: one HTML file that needs nothing else, on a screen and on paper.
#pragma once

#include <string>

#include "host/identify/identification.hpp"

namespace furcula::report {

/// `command` as for a diagnosis.
std::string render_identification_report(const identify::Identification& identification,
                                         const std::string& command = "");

}  // namespace furcula::report
