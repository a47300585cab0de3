#include "host/loop/loop.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include "furcula/core/crc32.hpp"
#include "host/biped/machine_toml.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/commands.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/own_build.hpp"
#include "host/floating/identification_report.hpp"
#include "host/loop/loop_report.hpp"
#include "host/loop/whole_run.hpp"
#include "host/walk/searched.hpp"

namespace furcula::loop {
namespace {

namespace fs = std::filesystem;
using core::DataError;

std::string text_hash(const std::string& text) {
  Crc32 crc;
  for (const char c : text) crc.add(static_cast<std::uint8_t>(c));
  return core::hexadecimal(crc.value());
}

std::string errors_in_words(const floating::WindowErrors& given, const floating::WindowErrors& identified) {
  const auto both = [](double a, double b) { return core::rounded(a, 3) + " to " + core::rounded(b, 3); };
  return std::to_string(given.windows) + " windows, RMS as given and identified: joints " +
         both(1e3 * given.angle_rad, 1e3 * identified.angle_rad) + " mrad, attitude " +
         both(1e3 * given.attitude_rad, 1e3 * identified.attitude_rad) + " mrad, gyro " +
         both(given.gyro_radps, identified.gyro_radps) + " rad/s";
}

std::string simulated_in_words(const walk::Rollout& r, const walk::WalkLimits& limits) {
  std::string out;
  if (r.ending == walk::Ending::stands)
    out = "stands, " + core::rounded(r.distance_m, 3) + " m" +
          (std::isfinite(r.cot) ? ", cost of transport " + core::rounded(r.cot, 3) : "");
  for (const std::string& limit : walk::broken_limits(r, limits)) out += (out.empty() ? "" : "; ") + limit;
  return out;
}

std::string in_words(const Outcome& o, double asked_s) {
  std::string out = o.fall_s   ? "falls after " + core::rounded(*o.fall_s, 3) + " s"
                    : o.stands ? "stands, " + core::rounded(o.time_s, 3) + " s"
                               : "the log ends after " + core::rounded(o.time_s, 3) + " s of " +
                                     core::rounded(asked_s, 3) + " s";
  return out + ", " + core::rounded(o.way_m, 3) + " m";
}

void make_folder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error)
    throw core::OutputError(path + ": cannot be made: " + error.message() +
                            "; expected a folder to write to");
}

class Loop {
 public:
  explicit Loop(const LoopOptions& options)
      : o_(options), given_(walk::read_model(options.model)), first_(walk::read_walk(options.walk)) {
    walk::require_steps(first_, o_.walk);
    if (first_.robot != given_.name)
      throw DataError(o_.walk + ": a walk of " + core::quoted(first_.robot) + "; expected one of " +
                      core::quoted(given_.name) + ", the robot of " + o_.model);
    const walk::WalkMode searched = mode();
    for (const walk::WalkMode m : {first_.mode, searched})
      if (m != walk::WalkMode::active && m != walk::WalkMode::semi_passive)
        throw DataError(o_.walk + ": mode " + core::quoted(walk::kModeNames[static_cast<std::size_t>(m)]) +
                        "; expected active or semi_passive, which are identified");
    if (o_.robot != kManual) command_of(request(1, 1));
    walk::require_posture(given_, walk::rollout_of(given_, searched, first_.walk_until_s));
    settings_ = settings();
  }

  LoopResult run() {
    const std::string file = in("loop.json");
    if (fs::exists(file)) {
      if (const std::string other = walk::difference(settings_in(file), settings_); !other.empty())
        throw DataError(file + ": of another loop: " + other +
                        "; expected the arguments that it began with, or another folder");
      read_triangle(file);
    } else {
      write_json();
    }
    if (begins_identified()) {
      exercise();
      write_news();
      identify(0);
      write_news();
      search(0);
    } else {
      write_once(walk_file(1), walk::format_walk(first_));
    }
    for (unsigned round = 1; result_.ended.empty(); ++round) {
      try_walk(round, model_of(round - 1));
      result_.walks = result_.rounds.back().walks;
      write_news();
      if (result_.walks || round > o_.rounds) break;
      if (o_.identify_by != IdentifyBy::none) identify(round);
      write_news();
      search(round);
    }
    write();
    return std::move(result_);
  }

