// The page of `furcula walk identify`: errors of windows, the robot walking, and what the recordings tell of its numbers.
#pragma once

#include <string>
#include <vector>

#include "host/floating/identify.hpp"

namespace furcula::floating {

struct Identification {
  std::string robot;  ///< its name
  const Identified* found;
  const std::vector<Recording>*training, *held_out;
  const WindowErrors *held_out_before, *held_out_after;  ///< null where no recording is held out
  double window_s;
  std::string command;  ///< that writes the page again
};

/// One HTML file that works offline.
std::string render_identification_report(const Identification& of);

}  // namespace furcula::floating
