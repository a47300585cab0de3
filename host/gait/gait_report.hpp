// The page of a gait: its figures, the leg that moves, curves over the stride.
#pragma once

#include <string>
#include <vector>

#include "host/gait/evidence.hpp"

namespace furcula::gait {

/// Of a search that found a gait; `command` writes the same page again.
std::string render_gait_report(const Search& search, const Evidence& evidence, const std::string& command);

/// What the page's script draws: strides of one robot.
struct NamedStride {
  std::string name;
  std::vector<Moment> moments;
};
std::string leg_data(const Machine& machine, const std::vector<NamedStride>& strides);
/// The canvas and its controls.
std::string leg_html();

}  // namespace furcula::gait