 private:
  std::string in(const std::string& file) const { return o_.out + "/" + file; }
  static std::string folder(unsigned round) { return "round_" + std::to_string(round); }
  std::string walk_file(unsigned round) const { return in(folder(round) + "/walk.toml"); }
  std::string model_file(unsigned round) const { return in(folder(round) + "/identified_model.toml"); }
  /// Whether the first walk is searched about what the exercise tells.
  bool begins_identified() const { return o_.exercise_s > 0.0 && o_.identify_by == IdentifyBy::windows; }
  /// After which a model is identified and a walk searched.
  unsigned first_round() const { return begins_identified() ? 0 : 1; }
  bool identifies(unsigned round) const {
    return o_.identify_by != IdentifyBy::none && round >= first_round();
  }
  /// After a round.
  walk::Model model_of(unsigned round) const {
    return identifies(round) ? walk::read_model(model_file(round)) : given_;
  }
  walk::WalkMode mode() const { return o_.mode.value_or(first_.mode); }
  void say(unsigned round, const std::string& line) const {
    if (o_.say) o_.say("round " + std::to_string(round) + ": " + line);
  }
  Request request(unsigned round, unsigned repetition) const {
    return {o_.robot,
            walk_file(round),
            in(folder(round) + "/log_" + std::to_string(repetition) + ".csv"),
            round,
            repetition,
            o_.identify.window_s,
            [this, round](const std::string& line) { say(round, line); }};
  }

  /// Of the search after `round`, without `progress`.
  walk::SearchOptions search_options(unsigned round, const walk::Model& model, const walk::Walk& from) const {
    walk::SearchOptions out;
    out.rollout = walk::rollout_of(model, mode(), from.walk_until_s);
    out.seed = o_.seed + round - first_round();
    out.start = from.parameters;
    walk::EnsembleOptions ensemble = o_.ensemble;
    ensemble.seed = out.seed;
    out.ensemble = walk::drawn_robots(model.machine, mode(), ensemble);
    out.steps = o_.steps;
    out.threads = o_.threads;
    return out;
  }

  walk::Settings settings() const {
    walk::Settings out =
        walk::settings_of(given_, search_options(first_round(), given_, first_), "furcula walk loop");
    biped::Machine design;
    design.robot = given_.undeviated;
    out.emplace_back("the model's [deviations], as a hash",
                     text_hash(biped::format_deviations(design, given_.machine)));
    out.emplace_back("mode of the walk as given",
                     std::string(walk::kModeNames[static_cast<std::size_t>(first_.mode)]));
    if (begins_identified()) out.emplace_back("exercise_s", core::shortest(o_.exercise_s));
    out.emplace_back("steps", std::to_string(o_.steps));
    out.emplace_back("repetitions", std::to_string(o_.repetitions));
    if (o_.identify_by != IdentifyBy::windows)
      out.emplace_back("identify", std::string(kIdentifyByNames[static_cast<std::size_t>(o_.identify_by)]));
    out.emplace_back("window_s", core::shortest(o_.identify.window_s));
    out.emplace_back("iterations", std::to_string(o_.identify.iterations));
    return out;
  }

  void write_json() const {
    make_folder(o_.out);
    core::write_file_atomically(in("loop.json"), to_json_text(settings_, o_, result_));
  }
  void write() const {
    write_json();
    if (!result_.rounds.empty())
      core::write_file_atomically(in("report.html"), render_loop_report(given_.name, o_, result_));
  }
  void write_news() const {
    if (news_) write();
  }
  static void write_once(const std::string& file, const std::string& text) {
    if (fs::exists(file)) return;
    make_folder(fs::path(file).parent_path().string());
    core::write_file_atomically(file, text);
  }

