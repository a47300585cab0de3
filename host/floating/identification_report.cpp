// Sections of the page of a walking robot's identification.
#include "host/floating/identification_report.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include "host/core/message.hpp"
#include "host/floating/parameter_picture.hpp"
#include "host/floating/predicted.hpp"
#include "host/floating/walk_picture.hpp"
#include "host/report/html.hpp"
#include "host/report/page.hpp"
#include "host/report/trace_plot.hpp"

namespace furcula::floating {
namespace {

using report::escape;
using report::number;

/// What the identified model is judged on: held-out recordings, or where there are none those of the fit.
struct Judged {
  const std::vector<Recording>& recordings;
  const WindowErrors &given, &identified;
  std::string name;
};
Judged judged(const Identification& of) {
  if (of.held_out_before != nullptr)
    return {*of.held_out, *of.held_out_before, *of.held_out_after, "held-out"};
  return {*of.training, of.found->before, of.found->after, "training"};
}

struct Kind {
  const char* name;
  double WindowErrors::*of;
  double factor;
  const char* unit;
};
constexpr Kind kKinds[] = {{"joint angles", &WindowErrors::angle_rad, 1e3, "mrad"},
                           {"attitude", &WindowErrors::attitude_rad, 1e3, "mrad"},
                           {"gyro", &WindowErrors::gyro_radps, 1e3, "mrad/s"}};

std::string header(const Identification& of) {
  const Judged on = judged(of);
  std::string better, worse;
  for (const Kind& k : kKinds) {
    std::string& where = on.identified.*k.of < on.given.*k.of ? better : worse;
    where += (where.empty() ? "" : " and ") + std::string(k.name);
  }
  const bool all = worse.empty(), none = better.empty();
  return "<header>\n<p class=\"eyebrow\">Identification of a walking robot &middot; " + escape(of.robot) +
         "</p>\n<p>" +
         report::badge(all    ? "Predicts better"
                       : none ? "Predicts no better"
                              : "Predicts better in part",
                       all    ? report::Tone::good
                       : none ? report::Tone::bad
                              : report::Tone::notice) +
         "</p>\n<h1>" +
         escape(all || none ? "The identified model predicts " + on.name + " windows " +
                                  (all ? "better" : "no better") + " than the model as given."
                            : "On " + on.name + " windows the identified model predicts " + better +
                                  " better than the model as given, but not " + worse + ".") +
         "</h1>\n</header>\n";
}

/// Columns of tables: what the model is judged on, then the fit's recordings where these are others.
struct Sets {
  explicit Sets(const Identification& of) {
    const Judged on = judged(of);
    errors = {&on.given, &on.identified};
    if (of.held_out_before != nullptr) errors.insert(errors.end(), {&of.found->before, &of.found->after});
  }
  std::vector<report::Table::Column> columns(const char* first) const {
    std::vector<report::Table::Column> out{{first}};
    const std::size_t held_out = errors.size() - 2;
    for (std::size_t k = 0; k < errors.size(); ++k)
      out.push_back({k % 2 == 1     ? "Identified"
                     : k < held_out ? "Held out, as given"
                                    : "Training, as given",
                     true});
    return out;
  }
  std::vector<const WindowErrors*> errors;  ///< by the model as given and the identified one, in turn
};

std::string answer(const Identification& of) {
  const Judged on = judged(of);
  std::vector<report::KeyFigure> figures;
  for (const Kind& k : kKinds)
    figures.push_back({"RMS error of " + std::string(k.name),
                       "<small>" + number(k.factor * (on.given.*k.of), 3) +
                           " <span class=\"arrow\">&#8594;</span> </small>" +
                           number(k.factor * (on.identified.*k.of), 3) + "&#8239;<small>" + k.unit +
                           "</small>",
                       "as given, identified; " + on.name + " windows"});
  figures.push_back({"Numbers that the recordings narrow",
                     std::to_string(narrowed(*of.found)) + " <small>of " +
                         std::to_string(of.found->unknowns.size()) + "</small>",
                     "to less than half of their prior's standard deviation"});
  const Sets sets(of);
  report::Table table(sets.columns("RMS error"));
  for (const Kind& k : kKinds) {
    std::vector<std::string> cells{report::in_words(k.name) + ", " + k.unit};
    for (const WindowErrors* e : sets.errors) cells.push_back(number(k.factor * (e->*k.of)));
    table.add(std::move(cells));
  }
  std::vector<std::string> counts{"Number of windows"};
  for (const WindowErrors* e : sets.errors) counts.push_back(std::to_string(e->windows));
  table.add(std::move(counts));
  return report::key_figures(figures) + table.html() +
         report::paragraph(
             "Root mean squares of measured minus predicted. Each window is simulated for " +
             core::rounded(of.window_s, 3) +
             " s or less from a start that is fitted to it, driven by the logged joint targets. The attitude "
             "filter's error and its drift are fitted too, disturbances are not.") +
         (of.held_out_before != nullptr
              ? ""
              : report::paragraph("No recording is held out: these windows are those of the fit."));
}

constexpr std::size_t kTraces = 3;

/// The channels whose traces are shown.
std::vector<std::size_t> shown(const Judged& on) {
  std::vector<std::size_t> out = worst_first(on.identified);
  out.resize(kTraces);
  return out;
}

std::string channels(const Identification& of) {
  const Judged on = judged(of);
  const Sets sets(of);
  std::vector<report::Table::Column> columns = sets.columns("Channel");
  columns.insert(columns.begin() + 3, {"Error removed", true});
  report::Table table(std::move(columns));
  const std::vector<std::size_t> worst = shown(on);
  for (std::size_t c = 0; c < kRowSize; ++c) {
    std::vector<std::string> cells{escape(report::in_words(channel_name(c)))};
    for (std::size_t k = 0; k < sets.errors.size(); ++k) {
      cells.push_back(number(1e3 * sets.errors[k]->channels[c]));
      if (k == 1) cells.push_back(report::share_bar(1.0 - on.identified.channels[c] / on.given.channels[c]));
    }
    table.add(std::move(cells), std::find(worst.begin(), worst.end(), c) != worst.end());
  }
  return table.html() +
         report::paragraph(
             "Root mean squares over all windows, in mrad; of the gyro in mrad/s. Joints: angles as the encoders measure them. Roll, pitch and yaw: "
             "attitude about the pelvis' axes x, y and z, as the attitude filter gives it. Marked: the largest errors "
             "of the identified model in units of their noise; their traces are below.");
}

report::TraceData traces(const Identification& of) {
  const Judged on = judged(of);
  report::TracePlot plot{{"measured", "as given", "identified"}, {}};
  std::deque<std::vector<double>> kept;
  const auto keep = [&](auto&& value_at, std::size_t n) {
    std::vector<double> v(n);
    for (std::size_t k = 0; k < n; ++k) v[k] = value_at(k);
    kept.push_back(std::move(v));
    return std::span<const double>(kept.back());
  };
  for (const std::size_t c : shown(on))
    for (std::size_t w = 0; w < on.identified.predicted.size(); ++w) {
      const Window& window = on.identified.predicted[w].window;
      const Recording& recording = on.recordings[window.recording];
      const std::vector<Row> given = predicted_rows(recording, on.given.predicted[w]),
                             identified = predicted_rows(recording, on.identified.predicted[w]);
      const auto measured = [&](std::size_t k) -> const Row& { return recording.rows[window.first + 1 + k]; };
      // Of yaw a whole turn more or less is the same.
      const auto near = [&](const Row& row, std::size_t k) {
        const double m = value_of(measured(k), c), error = value_of(row, c) - m;
        return c == kJoints + 2 ? m + std::remainder(error, 2.0 * M_PI) : m + error;
      };
      const std::size_t n = given.size();
      plot.windows.push_back({recording.file,
                              channel_name(c),
                              channel_unit(c),
                              keep([&](std::size_t k) { return measured(k).time_s; }, n),
                              {keep([&](std::size_t k) { return value_of(measured(k), c); }, n),
                               keep([&](std::size_t k) { return near(given[k], k); }, n),
                               keep([&](std::size_t k) { return near(identified[k], k); }, n)}});
    }
  return report::encode(plot);
}

std::string causes_html(const Identified& found) {
  const std::string how = report::paragraph(
      "A number is named here where its deviation is the same in all windows and the windows are likelier with it than without. The ground, the "
      "soles and the ramp of dry friction are not among the candidates: two simulators differ in these.");
  const std::string all =
      found.all_numbers_deviate
          ? report::paragraph(
                "The numbers of document 000, Tables I and II, deviate all together, none of them by itself: that is likelier than four or more "
                "that do. Causes are laws beyond them.")
          : "";
  if (found.causes.empty())
    return report::paragraph(all.empty() ? "None: no number is likelier to differ from the model than not."
                                         : "None beyond the tables.") +
           all + how;
  report::Table table({{"Number"}, {"Deviation, about", true}, {"Confidence", true}, {"Correlated with"}});
  for (const Cause& c : found.causes) {
    const Unknown& u = found.unknowns[c.unknown];
    std::string others;
    for (const std::size_t i : c.correlated_with)
      others += (others.empty() ? "" : ", ") + found.unknowns[i].name();
    table.add({escape(u.name()), number(c.theta * u.prior_sd, 2) + " " + escape(u.unit),
               number(c.confidence, 2), escape(others)},
              c.confidence > 0.5);
  }
  return table.html() + all + how;
}

std::string recordings_html(const Identification& of) {
  report::Table table({{"Recording"},
                       {"Use"},
                       {"Hips' pitch"},
                       {"Duration, s", true},
                       {"Windows", true},
                       {"In windows, s", true},
                       {"At landings, s", true},
                       {"No stance foot, s", true},
                       {"Too short, s", true}});
  std::string notes;
  const auto add = [&](const std::vector<Recording>& recordings, const char* use) {
    for (std::size_t i = 0; i < recordings.size(); ++i) {
      const Recording& r = recordings[i];
      Unused unused;
      const std::vector<Window> windows = windows_of(r, i, of.window_s, &unused);
      double in_windows_s = 0.0;
      for (const Window& w : windows)
        in_windows_s += r.rows[w.first + w.count - 1].time_s - r.rows[w.first].time_s;
      table.add({escape(r.file), use, r.passive_hips ? "on springs" : "on drives",
                 number(r.rows.empty() ? 0.0 : r.rows.back().time_s - r.rows.front().time_s),
                 std::to_string(windows.size()), number(in_windows_s), number(unused.landings_s),
                 number(unused.no_stance_s), number(unused.short_s)});
      for (const std::string& note : r.notes) notes += "<li>" + escape(note) + "</li>\n";
    }
  };
  add(*of.training, "training");
  add(*of.held_out, "held out");
  return table.html() + (notes.empty() ? "" : "<ul>" + notes + "</ul>\n") +
         report::paragraph(
             "A window has no landing in it, begins at least 60 ms after one, and has a stance foot throughout, unless the robot is on its stand; it is longer "
             "than half of " +
             core::rounded(of.window_s, 3) +
             " s. Time outside of windows: landings with the 60 ms after them, no stance foot throughout, "
             "or too little time to the next landing or the end.");
}

}  // namespace

std::string render_identification_report(const Identification& of) {
  const Judged on = judged(of);
  const WalkPicture picture = walk_picture(of.found->given, on.recordings, on.given, on.identified);
  const report::TraceData data = traces(of);
  report::Page page;
  page.title = "Identification of " + of.robot;
  page.command = of.command;
  page.data_json = data.json;
  page.walk_json = picture.json;
  page.body_html = header(of) + report::section("answer", "Errors of prediction", answer(of)) +
                   report::section("causes", "Causes", causes_html(*of.found)) +
                   report::section("walk", "Measured and predicted walk", picture.html) +
                   report::section("channels", "Errors by joint and sensor",
                                   channels(of) + report::trace_plot_html(data, "measured minus predicted")) +
                   report::section("parameters", "What the recordings tell", parameters_html(*of.found)) +
                   report::section("recordings", "Recordings", recordings_html(of));
  return report::render(page);
}

}  // namespace furcula::floating
