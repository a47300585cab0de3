// `furcula walk loop`: the model identified from recordings, a walk searched about it and tried, until the robot walks.
#include "host/cli/walk_loop_command.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "furcula/control/walk/exercise.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/message.hpp"
#include "host/loop/loop.hpp"

namespace furcula::cli {
namespace {

struct WalkLoopOptions {
  loop::LoopOptions loop;
  std::string mode, identify = std::string(loop::kIdentifyByNames.front());
  std::int64_t rounds = 3, repetitions = 1, steps = 200'000'000, robots = walk::EnsembleOptions{}.robots;
};

void require_from(const char* option, std::int64_t value, std::int64_t least, std::int64_t most) {
  if (value < least || value > most)
    throw UsageError(std::string(option) + " " + std::to_string(value) + ": expected from " +
                     std::to_string(least) + " to " + std::to_string(most));
}

void run(const WalkLoopOptions& o) {
  require_from("--rounds", o.rounds, 1, 1000);
  require_from("--repetitions", o.repetitions, 1, 1000);
  require_from("--steps", o.steps, 1, 1'000'000'000'000);
  require_from("--threads", o.loop.threads, 0, 1024);
  require_from("--robots", o.robots, 0, 1000);
  if (!(o.loop.ensemble.deviations >= 0.0 && o.loop.ensemble.deviations <= 2.0))
    throw UsageError("--deviations " + core::shortest(o.loop.ensemble.deviations) + ": expected from 0 to 2");
  if (const double s = o.loop.exercise_s;
      s != 0.0 && !(s >= control::kLeastExercise_s && s <= control::kMostExercise_s))
    throw UsageError("--exercise-s " + core::shortest(s) + ": expected 0, or from " +
                     core::shortest(control::kLeastExercise_s) + " to " +
                     core::shortest(control::kMostExercise_s));
  loop::LoopOptions options = o.loop;
  options.rounds = static_cast<unsigned>(o.rounds);
  options.repetitions = static_cast<unsigned>(o.repetitions);
  options.steps = static_cast<std::uint64_t>(o.steps);
  options.ensemble.robots = static_cast<std::size_t>(o.robots);
  const auto by = std::find(loop::kIdentifyByNames.begin(), loop::kIdentifyByNames.end(), o.identify);
  options.identify_by = static_cast<loop::IdentifyBy>(by - loop::kIdentifyByNames.begin());
  if (options.threads == 0) options.threads = std::max(1u, std::thread::hardware_concurrency());
  if (!o.mode.empty())
    options.mode = o.mode == walk::kModeNames[0] ? walk::WalkMode::active : walk::WalkMode::semi_passive;
  const OutFolder folder(options.out);
  std::optional<Progress> bar;  // of a step that takes a while; gone while anything is printed
  options.progress = [&](double fraction, const std::string& doing) {
    if (!bar) bar.emplace("walk loop");
    bar->update(fraction, doing);
  };
  options.say = [&](const std::string& line) {
    bar.reset();
    std::printf("%s\n", core::printable(line).c_str());
    std::fflush(stdout);
  };
  const loop::LoopResult found = loop::run_loop(options);
  bar.reset();
  if (!found.ended.empty()) throw Refusal(found.ended);
  const std::string last = options.out + "/" + found.rounds.back().walk;
  if (!found.walks)
    throw Refusal("after " + std::to_string(options.rounds) + (options.rounds == 1 ? " round" : " rounds") +
                  " the robot does not walk with " + last + "; the same command with more --rounds goes on");
  std::printf("the robot walks with %s\n", core::printable(last).c_str());
}

}  // namespace

void add_walk_loop_command(CLI::App& walk) {
  auto o = std::make_shared<WalkLoopOptions>();
  o->loop.threads = 0;
  CLI::App* command = walk.add_subcommand(
      "loop",
      "The model identified from the robot's recordings, a walk searched about it and tried: until the robot walks");
  command->add_option("--model", o->loop.model, "Model file of kind biped")->required();
  command->add_option("--walk", o->loop.walk, "walk.toml to begin with")->required();
  command
      ->add_option(
          "--robot", o->loop.robot,
          "Command of a trial: {walk} stands for the walk's file, {log} for the log (CSV) that it writes, "
          "{repetition} and {round} for numbers (round 0: on the stand); status 0 after every trial, also of a fall. "
          "manual: a person brings the files")
      ->required();
  command
      ->add_option(
          "--rounds", o->rounds,
          "Trial, identification and search, so many times at most; the last walk is tried too. Round 0 is not counted")
      ->capture_default_str();
  command
      ->add_option(
          "--exercise-s", o->loop.exercise_s,
          "With --identify windows the robot moves its legs on its stand for so long first (round 0), and the first walk is "
          "searched about what is identified from it; 0: it does not, and the first walk is --walk")
      ->capture_default_str();
  command->add_option("--repetitions", o->repetitions, "Trials of a walk")->capture_default_str();
  command->add_option("--steps", o->steps, "Of a search, in steps of simulation")->capture_default_str();
  command
      ->add_option(
          "--deviations", o->loop.ensemble.deviations,
          "How far the other robots of a search, which is robust, are from the identified one: times the ranges of "
          "document 000, Tables I and II")
      ->capture_default_str();
  command->add_option("--robots", o->robots, "Other robots of a search; 0: the identified one alone")
      ->capture_default_str();
  command
      ->add_option(
          "--identify", o->identify,
          "windows: all numbers with priors, causes named; whole_run: document 000's way, an evolutionary search "
          "for the least error of whole walks; none: each walk is searched about the model as given")
      ->check(CLI::IsMember(
          std::vector<std::string>(loop::kIdentifyByNames.begin(), loop::kIdentifyByNames.end())))
      ->capture_default_str();
  command->add_option("--mode", o->mode, "Of the walks that are searched; without it that of --walk")
      ->check(CLI::IsMember(std::vector<std::string>{std::string(furcula::walk::kModeNames[0]),
                                                     std::string(furcula::walk::kModeNames[1])}));
  command->add_option("--seed", o->loop.seed, "Of the first search; each later one has the next")
      ->capture_default_str();
  command->add_option("--threads", o->loop.threads, "Without it as many as processors");
  command
      ->add_option("--out", o->loop.out,
                   "Folder of the loop; one that was interrupted goes on after its last finished step")
      ->required();
  command->callback([o] { run(*o); });
}

}  // namespace furcula::cli
