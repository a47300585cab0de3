// A small picture of lines or dots over a common axis, drawn as SVG without a script.
#pragma once

#include <string>
#include <vector>

namespace furcula::report {

struct Line {
  std::string label;
  std::vector<double> x, y;  ///< of the same length; points that are not finite are left out
  bool dots = false;
};

struct LinePlot {
  std::string title;        ///< what is drawn, with its unit
  std::string over;         ///< what the axis below is, with its unit
  std::vector<Line> lines;  ///< at most six are told apart by their colours
  bool from_zero = false;   ///< the upright axis begins at zero
  bool counts = false;      ///< the axis below has whole numbers
};

/// A <figure> with its caption and legend; nothing where no two points are there to draw.
std::string line_plot_html(const LinePlot& plot);

}  // namespace furcula::report
