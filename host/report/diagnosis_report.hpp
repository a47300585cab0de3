// The report of a diagnosis: one HTML file that needs nothing else, on a screen and on paper.
#pragma once

#include <string>

#include "host/report/robot_picture.hpp"
#include "host/result/diagnosis.hpp"

namespace furcula::report {

/// The same sections for machines of every family; those without content are absent. Below about 2 MB whatever the length of the logs:
/// traces and clouds are thinned, and the page says so. `command` is what makes the same page again, for its foot; empty: the foot does
/// not speak of it. `robot` is the picture of a robot.
std::string render_report(const result::Diagnosis& diagnosis, const std::string& command = "",
                          const RobotPicture& robot = {});

}  // namespace furcula::report
