// Thinning and encoding of traces for the page's script.
#include "host/report/trace_plot.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "host/report/html.hpp"

namespace furcula::report {
namespace {

using Indices = std::vector<std::size_t>;

/// The samples of a window that are drawn, in order of time.
Indices chosen_samples(const TraceWindow& w, std::size_t most) {
  const std::size_t n = w.time_s.size();
  Indices out;
  if (n <= most) {
    for (std::size_t i = 0; i < n; ++i) out.push_back(i);
    return out;
  }
  const auto present = [n](std::span<const double> v) { return v.size() == n; };
  const auto last = std::find_if(w.values.rbegin(), w.values.rend(), present);
  const bool has_error = last != w.values.rend() && present(w.values.front()) && w.values.size() > 1;
  const auto error = [&](std::size_t i) {
    const double e = has_error                 ? w.values.front()[i] - (*last)[i]
                     : last != w.values.rend() ? (*last)[i]
                                               : 0.0;
    return std::isfinite(e) ? e : 0.0;
  };
  const std::size_t stretches = std::max<std::size_t>(1, (most - std::min<std::size_t>(most, 2)) / 2);
  out.push_back(0);
  for (std::size_t s = 0; s < stretches; ++s) {
    const std::size_t begin = s * n / stretches, end = (s + 1) * n / stretches;
    std::size_t low = begin, high = begin;
    for (std::size_t i = begin; i < end; ++i) {
      if (error(i) < error(low)) low = i;
      if (error(i) > error(high)) high = i;
    }
    for (const std::size_t i : {std::min(low, high), std::max(low, high), s + 1 == stretches ? n - 1 : high})
      if (i > out.back()) out.push_back(i);
  }
  return out;
}

/// Writes numbers rounded to a fixed number of decimals, without needless zeros.
void append(std::string& out, double value, int decimals) {
  if (!std::isfinite(value)) {
    out += "null";
    return;
  }
  char text[400];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, decimals).ptr;
  std::string_view number(text, static_cast<std::size_t>(end - text));
  if (number.find('.') != std::string_view::npos) {
    number.remove_suffix(number.size() - 1 - number.find_last_not_of('0'));
    if (number.back() == '.') number.remove_suffix(1);
  }
  out += number;
}

int decimals_for(double step) {
  return step > 0.0 && std::isfinite(step) ? std::clamp(static_cast<int>(std::ceil(-std::log10(step))), 0, 12)
                                           : 6;
}

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();
  void take(double v) {
    if (!std::isfinite(v)) return;
    low = std::min(low, v);
    high = std::max(high, v);
  }
  double width() const { return high > low ? high - low : 0.0; }
};

struct Series {
  std::string log, channel, unit;
  std::vector<const TraceWindow*> windows;
};

/// In the order in which they come.
std::vector<Series> grouped(const TracePlot& plot) {
  std::vector<Series> out;
  std::map<std::pair<std::string, std::string>, std::size_t> place;
  for (const TraceWindow& w : plot.windows) {
    if (w.time_s.empty()) continue;
    const auto [it, added] = place.try_emplace({w.log, w.channel}, out.size());
    if (added) out.push_back({w.log, w.channel, w.unit, {}});
    out[it->second].windows.push_back(&w);
  }
  return out;
}

/// Where each window starts on the plot's axis, less its own first time.
std::vector<double> shifts(const Series& s, bool& one_after_the_other) {
  std::vector<double> out(s.windows.size(), 0.0);
  one_after_the_other = false;
  for (std::size_t i = 1; i < s.windows.size(); ++i)
    if (s.windows[i]->time_s.front() < s.windows[i - 1]->time_s.back() - 1e-9) one_after_the_other = true;
  double end = 0.0;
  for (std::size_t i = 0; one_after_the_other && i < s.windows.size(); ++i) {
    const auto t = s.windows[i]->time_s;
    out[i] = end - t.front();
    end += t.back() - t.front();
  }
  return out;
}

}  // namespace

