// The report of a diagnosis: one HTML file that needs nothing else, on a screen and on paper.
#pragma once

#include <string>

#include "host/diagnose/diagnosis.hpp"

namespace furcula::report {

/// Below about 2 MB whatever the length of the logs: traces and clouds are thinned, and the page says so.
std::string render_report(const diagnose::Diagnosis& diagnosis);

}  // namespace furcula::report
