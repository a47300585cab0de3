// Scatter plots of the residual force, as inline SVG.
#include "host/report/force_plot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <optional>
#include <vector>

#include "host/report/html.hpp"

namespace furcula::report {
namespace {

constexpr double kWidth = 460.0, kHeight = 300.0;
constexpr double kLeft = 62.0, kRight = 16.0, kTop = 8.0, kBottom = 52.0;

/// Over velocity a law may jump at zero, so it is drawn finely. Over position it is two-valued, and over time
/// it swings with every stroke: there law and samples are averaged alike, over time widely, to show what
/// drifts.
struct Bins {
  double mean, law;
};
constexpr Bins kOverVelocity{40.0, 120.0}, kOverPosition{40.0, 40.0}, kOverTime{12.0, 12.0};

struct Interval {
  double low, high;
  double width() const { return high - low; }
  bool holds(double v) const { return v >= low && v <= high; }
};

/// Maps values to the plot's area.
struct Axes {
  Interval x, y;
  double px(double v) const { return kLeft + (v - x.low) / x.width() * (kWidth - kLeft - kRight); }
  double py(double v) const {
    return kHeight - kBottom - (v - y.low) / y.width() * (kHeight - kTop - kBottom);
  }
};

std::string format(const char* pattern, double a, double b) {
  char text[96];
  std::snprintf(text, sizeof text, pattern, a, b);
  return text;
}

std::string point(char command, const Axes& axes, double x, double y) {
  return command + format("%.1f %.1f", axes.px(x), axes.py(std::clamp(y, axes.y.low, axes.y.high)));
}

Interval not_empty(double low, double high, double margin) {
  if (!(high > low)) {
    const double around = std::max(1e-6, 0.05 * std::abs(low));
    return {low - around, high + around};
  }
  return {low - margin * (high - low), high + margin * (high - low)};
}

double quantile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// A round step, 1, 2 or 5 times a power of ten, that makes about `count` ticks.
double tick_step(double width, double count) {
  const double raw = width / count, power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double m : {1.0, 2.0, 5.0})
    if (raw <= m * power) return m * power;
  return 10.0 * power;
}

std::string tick_label(double value, double step) {
  char text[32];
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  std::snprintf(text, sizeof text, "%.*f", decimals, std::abs(value) < 1e-9 * step ? 0.0 : value);
  return text;
}

std::string frame(const Axes& axes, const std::string& x_title, const std::string& y_title) {
  std::string grid, labels;
  const double x_step = tick_step(axes.x.width(), 6.0), y_step = tick_step(axes.y.width(), 6.5);
  for (double v = std::ceil(axes.x.low / x_step) * x_step; v <= axes.x.high; v += x_step) {
    grid += format("M%.1f %.1f", axes.px(v), kTop) + format("V%.1f", kHeight - kBottom, 0.0);
    labels += "<text text-anchor=\"middle\" " +
              format("x=\"%.1f\" y=\"%.1f\">", axes.px(v), kHeight - kBottom + 19) + tick_label(v, x_step) +
              "</text>";
  }
  for (double v = std::ceil(axes.y.low / y_step) * y_step; v <= axes.y.high; v += y_step) {
    grid += format("M%.1f %.1f", kLeft, axes.py(v)) + format("H%.1f", kWidth - kRight, 0.0);
    labels += "<text text-anchor=\"end\" " + format("x=\"%.1f\" y=\"%.1f\">", kLeft - 6, axes.py(v) + 5) +
              tick_label(v, y_step) + "</text>";
  }
  std::string out = "<path class=\"grid\" d=\"" + grid + "\"/>";
  if (axes.y.holds(0.0))
    out += "<path class=\"zero\" d=\"" + format("M%.1f %.1f", kLeft, axes.py(0.0)) +
           format("H%.1f", kWidth - kRight, 0.0) + "\"/>";
  out += labels;
  out += "<text class=\"title\" text-anchor=\"middle\" " +
         format("x=\"%.1f\" y=\"%.1f\">", 0.5 * (kLeft + kWidth - kRight), kHeight - 9) + escape(x_title) +
         "</text>";
  out += "<text class=\"title\" text-anchor=\"middle\" transform=\"" +
         format("translate(15 %.1f) rotate(%.0f)\">", 0.5 * (kTop + kHeight - kBottom), -90.0) +
         escape(y_title) + "</text>";
  return out;
}

struct Bin {
  double sum = 0.0, squares = 0.0, count = 0.0;
  double mean() const { return sum / count; }
  double deviation() const { return std::sqrt(std::max(0.0, squares / count - mean() * mean())); }
};

/// Bins of one width whose edges are multiples of it, so that a law that jumps at zero is not smeared.
std::map<long, Bin> binned(const std::vector<double>& x, const std::vector<double>& y, double width) {
  std::map<long, Bin> out;
  for (std::size_t i = 0; i < x.size(); ++i) {
    Bin& b = out[static_cast<long>(std::floor(x[i] / width))];
    b.sum += y[i];
    b.squares += y[i] * y[i];
    b.count += 1.0;
  }
  return out;
}

/// The bins' means with one standard deviation to both sides. A gap in the data is a gap in the band.
std::string mean_and_band(const Axes& axes, const std::map<long, Bin>& bins, double width) {
  constexpr double kFewest = 5.0;
  std::string bands, line;
  std::vector<std::pair<double, Bin>> run;
  const auto finish = [&] {
    for (std::size_t i = 0; i < run.size(); ++i) {
      const auto& [x, b] = run[i];
      line += point(i ? 'L' : 'M', axes, x, b.mean());
      bands += point(i ? 'L' : 'M', axes, x, b.mean() + b.deviation());
    }
    for (auto it = run.rbegin(); it != run.rend(); ++it)
      bands += point('L', axes, it->first, it->second.mean() - it->second.deviation());
    if (!run.empty()) bands += 'Z';
    run.clear();
  };
  std::optional<long> before;
  for (const auto& [k, b] : bins) {
    if (b.count < kFewest) continue;
    // The two sides of zero are apart: friction jumps there.
    if (before && (k > *before + 2 || k == 0)) finish();
    run.emplace_back((static_cast<double>(k) + 0.5) * width, b);
    before = k;
  }
  finish();
  return "<path class=\"band\" d=\"" + bands + "\"/><path class=\"mean\" d=\"" + line + "\"/>";
}

std::string law_line(const Axes& axes, const std::map<long, Bin>& bins, double width) {
  std::string line;
  std::optional<long> before;
  double value_before = 0.0;
  for (const auto& [k, b] : bins) {
    const double x = (static_cast<double>(k) + 0.5) * width;
    if (before && k == 0 && *before >= -2)
      line += point('L', axes, 0.0, value_before) + point('L', axes, 0.0, b.mean());
    line += point(before && k <= *before + 4 ? 'L' : 'M', axes, x, b.mean());
    before = k;
    value_before = b.mean();
  }
  return "<path class=\"law\" d=\"" + line + "\"/>";
}

struct Samples {
  std::vector<double> time_s, velocity, position, force, law;
};

/// Only instants where everything is finite; columns of another length are left empty.
Samples usable(const result::ResidualForce& r) {
  Samples out;
  const std::size_t n = r.force.size();
  const std::vector<const std::vector<double>*> from{&r.time_s, &r.velocity, &r.position, &r.force, &r.law};
  const std::vector<std::vector<double>*> to{&out.time_s, &out.velocity, &out.position, &out.force, &out.law};
  for (std::size_t i = 0; i < n; ++i) {
    bool finite = true;
    for (const auto* column : from) finite = finite && (column->size() != n || std::isfinite((*column)[i]));
    if (!finite) continue;
    for (std::size_t c = 0; c < from.size(); ++c)
      if (from[c]->size() == n) to[c]->push_back((*from[c])[i]);
  }
  return out;
}

/// One path for the whole cloud: each point a stroke of no length with a round end. The step is
/// incommensurate with any period in the data.
std::string cloud_of(const Axes& axes, const std::vector<double>& x, const std::vector<double>& y,
                     std::size_t most_points) {
  std::string cloud;
  const double step = std::max(1.0, static_cast<double>(x.size()) / static_cast<double>(most_points));
  for (double at = 0.0; at < static_cast<double>(x.size()); at += step) {
    const auto i = static_cast<std::size_t>(at);
    if (!axes.y.holds(y[i])) continue;
    cloud += format("M%.1f %.1fh0", axes.px(x[i]), axes.py(y[i]));
  }
  return cloud;
}

std::string panel(const Samples& s, const std::vector<double>& x, Interval y, const std::string& x_title,
                  const std::string& y_title, Bins bins, std::size_t most_points) {
  if (x.empty()) return "";
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  const Axes axes{not_empty(*low, *high, 0.02), y};
  std::string out = "<svg viewBox=\"0 0 460 300\" role=\"img\" aria-label=\"" +
                    escape(y_title + " over " + x_title) + "\">" + frame(axes, x_title, y_title) +
                    "<path class=\"cloud\" d=\"" + cloud_of(axes, x, s.force, most_points) + "\"/>";
  const double mean_width = axes.x.width() / bins.mean, law_width = axes.x.width() / bins.law;
  out += mean_and_band(axes, binned(x, s.force, mean_width), mean_width);
  if (!s.law.empty()) out += law_line(axes, binned(x, s.law, law_width), law_width);
  return out + "</svg>\n";
}

std::string in_unit(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " (" + unit + ")";
}

}  // namespace

