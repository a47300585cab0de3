#include "host/report/line_plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "host/report/html.hpp"

namespace furcula::report {
namespace {

constexpr double kWidth = 640, kHeight = 260, kLeft = 64, kRight = 20, kTop = 12, kBottom = 34;
constexpr const char* kColours[] = {"#b45309", "#047857", "#1d4ed8", "#a21caf",
                                    "#0e7490", "#b91c1c", "#4d7c0f", "#475569"};

/// Round numbers, some four of them, that lie within [low, high].
std::vector<double> ticks(double low, double high, double least_step = 0.0) {
  const double rough = (high - low) / 4.0, decade = std::pow(10.0, std::floor(std::log10(rough)));
  double step = decade;
  for (const double factor : {2.0, 5.0, 10.0})
    if (step < 0.8 * rough) step = factor * decade;
  step = std::max(step, least_step);
  std::vector<double> out;
  for (double k = std::ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1.0)
    out.push_back(k == 0.0 ? 0.0 : k * step);
  return out;
}

/// Without needless zeros.
std::string tick(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  void take(double v) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  void widen() {
    if (high > low) return;
    const double by = high != 0.0 ? 0.1 * std::abs(high) : 1.0;
    low -= by;
    high += by;
  }
};

}  // namespace

std::string line_plot_html(const LinePlot& plot) {
  Range across, upright;
  std::size_t points = 0;
  for (const Line& l : plot.lines)
    for (std::size_t i = 0; i < std::min(l.x.size(), l.y.size()); ++i)
      if (std::isfinite(l.x[i]) && std::isfinite(l.y[i])) {
        across.take(l.x[i]);
        upright.take(l.y[i]);
        ++points;
      }
  if (points < 2) return "";
  if (plot.from_zero) upright.take(0.0);
  across.widen();
  upright.widen();
  const auto x = [&](double v) {
    return kLeft + (kWidth - kLeft - kRight) * (v - across.low) / (across.high - across.low);
  };
  const auto y = [&](double v) {
    return kHeight - kBottom - (kHeight - kTop - kBottom) * (v - upright.low) / (upright.high - upright.low);
  };
  std::string out = "<figure><svg viewBox=\"0 0 640 260\" width=\"640\" role=\"img\" aria-label=\"" +
                    escape(plot.title) + "\" style=\"max-width:100%\">\n";
  for (const double v : ticks(upright.low, upright.high)) {
    const std::string at = number(y(v), 5);
    out += "<line x1=\"64\" x2=\"620\" y1=\"" + at + "\" y2=\"" + at +
           "\" stroke=\"currentColor\" opacity=\"0.15\"/><text x=\"58\" y=\"" + at +
           "\" text-anchor=\"end\" dominant-baseline=\"middle\" font-size=\"12\" fill=\"currentColor\">" +
           tick(v) + "</text>\n";
  }
  for (const double v : ticks(across.low, across.high, plot.counts ? 1.0 : 0.0))
    out += "<text x=\"" + number(x(v), 5) +
           "\" y=\"246\" text-anchor=\"middle\" font-size=\"12\" fill=\"currentColor\">" + tick(v) +
           "</text>\n";
  const auto dot = [](const std::string& px, const std::string& py, const std::string& colour) {
    return "<circle cx=\"" + px + "\" cy=\"" + py + "\" r=\"3\" fill=\"" + colour + "\" opacity=\"0.6\"/>";
  };
  std::string legend;
  for (std::size_t k = 0; k < plot.lines.size(); ++k) {
    const Line& l = plot.lines[k];
    const std::string colour = kColours[k % std::size(kColours)];
    if (!l.label.empty())
      legend += (legend.empty() ? " " : ", ") + ("<span style=\"color:" + colour + "\">") + escape(l.label) +
                "</span>";
    std::string stroke, first;
    for (std::size_t i = 0; i < std::min(l.x.size(), l.y.size()); ++i) {
      if (!std::isfinite(l.x[i]) || !std::isfinite(l.y[i])) continue;
      const std::string px = number(x(l.x[i]), 5), py = number(y(l.y[i]), 5);
      if (l.dots)
        out += dot(px, py, colour);
      else if (stroke.empty())
        first = dot(px, py, colour), stroke = px + "," + py + " ";
      else
        stroke += px + "," + py + " ", first.clear();
    }
    out += first;  // of a line of one point
    if (!stroke.empty() && first.empty())
      out += "<polyline fill=\"none\" stroke-width=\"2\" stroke=\"" + colour + "\" points=\"" + stroke +
             "\"/>\n";
  }
  return out + "</svg><figcaption>" + escape(plot.title) + ", over " + escape(plot.over) + "." + legend +
         (legend.empty() ? "" : ".") + "</figcaption></figure>\n";
}

}  // namespace furcula::report