  /// On the stand, with the posture of the walk as given and the pins of the mode that is searched.
  void exercise() {
    walk::Walk walk = first_;
    walk.exercise_s = o_.exercise_s;
    walk.mode = mode();
    write_once(walk_file(0), walk::format_walk(walk));
    const Request trial = request(0, 1);
    news_ = news_ || !fs::exists(trial.log);
    get_log(trial);
    floating::Recording recording = read_recording(trial.log, trial);
    recording.passive_hips = walk.mode == walk::WalkMode::semi_passive;
    result_.exercise = folder(0) + "/log_1.csv";
    say(0, result_.exercise + ": " +
               core::rounded(recording.rows.back().time_s - recording.rows.front().time_s, 3) +
               " s on the stand");
    exercise_ = std::move(recording);
  }

  void try_walk(unsigned round, const walk::Model& model) {
    const walk::Walk walk = walk::read_walk(walk_file(round));
    const walk::RolloutOptions rollout = walk::rollout_of(model, walk.mode, walk.walk_until_s);
    Round& r = result_.rounds.emplace_back();
    r.walk = folder(round) + "/walk.toml";
    r.simulated = walk::run_walk(model.robot, rollout, walk.parameters);
    r.asked_m = std::max(kLeastWay_m, kWayShare * r.simulated.distance_m);
    const std::string simulated = std::string("in simulation of the ") +
                                  (identifies(round - 1) ? "identified model: " : "model as given: ") +
                                  simulated_in_words(r.simulated, model.limits);
    if (round == first_round())
      say(round, simulated);
    else
      say(round - 1, "next: " + r.walk + ", " + simulated);
    for (unsigned k = 1; k <= o_.repetitions; ++k) {
      const Request trial = request(round, k);
      news_ = news_ || !fs::exists(trial.log);
      get_log(trial);
      floating::Recording recording = read_recording(trial.log, trial);
      recording.passive_hips = walk.mode == walk::WalkMode::semi_passive;
      TrialResult t{folder(round) + "/log_" + std::to_string(k) + ".csv",
                    outcome_of(recording, given_.machine, rollout.time_s), false};
      t.walks = t.outcome.stands && t.outcome.way_m >= r.asked_m;
      say(round, t.log + ": " + in_words(t.outcome, rollout.time_s));
      r.trials.push_back(std::move(t));
      recordings_.push_back(std::move(recording));
      predict(kGiven, given_, round, k, 0.0);
      if (identifies(round - 1)) predict(static_cast<int>(round) - 1, model, round, k, 0.5);
    }
    result_.last_trial = beside_simulation(given_, model.machine, whole_run(round, o_.repetitions));
    const auto walked =
        std::count_if(r.trials.begin(), r.trials.end(), [](const auto& t) { return t.walks; });
    r.walks = static_cast<double>(walked) >= kShare * static_cast<double>(r.trials.size());
    say(round, std::to_string(walked) + " of " + std::to_string(r.trials.size()) +
                   " trials stand and get at least " + core::rounded(r.asked_m, 3) + " m ahead");
  }

  void identify(unsigned round) {
    const std::string json = identification_file(round);
    if (!fs::exists(model_file(round))) {
      news_ = true;
      if (o_.identify_by == IdentifyBy::whole_run)
        fit_whole_walks(round);
      else
        fit_windows(round);
    }
    Identification& r = (round == 0 ? result_.of_exercise : result_.rounds.back().identification)
                            .emplace(read_identification(json));
    for (const NamedCause& c : r.causes)
      say(round, "cause: " + c.name + ", about " + core::rounded(c.deviation, 3) + " " + c.unit +
                     ", confidence " + core::rounded(c.confidence, 2));
    if (r.all_numbers_deviate) say(round, "the numbers of document 000's tables deviate all together");
    if (r.whole_run_rad)
      say(round, "model error (Eq. 3) over whole walks: " + core::rounded(1e3 * r.whole_run_rad->first, 3) +
                     " to " + core::rounded(1e3 * r.whole_run_rad->second, 3) + " mrad");
    say(round, errors_in_words(r.given, r.identified));
    const walk::Model model = walk::read_model(model_file(round));
    for (unsigned k = 0; k < round * o_.repetitions; ++k)
      predict(static_cast<int>(round), model, 1 + k / o_.repetitions, 1 + k % o_.repetitions,
              static_cast<double>(k) / (round * o_.repetitions));
  }