std::string force_plots(const result::ResidualForce& residual, std::size_t most_points) {
  const Samples s = usable(residual);
  if (s.force.empty()) return "";

  // A few wild samples (an impact, a start of a window) must not squeeze all others into a line.
  double low = quantile(s.force, 0.005), high = quantile(s.force, 0.995);
  for (const double v : s.law) {
    low = std::min(low, v);
    high = std::max(high, v);
  }
  const Interval y = not_empty(low, high, 0.08);
  const auto outside = std::count_if(s.force.begin(), s.force.end(), [&y](double f) { return !y.holds(f); });

  const bool torque = residual.unit == "N m";
  const std::string y_title = in_unit(torque ? "missing torque" : "missing force", residual.unit);
  std::string out =
      "<div class=\"legend\"><span class=\"key dot\">samples</span>"
      "<span class=\"key mean-key\">mean, with one standard deviation to both sides</span>";
  if (!s.law.empty()) out += "<span class=\"key law-key\">what the named causes add</span>";
  out += "</div>\n<div class=\"panels\">\n";
  out += panel(s, s.velocity, y, in_unit("velocity", residual.velocity_unit), y_title, kOverVelocity,
               most_points);
  out += panel(s, s.position, y, in_unit("position", residual.position_unit), y_title, kOverPosition,
               most_points);
  out += panel(s, s.time_s, y, "time since the recording's start (s)", y_title, kOverTime, most_points);
  out += "</div>\n";
  std::string note;
  if (s.force.size() > most_points)
    note += "Of " + std::to_string(s.force.size()) + " samples about " + std::to_string(most_points) +
            " are drawn; means and bands are of all. ";
  if (outside > 0) note += std::to_string(outside) + " samples lie above or below the plots. ";
  if (!s.law.empty())
    note +=
        "Where free parameters have stood in for the cause, the samples lie off the line by what these took up.";
  if (!note.empty()) out += "<p class=\"hint\">" + note + "</p>\n";
  return out;
}

