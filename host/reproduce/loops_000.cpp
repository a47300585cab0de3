#include "host/reproduce/loops_000.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/loop/loop_report.hpp"
#include "host/loop/whole_run.hpp"
#include "host/report/html.hpp"
#include "host/report/page.hpp"
#include "host/walk/walk_report.hpp"

namespace furcula::reproduce {
namespace {

using walk::WalkMode;
using Printed = std::vector<std::vector<double>>;

/// Fig. 7, 1e-3 rad: a row for each model, the first without identification; a column for each walk.
const Printed& printed_active() {
  static const Printed values{
      {84}, {19, 75}, {25, 24, 29}, {39, 43, 31, 25}, {40, 44, 28, 32, 21}, {36, 44, 34, 44, 25, 14}};
  return values;
}
/// Fig. 8.
const Printed& printed_semi_passive() {
  static const Printed values{{77},
                              {9, 90},
                              {32, 22, 21},
                              {41, 32, 23, 69},
                              {47, 52, 22, 42, 45},
                              {51, 53, 26, 52, 31, 53},
                              {52, 53, 22, 53, 39, 51, 47},
                              {53, 53, 25, 54, 45, 51, 41, 69},
                              {45, 55, 23, 55, 44, 44, 41, 51, 69},
                              {59, 59, 26, 60, 55, 58, 44, 46, 59, 23},
                              {43, 59, 23, 59, 46, 48, 49, 46, 59, 21, 21}};
  return values;
}

bool semi_passive(const StudiedLoop& l) { return l.mode == WalkMode::semi_passive; }

std::string model_file(const StudiedLoop& l, std::size_t round) {
  return l.folder + "/round_" + std::to_string(round) + "/identified_model.toml";
}

/// After how many rounds models were identified; that of its exercise is not counted.
std::size_t identified(const StudiedLoop& l) {
  std::size_t n = 0;
  while (n < l.result.rounds.size() && std::filesystem::exists(model_file(l, n + 1))) ++n;
  return n;
}
bool has_model(const StudiedLoop& l) { return identified(l) > 0 || l.result.of_exercise; }

/// One trial of a loop.
struct Trial {
  std::string log;
  floating::Recording recording;
  walk::Walk walk;
};
Trial read_trial(const StudiedLoop& l, std::size_t round, std::size_t repetition) {
  const loop::Round& r = l.result.rounds[round];
  Trial t;
  t.log = l.folder + "/" + r.trials[repetition].log;
  t.walk = walk::read_walk(l.folder + "/" + r.walk);
  loop::Request request;
  request.log = t.log;
  t.recording = loop::read_recording(t.log, request);
  t.recording.passive_hips = t.walk.mode == WalkMode::semi_passive;
  return t;
}

StudiedLoop read_loop(const std::string& folder, const walk::Model& model) {
  StudiedLoop out{folder, WalkMode::active, loop::loop_in(folder + "/loop.json")};
  if (out.result.rounds.empty() || out.result.rounds.front().trials.empty())
    throw core::DataError(folder + "/loop.json: no trial yet; expected a loop whose robot has walked");
  const std::string file = folder + "/" + out.result.rounds.front().walk;
  const walk::Walk first = walk::read_walk(file);
  if (first.robot != model.name)
    throw core::DataError(file + ": a walk of " + core::quoted(first.robot) + "; expected one of " +
                          core::quoted(model.name) + ", the robot of " + model.file);
  out.mode = first.mode;
  return out;
}

/// Recordings of a loop, its exercise first; without the last trial where `all` is false.
std::vector<floating::Recording> recordings_of(const StudiedLoop& l, bool all) {
  std::vector<floating::Recording> out;
  if (!l.result.exercise.empty()) {
    loop::Request stand;
    stand.round = 0;
    stand.log = l.folder + "/" + l.result.exercise;
    out.push_back(loop::read_recording(stand.log, stand));
    out.back().passive_hips = walk::read_walk(l.folder + "/round_0/walk.toml").mode == WalkMode::semi_passive;
  }
  for (std::size_t r = 0; r < l.result.rounds.size(); ++r)
    for (std::size_t k = 0; k < l.result.rounds[r].trials.size(); ++k)
      if (all || r + 1 < l.result.rounds.size() || k + 1 < l.result.rounds[r].trials.size())
        out.push_back(read_trial(l, r, k).recording);
  return out;
}

CrossPrediction predicted_across(const LoopStudyOptions& options, const walk::Model& model,
                                 const StudiedLoop& active, const StudiedLoop& semi) {
  const Trial last =
      read_trial(semi, semi.result.rounds.size() - 1, semi.result.rounds.back().trials.size() - 1);
  floating::IdentifyOptions identify = options.identify;
  identify.settings.threads = options.threads;
  const auto errors_of = [&](const floating::Machine& machine) {
    loop::CellErrors e{
        floating::window_errors(machine, {last.recording}, identify),
        loop::whole_run_errors_rad(model, machine, {{&last.recording, last.walk}}, options.threads).front()};
    e.windows.predicted.clear();
    return e;
  };
  CrossPrediction out;
  out.log = last.log;
  out.given = errors_of(model.machine);
  out.active = errors_of(walk::read_model(model_file(active, identified(active))).machine);
  std::vector<floating::Recording> both = recordings_of(active, true);
  for (floating::Recording& r : recordings_of(semi, false)) both.push_back(std::move(r));
  identify.progress = [&](double fraction, const std::string& doing) {
    if (options.progress) options.progress(fraction, "loops of both modes together: " + doing);
  };
  out.together = errors_of(floating::identify(model.machine, both, identify).machine);
  return out;
}

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// Mean over a round's trials, mrad.
double whole_run_mrad(const loop::LoopResult& r, int model, std::size_t round) {
  double sum = 0.0, n = 0.0;
  for (const auto& [cell, e] : r.triangle)
    if (cell.model == model && cell.round == round) sum += 1e3 * e.whole_run_rad, n += 1.0;
  return n > 0.0 ? sum / n : kNothing;
}

std::string milli(double value) { return core::rounded(value, 3) + "e-3 rad"; }

}  // namespace

LoopStudy study_loops(const LoopStudyOptions& options) {
  const walk::Model model = walk::read_model(options.model);
  LoopStudy out;
  for (const std::string& folder : options.folders) out.loops.push_back(read_loop(folder, model));
  const auto of = [&](bool semi) {
    return std::find_if(out.loops.begin(), out.loops.end(),
                        [&](const StudiedLoop& l) { return semi_passive(l) == semi; });
  };
  const auto active = of(false), semi = of(true);
  if (active != out.loops.end() && semi != out.loops.end() && has_model(*active))
    out.cross = predicted_across(options, model, *active, *semi);
  return out;
}

std::vector<Row> rows_of(const LoopStudy& study) {
  std::vector<Row> rows;
  for (const StudiedLoop& l : study.loops) {
    const Printed& printed = semi_passive(l) ? printed_semi_passive() : printed_active();
    const std::string where = semi_passive(l) ? "IV, Fig. 8" : "IV, Fig. 7",
                      mode = walk::mode_in_words(l.mode);
    const auto& rounds = l.result.rounds;
    const auto add = [&](const std::string& what, const std::string& unit, const std::string& published,
                         double ours) {
      rows.push_back({where, mode + ": " + what, unit, published, ours, {}, Outcome::computed, l.folder});
    };
    const auto first = std::find_if(rounds.begin(), rounds.end(), [](const auto& r) { return r.walks; });
    add("identifications until a walk on the robot", "", semi_passive(l) ? "10 for three walks" : "2",
        // A loop with --identify none counts searches.
        first == rounds.end() || first - rounds.begin() > static_cast<std::ptrdiff_t>(identified(l))
            ? kNothing
            : static_cast<double>(first - rounds.begin() + (l.result.of_exercise ? 1 : 0)));
    add("Eq. 3 of the first walk, model as given", "mrad", milli(printed[0][0]),
        whole_run_mrad(l.result, loop::kGiven, 1));
    const auto last = [&] {
      add("Eq. 3 of the last walk, not in the fit", "mrad", milli(printed.back().back()),
          whole_run_mrad(l.result, static_cast<int>(rounds.size()) - 1, rounds.size()));
    };
    if (identified(l) == 0) {
      if (l.result.of_exercise) last();
      continue;
    }
    add("the same, identified from it", "mrad", milli(printed[1][0]), whole_run_mrad(l.result, 1, 1));
    if (rounds.size() < 2) continue;
    add("Eq. 3 of the second walk, identified from the first", "mrad", milli(printed[1][1]),
        whole_run_mrad(l.result, 1, 2));
    last();
  }
  if (!study.cross) return rows;
  const CrossPrediction& c = *study.cross;
  const auto add = [&](const std::string& what, const std::string& published, const loop::CellErrors& e) {
    rows.push_back({"IV",
                    "Eq. 3 of the last semi-passive walk, " + what,
                    "mrad",
                    published,
                    1e3 * e.whole_run_rad,
                    {},
                    Outcome::computed,
                    "Over windows " + core::rounded(1e3 * loop::model_error_rad(e.windows), 3) + " mrad."});
  };
  add("model as given", "", c.given);
  add("identified from active walks", "259e-3 rad", c.active);
  add("from all recordings but it", "\"if we have more experiments\"", c.together);
  return rows;
}

std::string loops_html(const LoopStudy& study) {
  std::string out;
  for (const StudiedLoop& l : study.loops) {
    const Printed& printed = semi_passive(l) ? printed_semi_passive() : printed_active();
    std::vector<report::Table::Column> columns{{"Printed"}};
    for (std::size_t k = 1; k <= printed.size(); ++k) columns.push_back({"Walk " + std::to_string(k), true});
    report::Table table(std::move(columns));
    for (std::size_t m = 0; m < printed.size(); ++m) {
      std::vector<std::string> cells{m == 0 ? "As given" : "Identified after walk " + std::to_string(m)};
      for (const double value : printed[m]) cells.push_back(core::rounded(value, 3));
      table.add(std::move(cells));
    }
    out += "<h3>" + report::escape(std::string(walk::mode_in_words(l.mode)) + ", " + l.folder) + "</h3>\n" +
           loop::whole_run_triangle_html(l.result) + table.html();
  }
  if (!out.empty())
    out += report::paragraph(
        "Eq. 3 in mrad over whole walks; the printed ones are of the document's robot. A model has seen the walks left of its last column.");
  return out;
}

}  // namespace furcula::reproduce
