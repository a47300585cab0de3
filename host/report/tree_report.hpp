// The report of a diagnosis of a robot of several joints: one HTML file that needs nothing else.
#pragma once

#include <string>

#include "host/trees/diagnosis.hpp"

namespace furcula::report {

/// Traces, clouds and motions are thinned, and the page says so. `command` is what makes the same page again, for its foot;
/// empty: the foot does not speak of it.
std::string render_tree_report(const trees::Diagnosis& diagnosis, const std::string& command = "");

}  // namespace furcula::report