namespace {

std::string two_clouds(const std::vector<double>& x, const std::vector<double>& before,
                       const std::vector<double>& after, Interval y, const std::string& x_title,
                       const std::string& y_title, double bins, std::size_t most_points) {
  const auto [low, high] = std::minmax_element(x.begin(), x.end());
  const Axes axes{not_empty(*low, *high, 0.02), y};
  const double width = axes.x.width() / bins;
  std::string out = "<svg viewBox=\"0 0 460 300\" role=\"img\" aria-label=\"" +
                    escape(y_title + " over " + x_title) + "\">" + frame(axes, x_title, y_title);
  out += "<path class=\"cloud before\" d=\"" + cloud_of(axes, x, before, most_points) + "\"/>";
  out += "<path class=\"cloud after\" d=\"" + cloud_of(axes, x, after, most_points) + "\"/>";
  out += "<g class=\"before\">" + mean_and_band(axes, binned(x, before, width), width) + "</g>";
  out += "<g class=\"after\">" + mean_and_band(axes, binned(x, after, width), width) + "</g>";
  return out + "</svg>\n";
}

}  // namespace

std::string missing_force_plots(const MissingForce& m, std::size_t most_points) {
  std::vector<double> time_s, velocity, position, before, after, both;
  const std::size_t n = m.before.size();
  if (m.time_s.size() != n || m.velocity.size() != n || m.position.size() != n || m.after.size() != n)
    return "";
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(m.time_s[i] + m.velocity[i] + m.position[i] + m.before[i] + m.after[i])) continue;
    time_s.push_back(m.time_s[i]);
    velocity.push_back(m.velocity[i]);
    position.push_back(m.position[i]);
    before.push_back(m.before[i]);
    after.push_back(m.after[i]);
  }
  if (before.empty()) return "";
  both = before;
  both.insert(both.end(), after.begin(), after.end());
  const Interval y = not_empty(quantile(both, 0.005), quantile(both, 0.995), 0.08);
  const std::string y_title =
      in_unit(m.unit == "N m" ? "missing torque" : "missing force", std::string(m.unit));
  const auto panel_over = [&](const std::vector<double>& x, const std::string& x_title, Bins bins) {
    return two_clouds(x, before, after, y, x_title, y_title, bins.mean, most_points);
  };
  std::string out = "<div class=\"panels\">\n";
  out += panel_over(velocity, in_unit("velocity", std::string(m.velocity_unit)), kOverVelocity);
  out += panel_over(position, in_unit("position", std::string(m.position_unit)), kOverPosition);
  out += panel_over(time_s, "time since the recording's start (s)", kOverTime);
  return out + "</div>\n";
}

}  // namespace furcula::report