  std::string identification_file(unsigned round) const { return in(folder(round) + "/identification.json"); }

  /// Writes identification.json, .html and the model.
  void fit_windows(unsigned round) {
    floating::IdentifyOptions options = o_.identify;
    options.settings.threads = o_.threads;
    if (round > first_round()) options.start = walk::read_model(model_file(round - 1)).machine;
    options.progress = [&](double fraction, const std::string& doing) {
      if (o_.progress) o_.progress(fraction, "round " + std::to_string(round) + ": " + doing);
    };
    std::vector<floating::Recording> all = recordings_;
    if (exercise_) all.insert(all.begin(), *exercise_);
    const floating::Identified found = floating::identify(given_.machine, all, options);
    const std::vector<floating::Recording> held_out;
    std::string command = "furcula walk identify";
    for (const floating::Recording& r : all) command += " " + core::shell_word(r.file);
    command += " --model " + core::shell_word(o_.model) + " --out " + core::shell_word(in(folder(round)));
    core::write_files_together(std::vector<core::NewFile>{
        {identification_file(round), floating::to_json_text(found, nullptr, nullptr)},
        {in(folder(round) + "/identification.html"),
         floating::render_identification_report(
             {given_.name, &found, &all, &held_out, nullptr, nullptr, options.window_s, command})},
        {model_file(round), walk::format_model(given_, found.machine, in(folder(round)))}});
  }

  /// The walk of a round with the recording of a repetition.
  WholeRun whole_run(unsigned round, unsigned repetition) const {
    return {&recordings_[(round - 1) * o_.repetitions + repetition - 1], walk::read_walk(walk_file(round))};
  }

  /// Writes identification.json, without posterior and causes, and the model.
  void fit_whole_walks(unsigned round) {
    std::vector<WholeRun> runs;
    for (unsigned k = 0; k < round * o_.repetitions; ++k)
      runs.push_back(whole_run(1 + k / o_.repetitions, 1 + k % o_.repetitions));
    WholeRunOptions options;
    options.steps = o_.steps;
    options.seed = o_.seed + round - 1;
    options.threads = o_.threads;
    options.start = model_of(round - 1).machine;
    options.progress = [&](double fraction, const std::string& doing) {
      if (o_.progress) o_.progress(fraction, "round " + std::to_string(round) + ": " + doing);
    };
    const WholeRunFit found = fit_whole_runs(given_, runs, options);
    floating::IdentifyOptions windows = o_.identify;
    windows.settings.threads = o_.threads;
    core::write_files_together(std::vector<core::NewFile>{
        {identification_file(round),
         to_json_text(found, given_.machine, floating::window_errors(given_.machine, recordings_, windows),
                      floating::window_errors(found.machine, recordings_, windows))},
        {model_file(round), walk::format_model(given_, found.machine, in(folder(round)))}});
  }

  /// Of an earlier run. What is to be done again has no errors yet.
  void read_triangle(const std::string& file) {
    result_.triangle = triangle_in(file);
    const auto gone = std::erase_if(result_.triangle, [&](const auto& of) {
      const Cell& c = of.first;
      return !fs::exists(request(c.round, c.repetition).log) ||
             (c.model != kGiven && !fs::exists(model_file(static_cast<unsigned>(c.model))));
    });
    if (gone > 0) write_json();
  }

  /// A model's errors on a trial, unless they are there already.
  void predict(int number, const walk::Model& model, unsigned round, unsigned repetition, double fraction) {
    const Cell cell{number, round, repetition};
    if (result_.triangle.contains(cell)) return;
    const floating::Recording& recording = recordings_[(round - 1) * o_.repetitions + repetition - 1];
    if (o_.progress)
      o_.progress(fraction, "round " + std::to_string(result_.rounds.size()) + ": errors of the model " +
                                (number == kGiven ? "as given"
                                 : number == 0    ? "of the exercise"
                                                  : "of round " + std::to_string(number)) +
                                " on " + recording.file);
    floating::IdentifyOptions options = o_.identify;
    options.settings.threads = o_.threads;
    CellErrors errors{
        floating::window_errors(model.machine, {recording}, options),
        whole_run_errors_rad(given_, model.machine, {whole_run(round, repetition)}, o_.threads).front()};
    errors.windows.predicted.clear();
    result_.triangle.emplace(cell, std::move(errors));
    news_ = true;
    write();
  }

