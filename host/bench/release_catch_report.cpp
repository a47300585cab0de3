// What stands on the page of a release/catch test, from top to bottom.
#include "host/bench/release_catch_report.hpp"

#include <algorithm>
#include <cmath>

#include "host/report/html.hpp"
#include "host/report/page.hpp"
#include "host/report/trace_plot.hpp"

namespace furcula::bench {
namespace {

using report::number;
using report::Table;
using report::Tone;

std::string milliseconds(double time_s) {
  return std::isfinite(time_s) ? number(1e3 * time_s, 3) + "&#8239;<small>ms</small>" : "never";
}
std::string millimetres(double length_m) {
  return std::isfinite(length_m) ? number(1e3 * length_m, 3) + "&#8239;<small>mm</small>" : "&ndash;";
}

std::string header(const ReleaseCatch& r) {
  const Conditions& c = r.options.conditions;
  const std::string what = number(c.load_kg) + " kg, released for " + number(1e3 * c.window_s) + " ms";
  const std::string end = !r.standard.held         ? " is not held"
                          : !r.standard.released() ? " is never released"
                          : r.standard.caught() ? " is caught " + number(1e3 * r.standard.caught_after_s, 3) +
                                                      " ms after the command"
                                                : " is not caught";
  const std::string verdict =
      r.checks.empty() ? ""
                       : report::badge(r.passed ? "Passed" : "Failed", r.passed ? Tone::good : Tone::bad);
  return "<header>\n<p class=\"eyebrow\">Release and catch &middot; board <code>" + report::escape(r.board) +
         "</code></p>\n<p>" + verdict + "</p>\n<h1>" + report::escape(what + end + ".") +
         "</h1>\n</header>\n";
}

std::string figures(const ReleaseCatch& r) {
  const Summary& s = r.summary;
  if (s.trials == 0) return "";
  return report::key_figures(
      {{"Caught after", milliseconds(s.caught_after_median_s),
        "median of " + std::to_string(s.trials) + " varied trials"},
       {"5 to 95 %",
        milliseconds(s.caught_after_p5_s) + " <small>to</small> " + milliseconds(s.caught_after_p95_s),
        "of those that were caught"},
       {"Worst", milliseconds(s.caught_after_worst_s),
        s.not_caught + s.not_released + s.not_held < s.trials
            ? "held after a drop of " + number(1e3 * s.drop_worst_m, 3) + " mm at most"
            : "none was caught"},
       {"Not caught", std::to_string(s.not_caught),
        std::to_string(s.slips) + " slipped after they stood, " + std::to_string(s.not_released) +
            " were never released"}});
}

std::string checks(const ReleaseCatch& r) {
  Table table({{"Limit"}, {"Asked", true}, {"Measured", true}, {""}});
  for (const Check& c : r.checks)
    table.add(
        {"<code>" + report::escape(c.name) + "</code>",
         (c.at_most ? "&le; " : "&ge; ") + number(c.limit) + " " + report::escape(c.unit),
         std::isfinite(c.measured) ? number(c.measured) + " " + report::escape(c.unit) : "not in every trial",
         report::badge(c.passed ? "passed" : "failed", c.passed ? Tone::good : Tone::bad)});
  return table.empty() ? "" : table.html();
}

/// How many trials were caught after how many milliseconds.
std::string distribution(const ReleaseCatch& r) {
  std::vector<double> all;
  for (const Trial& t : r.trials)
    if (t.caught()) all.push_back(1e3 * t.caught_after_s);
  if (all.size() < 5) return "";
  const auto [low, high] = std::minmax_element(all.begin(), all.end());
  const double width = std::max(1.0, std::ceil((*high - *low + 1.0) / 24.0)), first = std::floor(*low);
  std::vector<std::size_t> bins(static_cast<std::size_t>((*high - first) / width) + 1, 0);
  for (const double ms : all) ++bins[static_cast<std::size_t>((ms - first) / width)];
  const auto most = static_cast<double>(*std::max_element(bins.begin(), bins.end()));
  Table table({{"Caught after"}, {"Trials", true}, {""}});
  for (std::size_t i = 0; i < bins.size(); ++i) {
    const double from = first + width * static_cast<double>(i);
    const double percent = 100.0 * static_cast<double>(bins[i]) / most;
    table.add({number(from) + (width > 1.0 ? " to " + number(from + width - 1.0) : "") + " ms",
               std::to_string(bins[i]),
               "<svg width=\"200\" height=\"10\" role=\"img\"><rect width=\"" + number(2.0 * percent, 4) +
                   "\" height=\"10\" fill=\"currentColor\" opacity=\"0.55\"/></svg>"});
  }
  return table.html();
}

std::string sweep(const Sweep& s) {
  const bool window = s.of == "window_s", load = s.of == "load_kg";
  Table table({{window ? "Window, ms"
                : load ? "Load, kg"
                       : "Pressing force, N",
                true},
               {"Released after", true},
               {"Caught after", true},
               {"Drop", true},
               {""}});
  for (std::size_t i = 0; i < s.values.size(); ++i) {
    const Trial& t = s.trials[i];
    table.add({number(window ? 1e3 * s.values[i] : s.values[i]), milliseconds(t.released_after_s),
               milliseconds(t.caught_after_s), t.caught() ? millimetres(t.drop_m) : "&ndash;",
               t.slipped ? "slipped" : ""});
  }
  return table.html();
}

std::string holding(const ReleaseCatch& r) {
  Table table({{"Pressing force, N", true}, {"Holds, kg", true}, {"Held force over pressing force", true}});
  for (const Holding& h : r.holding)
    table.add({number(h.pressing_n), number(h.load_kg), number(9.81 * h.load_kg / h.pressing_n)});
  return table.html();
}

}  // namespace

std::string render_release_catch_report(const ReleaseCatch& r, double metres_per_count,
                                        const std::string& command) {
  std::vector<std::vector<double>> time_s, travel_m, fall_m;
  report::TracePlot plot;
  plot.labels = {"measured", "free fall"};
  const auto trace = [&](const Trial& t, const std::string& name) {
    if (t.readings.empty()) return;
    std::vector<double> time, travel, fall;
    const double free_s = kRest_s + t.released_after_s;
    for (std::size_t n = 0; n < t.readings.size() && n < 250; ++n) {
      time.push_back(1e-3 * static_cast<double>(n));
      travel.push_back(t.readings[n].count * metres_per_count);
      const double fallen_s = std::max(0.0, time.back() - free_s);
      const double fell = std::isfinite(free_s) ? 0.5 * 9.81 * fallen_s * fallen_s : 0.0;
      fall.push_back(t.caught() ? std::min(fell, t.drop_m) : fell);
    }
    time_s.push_back(std::move(time));
    travel_m.push_back(std::move(travel));
    fall_m.push_back(std::move(fall));
    plot.windows.push_back({name, "drop", "m", {}, {}});
  };
  trace(r.standard, "as given");
  if (!r.trials.empty()) trace(r.trials[r.worst], "the worst of the varied trials");
  for (std::size_t i = 0; i < plot.windows.size(); ++i) {
    plot.windows[i].time_s = time_s[i];
    plot.windows[i].values = {travel_m[i], fall_m[i]};
  }
  const report::TraceData data = report::encode(plot);
  report::Page page;
  page.title = "Release and catch";
  page.data_json = data.json;
  page.command = command;
  page.body_html =
      header(r) + figures(r) + report::section("limits", "Limits", checks(r)) +
      report::section("traces", "Drop over time",
                      report::paragraph("Released at 20 ms; from the encoder, a sample a millisecond; beside "
                                        "it a free fall from the first motion on, as far as the load fell.") +
                          report::trace_plot_html(data, "measured minus free fall")) +
      report::section("distribution", "Distribution of the varied trials", distribution(r));
  for (const Sweep& s : r.sweeps)
    page.body_html += report::section("sweep-" + std::string(s.of),
                                      s.of == "load_kg"    ? "Load"
                                      : s.of == "window_s" ? "Window"
                                                           : "Pressing force",
                                      sweep(s));
  if (r.holding.empty())
    page.body_html += report::paragraph(
        "This board sets nothing but the window: load, supply and pressing force are as the person at the stand "
        "gave them, and were not varied.");
  else
    page.body_html += report::section("holding", "Holding load against pressing force", holding(r));
  return report::render(page);
}

}  // namespace furcula::bench