TraceData encode(const TracePlot& plot, std::size_t most_samples) {
  const std::vector<Series> series = grouped(plot);
  TraceData out;
  for (const Series& s : series)
    for (const TraceWindow* w : s.windows) out.samples += w->time_s.size();
  if (out.samples == 0) return out;
  const double keep = std::min(1.0, static_cast<double>(most_samples) / static_cast<double>(out.samples));

  const auto text = [](const auto& value) {
    return nlohmann::json(value).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  };
  out.json = "{\"labels\":" + text(plot.labels) + ",\"series\":[";
  for (const Series& s : series) {
    bool one_after_the_other = false;
    const std::vector<double> shift = shifts(s, one_after_the_other);
    std::vector<Indices> chosen;
    std::vector<Range> range(plot.labels.size());
    double step = std::numeric_limits<double>::infinity();
    std::string starts;
    std::size_t start = 0;
    for (const TraceWindow* w : s.windows) {
      const double n = static_cast<double>(w->time_s.size());
      chosen.push_back(chosen_samples(*w, static_cast<std::size_t>(std::ceil(keep * n))));
      starts += (starts.empty() ? "" : ",") + std::to_string(start);
      start += chosen.back().size();
      if (n > 1.0) step = std::min(step, (w->time_s.back() - w->time_s.front()) / (n - 1.0));
      for (std::size_t c = 0; c < std::min(w->values.size(), range.size()); ++c)
        for (const double v : w->values[c]) range[c].take(v);
    }
    out.kept += start;

    if (out.json.back() == '}') out.json += ',';
    out.json += "\n{\"log\":" + text(s.log) + ",\"channel\":" + text(s.channel) +
                ",\"unit\":" + text(s.unit) +
                ",\"one_after_the_other\":" + (one_after_the_other ? "true" : "false") + ",\"starts\":[" +
                starts + "],\"time\":[";
    // A hundredth of a sample's interval and a hundred-thousandth of what was measured: finer than a screen.
    const int time_decimals = decimals_for(0.01 * step);
    for (std::size_t i = 0; i < s.windows.size(); ++i)
      for (const std::size_t k : chosen[i]) {
        if (out.json.back() != '[') out.json += ',';
        append(out.json, s.windows[i]->time_s[k] + shift[i], time_decimals);
      }
    out.json += "],\"values\":[";
    const int decimals = decimals_for(1e-5 * (range.empty() ? 0.0 : range.front().width()));
    for (std::size_t c = 0; c < plot.labels.size(); ++c) {
      out.json += c ? ",[" : "[";
      const bool absent = range[c].low > range[c].high;
      for (std::size_t i = 0; !absent && i < s.windows.size(); ++i) {
        const TraceWindow& w = *s.windows[i];
        const bool present = c < w.values.size() && w.values[c].size() == w.time_s.size();
        for (const std::size_t k : chosen[i]) {
          if (out.json.back() != '[') out.json += ',';
          append(out.json, present ? w.values[c][k] : std::numeric_limits<double>::quiet_NaN(), decimals);
        }
      }
      out.json += ']';
    }
    out.json += "]}";
  }
  out.json += "]}";
  return out;
}

std::string trace_plot_html(const TraceData& data, std::string_view error) {
  if (data.kept == 0) return "";
  std::string out =
      std::string(
          "<div class=\"controls\">"
          "<label id=\"pick-log-label\">Recording <select id=\"pick-log\"></select></label>"
          "<label id=\"pick-channel-label\">Channel <select id=\"pick-channel\"></select></label>"
          "<label>Window <button type=\"button\" id=\"window-before\" title=\"window before\">&#8249;</button>"
          "<select id=\"pick-window\"></select>"
          "<button type=\"button\" id=\"window-after\" title=\"next window\">&#8250;</button></label></div>\n"
          "<p id=\"trace-caption\" class=\"caption\"></p>\n"
          "<div id=\"trace-legend\" class=\"legend\"></div>\n"
          "<div class=\"plot-pair\"><div id=\"trace-plot\" class=\"plot\"></div>\n"
          "<div id=\"error-plot\" class=\"plot error-plot\"></div></div>\n"
          "<p class=\"hint\">Below: error, ") +
      escape(error) +
      ". <span class=\"screen-only\">Drag to zoom, shift-drag to pan, double-click to see all again; the two "
      "plots move together. Click a name in the "
      "legend to hide its line.</span></p>\n"
      "<noscript><p>The traces are drawn by the script inside this file; allow it to see them. All figures "
      "and tables are readable without it.</p></noscript>\n";
  if (data.kept < data.samples)
    out += "<p class=\"hint\">The plots hold " + std::to_string(data.kept) + " of " +
           std::to_string(data.samples) +
           " samples: of each stretch those with the smallest and the largest error. Every figure on this "
           "page is computed from all samples.</p>\n";
  return out;
}

}  // namespace furcula::report