  /// Of the walks so far the one with which a search does best to begin: by its own objective.
  unsigned best_walk(unsigned last, const walk::Model& model, const walk::SearchOptions& options) const {
    const auto robots = options.ensemble.size();
    const double asked_s = options.rollout.time_s;
    std::vector<walk::Job> alone, others;
    const unsigned first = first_round();
    for (unsigned round = first; round <= last; ++round) {
      alone.push_back({round == 0 ? first_.parameters : walk::read_walk(walk_file(round)).parameters, 0});
      for (std::size_t k = 0; k < robots; ++k) others.push_back({alone.back().walk, k});
    }
    const auto on_robot = walk::run_jobs(model.robot, {}, options.rollout, alone, o_.threads),
               on_others = walk::run_jobs(model.robot, options.ensemble, options.rollout, others, o_.threads);
    std::size_t best = alone.size() - 1;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = alone.size(); i-- > 0;) {
      const walk::Rollout& own = on_robot[i];
      double value = own.value(asked_s);
      if (own.ending == walk::Ending::stands) {
        for (std::size_t k = 0; k < robots; ++k) value += on_others[i * robots + k].value(asked_s);
        value /= static_cast<double>(robots + 1);
      }
      if (value < least) best = i, least = value;
    }
    return first + static_cast<unsigned>(best);
  }

  void search(unsigned round) {
    if (fs::exists(walk_file(round + 1))) return;
    constexpr std::uint64_t kMost = 3;  // times the steps asked for
    const walk::Model model = model_of(round);
    walk::SearchOptions options =
        search_options(round, model, round == 0 ? first_ : walk::read_walk(walk_file(round)));
    walk::require_posture(model, options.rollout);
    const unsigned best_round = best_walk(round, model, options);
    const std::string from = best_round == 0 ? o_.walk : walk_file(best_round);
    options.start = best_round == 0 ? first_.parameters : walk::read_walk(from).parameters;
    options.progress = [&](double fraction, const std::string& doing) {
      if (o_.progress) o_.progress(fraction, "round " + std::to_string(round) + ": " + doing);
    };
    walk::Searched searched = walk::searched(model, options);
    for (std::uint64_t k = 2; k <= kMost && !searched.found.found; ++k) {
      options.from = searched.found.state;
      options.steps = k * o_.steps;
      searched = walk::searched(model, options);
    }
    const walk::Rollout& best = searched.found.rollout;
    if (best.ending != walk::Ending::stands) {
      result_.ended = "round " + std::to_string(round) + ": in " + std::to_string(*options.steps) +
                      " steps the search found no walk that stands in simulation of " + model.file + " (" +
                      simulated_in_words(best, model.limits) + "); expected more --steps, in another folder";
      return;
    }
    const std::string to = in(folder(round + 1));
    make_folder(to);
    core::write_files_together(walk::files_of(
        model, options, searched, to,
        "furcula walk search --model " + model.file + " --mode " +
            std::string(walk::kModeNames[static_cast<std::size_t>(mode())]) + " --seed " +
            std::to_string(options.seed) +
            (options.ensemble.empty() ? ""
                                      : " --robust --deviations " + core::shortest(o_.ensemble.deviations)) +
            " --from " + from + " --steps " + std::to_string(*options.steps) + " --out " + to));
  }

  const LoopOptions& o_;
  walk::Model given_;
  walk::Walk first_;
  walk::Settings settings_;
  std::optional<floating::Recording> exercise_;
  std::vector<floating::Recording> recordings_;  ///< of walks, as many as repetitions in each round
  LoopResult result_;
  bool news_ = false;  ///< a step was done: until then loop.json may have more than `result_`
};

}  // namespace

LoopResult run_loop(const LoopOptions& options) { return Loop(options).run(); }

}  // namespace furcula::loop
