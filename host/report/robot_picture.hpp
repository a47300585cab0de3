// The picture of a robot on the page of its diagnosis: joints, links, motions, and where the causes are.
#pragma once

#include <string>

#include "host/trees/diagnosis.hpp"

namespace furcula::report {

/// `html` is the section's content, `json` what robot_script draws in it. Both are empty for machines without a picture.
struct RobotPicture {
  std::string html, json;
};

/// Motions are thinned to some 80,000 numbers.
RobotPicture robot_picture(const trees::Diagnosis& diagnosis);

}  // namespace furcula::report
