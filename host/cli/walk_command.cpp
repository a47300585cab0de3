// `furcula walk`: walks of the biped, found without a first guess, and simulated.
#include "host/cli/walk_command.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/own_build.hpp"
#include "host/log/writer.hpp"
#include "host/walk/checkpoint.hpp"
#include "host/walk/ensemble.hpp"
#include "host/walk/exercise.hpp"
#include "host/walk/searched.hpp"
#include "host/walk/simulation.hpp"
#include "host/walk/walk_file.hpp"
#include "host/walk/walk_report.hpp"

namespace furcula::cli {
namespace {

struct WalkOptions {
  std::string model, out, mode, method, walk, resume, from;
  std::optional<double> seconds;
  std::optional<std::int64_t> steps;
  std::optional<std::uint64_t> sensor_seed;
  double rate_hz = 100.0;
  unsigned threads = 0;
  std::uint64_t seed = 1;
  bool robust = false;
  double deviations = walk::EnsembleOptions{}.deviations;
  CommentsOption comments;

  unsigned thread_count() const {
    return threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
  }
};

void say(const walk::Rollout& r, const walk::WalkLimits& limits) {
  if (r.ending == walk::Ending::stands) {
    std::printf("stands after %.3g s and %u landings, %.3f m ahead", r.time_s, r.landings, r.distance_m);
    if (std::isfinite(r.cot)) std::printf("; cost of transport %.3f", r.cot);
    std::printf("\n%.0f J: copper %.0f, work %.0f (its positive parts %.0f), constant %.0f\n", r.energy_j(),
                r.copper_j, r.work_j, r.positive_work_j, r.constant_j);
  }
  for (const std::string& limit : walk::broken_limits(r, limits)) std::printf("limit: %s\n", limit.c_str());
}

constexpr const char* kCheckpoint = "/search.checkpoint";

volatile std::sig_atomic_t search_interrupted = 0;

/// The first one ends a search in order, the second one at once. One that is ignored (nohup) stays so.
void heed_signals() {
  const auto heard = [](int signal) {
    search_interrupted = 1;
    std::signal(signal, SIG_DFL);
  };
  for (const int signal : {SIGINT, SIGTERM, SIGHUP})
    if (std::signal(signal, heard) == SIG_IGN) std::signal(signal, SIG_IGN);
}

template <std::size_t N>
std::size_t place_of(const std::string& name, const std::array<std::string_view, N>& names) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

/// Where a search goes on.
walk::SearchState state_of(const WalkOptions& o, const walk::Settings& settings) {
  walk::FoundCheckpoint found = walk::read_checkpoint(o.resume);
  if (!found.note.empty()) std::fprintf(stderr, "furcula: %s\n", core::printable(found.note).c_str());
  if (const std::string other = walk::difference(found.checkpoint.settings, settings); !other.empty())
    throw UsageError("--resume " + found.file + ": of another search: " + other);
  if (found.checkpoint.build != core::own_build_id())
    std::fprintf(
        stderr,
        "furcula: %s: written by another build of furcula; the search goes on, and need not give what one without an "
        "interruption gives\n",
        core::printable(found.file).c_str());
  std::fprintf(stderr, "furcula: goes on after %.1f million steps\n",
               1e-6 * static_cast<double>(found.checkpoint.state.steps));
  return std::move(found.checkpoint.state);
}

/// The walk that an option names, which has to be the model's robot's.
walk::Walk walk_of(const char* option, const std::string& file, const WalkOptions& o,
                   const walk::Model& model) {
  walk::Walk walk = walk::read_walk(file);
  if (walk.robot != model.name)
    throw UsageError(option + (" " + core::printable(file)) + ": a walk of " + core::quoted(walk.robot) +
                     "; expected one of " + core::quoted(model.name) + ", the robot of " +
                     core::printable(o.model));
  return walk;
}

void say_evidence(const walk::Robustness& robustness) {
  std::printf("with steps of 1 to 0.125 ms: cost of transport");
  for (const walk::Trial& t : robustness.steps) std::printf(" %.4g", t.rollout.cot);
  std::printf("\nwith sensor errors: %u of %u stand, %u keep all limits\n", robustness.noisy_stand,
              robustness.noisy, robustness.noisy_keep_limits);
  std::printf("on other robots, drawn and pushed: %u of %u stand\n", robustness.drawn_stand,
              robustness.drawn);
  if (const walk::ReturnMap& map = robustness.map; map.found)
    std::printf(
        "walking on: a stride of %.4g s and %.4g m, cost of transport %.3f, largest Floquet multiplier %.3f\n",
        map.stride_s, map.stride_m, map.cot, map.multipliers.front());
  else
    std::printf("walking on: %s\n", map.none.c_str());
  for (const walk::Trial& t : robustness.changed)
    std::printf("%s: %s\n", t.what.c_str(),
                t.rollout.over > 0.0 && t.rollout.ending == walk::Ending::stands
                    ? "stands, beyond a limit"
                    : std::string(walk::kEndingNames[static_cast<std::size_t>(t.rollout.ending)]).c_str());
}

void search(const WalkOptions& o, const Distribute& distribute) {
  if (o.seconds.has_value() == o.steps.has_value()) throw UsageError("expected one of --seconds and --steps");
  if (o.seconds && !(*o.seconds > 0.0 && *o.seconds <= 1e6))
    throw UsageError("--seconds " + core::shortest(*o.seconds) +
                     ": expected more than 0 and at most 1000000");
  if (o.steps && *o.steps < 1)
    throw UsageError("--steps " + std::to_string(*o.steps) + ": expected at least 1");
  if (!(o.deviations >= 0.0 && o.deviations <= 2.0))
    throw UsageError("--deviations " + core::shortest(o.deviations) + ": expected from 0 to 2");
  if (o.threads > 1024)
    throw UsageError("--threads " + std::to_string(o.threads) + ": expected at most 1024");
  const walk::Model model = walk::read_model(o.model);
  walk::SearchOptions options;
  options.rollout =
      walk::rollout_of(model, static_cast<walk::WalkMode>(place_of(o.mode, walk::kModeNames)), 5.0);
  options.method = static_cast<walk::MethodKind>(place_of(o.method, walk::kMethodNames));
  options.seed = o.seed;
  options.seconds = o.seconds;
  if (o.steps) options.steps = static_cast<std::uint64_t>(*o.steps);
  if (!o.from.empty()) options.start = walk_of("--from", o.from, o, model).parameters;
  options.threads = o.thread_count();
  walk::require_posture(model, options.rollout);
  if (o.robust)
    options.ensemble =
        walk::drawn_robots(model.machine, options.rollout.mode, {.deviations = o.deviations, .seed = o.seed});
  const walk::Settings settings = walk::settings_of(model, options, "furcula " FURCULA_VERSION);
  if (!o.resume.empty()) options.from = state_of(o, settings);

  const OutFolder folder(o.out);
  const std::string checkpoint = o.out + kCheckpoint;
  std::string not_kept;
  options.keep = [&](const walk::SearchState& state) {
    // A disk that is full for a while is no reason to lose the search.
    try {
      walk::write_checkpoint({settings, core::own_build_id(), state}, checkpoint);
      not_kept.clear();
    } catch (const core::OutputError& e) {
      not_kept = e.what();
    }
  };
  heed_signals();
  options.interrupted = [] { return search_interrupted != 0; };
  if (distribute) distribute(model.robot, options);
  walk::Searched searched;
  {
    Progress progress("walk");
    options.progress = [&](double fraction, const std::string& doing) { progress.update(fraction, doing); };
    searched = walk::searched(model, options);
  }
  const walk::SearchResult& found = searched.found;
  if (!not_kept.empty()) throw core::OutputError(not_kept);
  const std::string command =
      "furcula walk search --model " + o.model + " --mode " + o.mode + " --method " + o.method + " --seed " +
      std::to_string(o.seed) + (o.robust ? " --robust --deviations " + core::shortest(o.deviations) : "") +
      (o.from.empty() ? "" : " --from " + o.from) +
      (o.steps ? " --steps " + std::to_string(*o.steps) : " --seconds " + core::shortest(*o.seconds)) +
      " --out " + o.out;
  const walk::SearchState& end = found.state;
  core::write_files_together(walk::files_of(model, options, searched, o.out, command));
  if (end.first_walk)
    std::printf("first walk of 10 s within all limits after %.1f s of one processor, %llu walks tried\n",
                end.first_walk->cpu_s, static_cast<unsigned long long>(end.first_walk->rollouts));
  say(found.rollout, model.limits);
  if (searched.robustness) say_evidence(*searched.robustness);
  if (end.not_finite > 0)
    std::printf("%llu of %llu walks had an objective that is no number, and were left out\n",
                static_cast<unsigned long long>(end.not_finite),
                static_cast<unsigned long long>(end.rollouts));
  std::printf(
      "%.1f million steps in %.1f s of one processor, %.2f million a second; report: %s/report.html\n",
      1e-6 * static_cast<double>(end.steps), end.cpu_s, 1e-6 * static_cast<double>(end.steps) / end.cpu_s,
      core::printable(o.out).c_str());
  if (found.interrupted)
    std::printf("interrupted; the same command with --resume %s goes on\n",
                core::printable(checkpoint).c_str());
  if (!found.found)
    throw Refusal(std::string("no walk within all limits that gets ahead was found ") +
                  (found.interrupted ? "before the interruption" : "in this budget") +
                  "; walk.toml has what came nearest. Expected: more --seconds or --steps (with --resume " +
                  checkpoint + "), or wider [limits]");
}

void show(const WalkOptions& o) {
  const walk::Model model = walk::read_model(o.model);
  const walk::Walk walk = walk_of("--walk", o.walk, o, model);
  walk::require_steps(walk, o.walk);
  const OutFolder folder(o.out);
  const walk::RolloutOptions rollout = walk::rollout_of(model, walk.mode, walk.walk_until_s);
  const walk::Rollout r = walk::run_walk(model.robot, rollout, walk.parameters);
  walk::Robustness robustness;
  {
    Progress progress("walk");
    robustness = walk::robustness_of(
        model.robot, rollout, walk.parameters, walk::unseen_robots(model, walk.mode), o.thread_count(),
        [&](double fraction) { progress.update(fraction, "the walk again, with errors"); });
  }
  core::write_files_together(std::vector<core::NewFile>{
      {o.out + "/report.html", walk::render_walk_report(model, rollout, walk.parameters, r, {}, robustness,
                                                        "furcula walk show --model " + o.model + " --walk " +
                                                            o.walk + " --out " + o.out)}});
  say(r, model.limits);
  std::printf("report: %s/report.html\n", core::printable(o.out).c_str());
}

void simulate(const WalkOptions& o) {
  const double seconds = o.seconds.value_or(10.0);
  if (!(seconds >= 1.0 && seconds <= 1e4))
    throw UsageError("--seconds " + core::shortest(seconds) + ": expected from 1 to 10000");
  constexpr double kController_hz = 1000.0;
  const double ticks = kController_hz / o.rate_hz;
  if (!(o.rate_hz >= 1.0 && o.rate_hz <= kController_hz && std::abs(ticks - std::round(ticks)) < 1e-9))
    throw UsageError("--rate-hz " + core::shortest(o.rate_hz) +
                     ": expected from 1 to 1000, the controller's rate, and a whole part of it");
  std::error_code none;
  if (std::filesystem::equivalent(o.out, o.walk, none))
    throw UsageError("--out " + core::printable(o.out) + " is the walk; expected another file");
  const walk::Model model = walk::read_model(o.model);
  const walk::Walk walk = walk_of("--walk", o.walk, o, model);
  if (walk.exercise_s > 0.0) {
    if (o.seconds)
      throw UsageError("--seconds: not of an exercise, whose time is exercise_s of " +
                       core::printable(o.walk));
    log::write_log(
        walk::simulate_exercise(model.robot, walk,
                                walk::rollout_of(model, walk.mode, walk.walk_until_s).command_delay_s,
                                1.0 / o.rate_hz, o.sensor_seed),
        o.out, o.comments.of_log());
    std::printf("an exercise of %.3g s on the stand\n", walk.exercise_s);
    return;
  }
  // A longer run walks longer, and has as long to stand.
  walk::RolloutOptions rollout = walk::rollout_of(model, walk.mode, walk.walk_until_s);
  rollout.walk_until_s = std::max(walk.walk_until_s, seconds - (rollout.time_s - walk.walk_until_s));
  rollout.time_s = seconds;
  const walk::Simulation s =
      walk::simulate_walk(model.robot, rollout, walk.parameters, 1.0 / o.rate_hz, o.sensor_seed);
  log::write_log(s.log, o.out, o.comments.of_log());
  say(s.rollout, model.limits);
  if (s.rollout.ending != walk::Ending::stands) throw Refusal("the robot does not stand; the log ends there");
}

}  // namespace

CLI::App* add_walk_command(CLI::App& app) { return add_walk_command(app, {}); }

CLI::App* add_walk_command(CLI::App& app, Distribute distribute) {
  auto o = std::make_shared<WalkOptions>();
  if (distribute) o->threads = 1;
  o->mode = walk::kModeNames.front();
  o->method = walk::kMethodNames.front();
  CLI::App* command =
      app.add_subcommand("walk", "Walks of the biped: found without a first guess, and simulated");
  command->require_subcommand(1);
  CLI::App* find =
      command->add_subcommand("search", "The walk that costs least, from a robot that only steps and falls");
  find->add_option("--model", o->model, "Model file of kind biped")->required();
  find->add_option(
          "--mode", o->mode,
          "active; semi_passive: both hips' pitch on their springs; knee_passive: the swing leg's knee swings free; "
          "knee_braked: the stance leg's knee is held by its brake")
      ->check(CLI::IsMember(std::vector<std::string>(walk::kModeNames.begin(), walk::kModeNames.end())))
      ->capture_default_str();
  find->add_option("--method", o->method,
                   "How it is sought: CMA-ES, ESCH of NLopt, or mutation and Nelder-Mead in turns")
      ->check(CLI::IsMember(std::vector<std::string>(walk::kMethodNames.begin(), walk::kMethodNames.end())))
      ->capture_default_str();
  find->add_flag(
      "--robust", o->robust,
      "A walk that stands on 7 other robots, too, which are drawn and pushed: it costs more, and falls less on a real one");
  find->add_option(
          "--deviations", o->deviations,
          "With --robust: how far these are from the model, times the ranges of document 000, Tables I and II")
      ->capture_default_str();
  find->add_option("--seed", o->seed, "Of the search")->capture_default_str();
  find->add_option("--seconds", o->seconds, "How long");
  find->add_option("--steps", o->steps,
                   "How long, in steps of simulation: one seed then gives one walk, whatever --threads");
  find->add_option("--threads", o->threads,
                   distribute ? "Of each process; without it 1" : "Without it as many as processors");
  find->add_option(
      "--from", o->from,
      "Begins with this walk.toml of the same robot, of any mode, in place of steps on the spot");
  find->add_option(
      "--resume", o->resume,
      "Goes on from a checkpoint, DIR/search.checkpoint, of the same search; its budget is the whole one's");
  find->add_option(
          "--out", o->out,
          "Folder for walk.toml, walk.json, report.html and search.checkpoint, which is written every 10 s and at the end, "
          "on SIGINT (Ctrl-C) and SIGTERM too")
      ->required();
  find->callback([o, distribute = std::move(distribute)] { search(*o, distribute); });

  CLI::App* run = command->add_subcommand("sim", "A walk as a log");
  run->add_option("--model", o->model, "Model file of kind biped")->required();
  run->add_option("--walk", o->walk, "walk.toml")->required();
  run->add_option("--seconds", o->seconds, "How long; without it 10. A longer run walks longer");
  run->add_option("--rate-hz", o->rate_hz, "Of the log's rows")->capture_default_str();
  run->add_option("--seed", o->sensor_seed, "Sensors err, drawn from it; without it they do not");
  run->add_option("--out", o->out, "The log (CSV)")->required();
  o->comments.add_to(*run);
  run->callback([o] { simulate(*o); });

  CLI::App* page = command->add_subcommand("show", "A walk as a page, with the robot walking");
  page->add_option("--model", o->model, "Model file of kind biped")->required();
  page->add_option("--walk", o->walk, "walk.toml")->required();
  page->add_option("--threads", o->threads, "Without it as many as processors");
  page->add_option("--out", o->out, "Folder for report.html")->required();
  page->callback([o] { show(*o); });
  return command;
}

}  // namespace furcula::cli
