// The report of a diagnosis: one HTML file that needs nothing else, on a screen and on paper.
#pragma once

#include <string>

#include "host/diagnose/diagnosis.hpp"

namespace furcula::report {

/// Below about 2 MB whatever the length of the logs: traces and clouds are thinned, and the page says so.
/// `command` is what makes the same page again, for its foot; empty: the foot does not speak of it.
std::string render_report(const diagnose::Diagnosis& diagnosis, const std::string& command = "");

}  // namespace furcula::report
