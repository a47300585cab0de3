// Sections of the page of a loop.
#include "host/loop/loop_report.hpp"

#include <cctype>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <utility>
#include <vector>

#include "host/core/commands.hpp"
#include "host/core/message.hpp"
#include "host/report/html.hpp"
#include "host/report/line_plot.hpp"
#include "host/report/page.hpp"

namespace furcula::loop {
namespace {

using report::escape;
using report::number;

std::string folder(std::size_t round) { return "round_" + std::to_string(round) + "/"; }
std::string link(const std::string& file, const std::string& text) {
  return "<a href=\"" + escape(file) + "\">" + escape(text) + "</a>";
}
std::size_t walking(const Round& r) {
  std::size_t n = 0;
  for (const TrialResult& t : r.trials) n += t.walks ? 1 : 0;
  return n;
}
std::size_t standing(const Round& r) {
  std::size_t n = 0;
  for (const TrialResult& t : r.trials) n += t.outcome.stands ? 1 : 0;
  return n;
}
double mean_distance_m(const Round& r) {
  double sum = 0.0;
  for (const TrialResult& t : r.trials) sum += t.outcome.way_m;
  return sum / static_cast<double>(r.trials.size());
}

/// Of a model on a round's trials so far, as their root mean square; not a number where none is there.
double error_on_round_mrad(const LoopResult& result, int model, std::size_t round) {
  double sum = 0.0, n = 0.0;
  for (const auto& [cell, errors] : result.triangle)
    if (cell.model == model && cell.round == round) {
      const double e = 1e3 * model_error_rad(errors.windows);
      sum += e * e, n += 1.0;
    }
  return n > 0.0 ? std::sqrt(sum / n) : std::numeric_limits<double>::quiet_NaN();
}

/// Before that round; kGiven where nothing was.
int identified_before(const LoopResult& result, std::size_t round) {
  const bool was =
      round > 1 ? result.rounds[round - 2].identification.has_value() : result.of_exercise.has_value();
  return was ? static_cast<int>(round) - 1 : kGiven;
}
std::string in_words(int model) {
  return model == kGiven ? "as given"
         : model == 0    ? "identified from the exercise"
                         : "identified after round " + std::to_string(model);
}

std::string header(const std::string& robot, const LoopResult& result) {
  const std::size_t round = result.rounds.size();
  const Round& last = result.rounds.back();
  const std::string trials = std::to_string(walking(last)) + " of " + std::to_string(last.trials.size()) +
                             " trials of round " + std::to_string(round);
  return "<header>\n<p class=\"eyebrow\">Walks on a robot, and its identification &middot; " + escape(robot) +
         "</p>\n<p>" +
         report::badge(last.walks             ? "Walks"
                       : result.ended.empty() ? "Does not walk yet"
                                              : "No further walk",
                       last.walks             ? report::Tone::good
                       : result.ended.empty() ? report::Tone::notice
                                              : report::Tone::bad) +
         "</p>\n<h1>" +
         escape(last.walks ? "The robot walks with the walk of round " + std::to_string(round) + "."
                           : "The robot does not walk yet: " + trials + " stand and get at least " +
                                 core::rounded(last.asked_m, 3) + " m.") +
         "</h1>\n" + report::paragraph(result.ended) + "</header>\n";
}

std::string answer(const LoopResult& result) {
  const std::size_t round = result.rounds.size();
  const Round &first = result.rounds.front(), &last = result.rounds.back();
  const auto change = [](double from, double to, const char* unit) {
    return "<small>" + number(from, 3) + " <span class=\"arrow\">&#8594;</span> </small>" + number(to, 3) +
           "&#8239;<small>" + unit + "</small>";
  };
  const auto figure = [](double value, const char* unit) {
    return number(value, 3) + "&#8239;<small>" + unit + "</small>";
  };
  const std::string on = "walk of round " + std::to_string(round);
  const double given_mrad = error_on_round_mrad(result, kGiven, round);
  const int before = identified_before(result, round);
  std::vector<report::KeyFigure> figures;
  figures.push_back(
      before != kGiven
          ? report::KeyFigure{"Error on the last walk, not in the fit",
                              change(given_mrad, error_on_round_mrad(result, before, round), "mrad"),
                              on + ": as given, identified before it"}
          : report::KeyFigure{"Error of the model as given", figure(given_mrad, "mrad"), on});
  figures.push_back({"Distance of the robot",
                     round > 1 ? change(mean_distance_m(first), mean_distance_m(last), "m")
                               : figure(mean_distance_m(last), "m"),
                     std::string(round > 1 ? "first and last round" : "first round") +
                         ", mean of its trials; in simulation " +
                         core::rounded(last.simulated.distance_m, 3) + " m"});
  figures.push_back(
      {"Trials that stand at the end",
       std::to_string(standing(last)) + " <small>of " + std::to_string(last.trials.size()) + "</small>", on});
  return report::key_figures(figures);
}

/// Models below each other, trials side by side.
template <class Value>
std::string triangle_table(const LoopResult& result, bool links, const Value& value) {
  const std::size_t rounds = result.rounds.size();
  std::vector<int> models{kGiven};
  if (result.of_exercise) models.push_back(0);
  for (std::size_t r = 1; r <= rounds; ++r)
    if (result.rounds[r - 1].identification) models.push_back(static_cast<int>(r));
  std::vector<report::Table::Column> columns{{"Model"}};
  for (std::size_t r = 1; r <= rounds; ++r)
    for (std::size_t k = 1; k <= result.rounds[r - 1].trials.size(); ++k)
      columns.push_back({"Round " + std::to_string(r) +
                             (result.rounds[r - 1].trials.size() > 1 ? ", trial " + std::to_string(k) : ""),
                         true});
  report::Table table(std::move(columns));
  for (const int m : models) {
    std::string name = in_words(m);
    name[0] = static_cast<char>(std::toupper(name[0]));
    std::vector<std::string> cells{
        m != kGiven && links ? link(folder(static_cast<std::size_t>(m)) + "identified_model.toml", name)
                             : name};
    for (std::size_t r = 1; r <= rounds; ++r)
      for (std::size_t k = 1; k <= result.rounds[r - 1].trials.size(); ++k) {
        const auto found = result.triangle.find({m, static_cast<unsigned>(r), static_cast<unsigned>(k)});
        cells.push_back(found == result.triangle.end()
                            ? ""
                            : std::string("<span class=\"cell") +
                                  (found->first.training() ? " training" : "") +
                                  (result.rounds[r - 1].trials[k - 1].outcome.stands ? " stood" : "") +
                                  "\">" + number(value(found->second), 3) + "</span>");
      }
    table.add(std::move(cells));
  }
  return table.html();
}

std::string triangle_html(const LoopResult& result) {
  if (result.triangle.empty()) return "";
  using Errors = CellErrors;
  const auto part = [&](const char* title, auto&& value) {
    return "<h4>" + escape(title) + "</h4>\n" + triangle_table(result, false, value);
  };
  return triangle_table(result, true, [](const Errors& e) { return 1e3 * model_error_rad(e.windows); }) +
         "<div class=\"legend\"><span class=\"key training-key\">training: the model was identified from this trial</span>"
         "<span class=\"key stood-key\">the robot stood at the end of this trial</span></div>\n" +
         report::paragraph(
             "Root mean squares of measured minus predicted, in mrad, over joint angles and attitude together: document 000, "
             "Eq. 3, without the joint targets. Each window is simulated from a start that is fitted to it, driven by the logged joint "
             "targets; the attitude filter's error is fitted too. Without a mark a number is a prediction of a trial that the model has not seen.") +
         "<h3>Whole walks</h3>\n" + whole_run_triangle_html(result) +
         report::paragraph(
             "Document 000, Eq. 3, in mrad: each model walks from the start on with the walking controller. Root mean squares of measured minus "
             "simulated over joint angles, joint targets, roll, pitch and yaw until the robot falls. When the feet land differs, so errors are larger than over windows.") +
         "<details><summary>Windows: joint angles, attitude and gyro</summary>\n" +
         part("Joint angles, mrad", [](const Errors& e) { return 1e3 * e.windows.angle_rad; }) +
         part("Attitude, mrad", [](const Errors& e) { return 1e3 * e.windows.attitude_rad; }) +
         part("Gyro, mrad/s", [](const Errors& e) { return 1e3 * e.windows.gyro_radps; }) + "</details>\n";
}

std::string over_rounds(const LoopResult& result) {
  report::Line given{"model as given", {}, {}}, before{"identified before the round", {}, {}},
      training{"identified after it (training)", {}, {}}, robot{"robot, each trial", {}, {}, true},
      simulated{"simulation", {}, {}}, asked{"least distance to walk", {}, {}};
  const auto add = [](report::Line& line, std::size_t round, double y) {
    line.x.push_back(static_cast<double>(round));
    line.y.push_back(y);
  };
  for (std::size_t r = 1; r <= result.rounds.size(); ++r) {
    const Round& round = result.rounds[r - 1];
    add(given, r, error_on_round_mrad(result, kGiven, r));
    if (const int model = identified_before(result, r); model != kGiven)
      add(before, r, error_on_round_mrad(result, model, r));
    if (round.identification) add(training, r, error_on_round_mrad(result, static_cast<int>(r), r));
    for (const TrialResult& t : round.trials) add(robot, r, t.outcome.way_m);
    add(simulated, r, round.simulated.distance_m);
    add(asked, r, round.asked_m);
  }
  report::LinePlot errors{
      "Error on the walk of a round, mrad", "round", {given, before, training}, true, true},
      distance{"Distance, m", "round", {robot, simulated, asked}, true, true};
  return report::line_plot_html(errors) + report::line_plot_html(distance);
}

/// Document 000, Fig. 9 (b), and how far apart robot and simulation are over time.
std::string last_trial(const LoopResult& result) {
  if (!result.last_trial) return "";
  const BesideSimulation& b = *result.last_trial;
  constexpr std::size_t kTurns = 2 * biped::kJoints;
  const auto lines = [&](const std::string& title,
                         std::initializer_list<std::pair<std::size_t, std::string>> of) {
    report::LinePlot plot{title, "s", {}};
    for (const auto& [i, name] : of) {
      plot.lines.push_back({name + ", robot", b.time_s, b.measured_rad[i]});
      plot.lines.push_back({name + ", simulation", b.time_s, b.simulated_rad[i]});
    }
    return report::line_plot_html(plot);
  };
  const auto apart = [&](const std::string& name, std::size_t first, std::size_t count) {
    report::Line line{name, b.time_s, {}};
    for (std::size_t k = 0; k < b.time_s.size(); ++k) {
      double sum = 0.0;
      for (std::size_t i = first; i < first + count; ++i) {
        const double off = b.measured_rad[i][k] - b.simulated_rad[i][k];
        sum += off * off;
      }
      line.y.push_back(1e3 * std::sqrt(sum / static_cast<double>(count)));
    }
    return line;
  };
  constexpr std::size_t kRight = biped::kLegJoints + dynamics::biped::kHipRoll;
  return lines("Hip roll, rad", {{dynamics::biped::kHipRoll, "left"}, {kRight, "right"}}) +
         lines("Targets of hip roll, rad",
               {{biped::kJoints + dynamics::biped::kHipRoll, "left"}, {biped::kJoints + kRight, "right"}}) +
         lines("Attitude, rad", {{kTurns, "roll"}, {kTurns + 1, "pitch"}}) +
         report::line_plot_html(
             {"Measured minus simulated, root mean square, mrad",
              "s",
              {apart("12 joint angles", 0, biped::kJoints), apart("roll and pitch", kTurns, 2)},
              true}) +
         report::paragraph(
             "The last trial, " + result.rounds.back().trials.back().log +
             ", and the whole walk simulated with the model that it was searched on. Both begin where the first target "
             "leaves its place; a simulated robot that has fallen stays as it is.");
}

std::string causes_html(const Identification& of, const std::string& from) {
  if (of.whole_run_rad)
    return report::paragraph("Identified by a search over whole walks: Eq. 3 over all trials so far " +
                             number(1e3 * of.whole_run_rad->first, 3) + " to " +
                             number(1e3 * of.whole_run_rad->second, 3) + " mrad.");
  const std::string together =
      of.all_numbers_deviate
          ? report::paragraph(
                "The numbers of document 000's tables deviate all together, none by itself. Causes are laws beyond them.")
          : "";
  if (of.causes.empty())
    return together +
           report::paragraph(
               of.all_numbers_deviate
                   ? "Causes: none beyond the tables."
                   : "Causes: none; no number is likelier to differ from the model as given than not.");
  report::Table causes({{"Cause"}, {"Deviation, about", true}, {"Confidence", true}});
  for (const NamedCause& c : of.causes)
    causes.add({escape(c.name), number(c.deviation, 2) + " " + escape(c.unit), number(c.confidence, 2)},
               c.confidence > 0.5);
  return together + "<h4>Causes, " + from + "</h4>\n" + causes.html();
}

std::string round_html(const LoopResult& result, std::size_t r) {
  const Round& round = result.rounds[r - 1];
  std::string out =
      "<h3>Round " + std::to_string(r) + "</h3>\n<p>" + link(round.walk, "walk.toml") +
      (identified_before(result, r) != kGiven || r > 1 ? ", " + link(folder(r) + "report.html", "its search")
                                                       : "") +
      (round.identification && !round.identification->whole_run_rad
           ? ", " + link(folder(r) + "identification.html", "identification")
           : "") +
      "</p>\n";
  const walk::Rollout& s = round.simulated;
  out += report::paragraph("In simulation of the model " + in_words(identified_before(result, r)) + ": " +
                           (s.ending == walk::Ending::stands ? "stands" : "does not stand") + ", " +
                           core::rounded(s.distance_m, 3) + " m" +
                           (std::isfinite(s.cot) ? ", cost of transport " + core::rounded(s.cot, 3) : "") +
                           ". The robot walks in a trial in which it stands at the end and gets at least " +
                           core::rounded(round.asked_m, 3) + " m.");
  report::Table trials({{"Trial"}, {"Outcome"}, {"Time, s", true}, {"Distance, m", true}, {"Walks"}});
  for (const TrialResult& t : round.trials)
    trials.add({link(t.log, t.log),
                t.outcome.fall_s   ? "falls after " + number(*t.outcome.fall_s) + " s"
                : t.outcome.stands ? "stands"
                                   : "the log ends early",
                number(t.outcome.time_s), number(t.outcome.way_m), t.walks ? "yes" : "no"},
               t.walks);
  out += trials.html();
  return round.identification ? out + causes_html(*round.identification, "from all recordings so far") : out;
}

std::string command_of(const LoopOptions& o) {
  return "furcula walk loop --model " + core::shell_word(o.model) + " --walk " + core::shell_word(o.walk) +
         " --robot " + core::shell_word(o.robot) + " --rounds " + std::to_string(o.rounds) +
         " --exercise-s " + core::shortest(o.exercise_s) + " --repetitions " + std::to_string(o.repetitions) +
         " --steps " + std::to_string(o.steps) +
         (o.identify_by != IdentifyBy::windows
              ? " --identify " + std::string(kIdentifyByNames[static_cast<std::size_t>(o.identify_by)])
              : "") +
         (o.ensemble.robots != walk::EnsembleOptions{}.robots
              ? " --robots " + std::to_string(o.ensemble.robots)
              : "") +
         (o.ensemble.deviations != walk::EnsembleOptions{}.deviations
              ? " --deviations " + core::shortest(o.ensemble.deviations)
              : "") +
         (o.mode ? " --mode " + std::string(walk::kModeNames[static_cast<std::size_t>(*o.mode)]) : "") +
         " --seed " + std::to_string(o.seed) + " --out " + core::shell_word(o.out);
}

}  // namespace

std::string whole_run_triangle_html(const LoopResult& result) {
  return triangle_table(result, false, [](const CellErrors& e) { return 1e3 * e.whole_run_rad; });
}

std::string render_loop_report(const std::string& robot, const LoopOptions& options,
                               const LoopResult& result) {
  report::Page page;
  page.title = "Loop of " + robot;
  page.command = command_of(options);
  std::string rounds;
  for (std::size_t r = result.rounds.size(); r > 0; --r) rounds += round_html(result, r);
  if (!result.exercise.empty())
    rounds += "<h3>Before them</h3>\n<p>The robot moved its legs on its stand: " +
              link(result.exercise, result.exercise) +
              ". Each identification has this recording, too.</p>\n" +
              (result.of_exercise
                   ? "<p>The first walk was searched about the model that is identified from it alone: " +
                         link(folder(0) + "identification.html", "identification") + ".</p>\n" +
                         causes_html(*result.of_exercise, "from the exercise")
                   : "");
  page.body_html =
      header(robot, result) + report::section("answer", "Result so far", answer(result)) +
      report::section("triangle", "Prediction errors of each model on each walk", triangle_html(result)) +
      report::section("over-rounds", "Error and distance over rounds", over_rounds(result)) +
      report::section("last-trial", "The last walk: robot and simulation", last_trial(result)) +
      report::section("rounds", "Rounds, the last one first", rounds);
  return report::render(page);
}

}  // namespace furcula::loop
