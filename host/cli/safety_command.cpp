// `furcula safety`: the page of what breaks, and random faults in random experiments.
#include <algorithm>
#include <cstdint>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/safety/document.hpp"
#include "host/safety/injection.hpp"

namespace furcula::cli {
namespace {

struct Options {
  std::uint64_t runs = 2000, seed = 1;
  std::optional<std::uint64_t> only;
  unsigned threads = 0;
};

void inject_one(std::uint64_t seed, std::uint64_t number) {
  const safety::Injection injection = safety::draw_injection(seed, number);
  const safety::Trial trial =
      safety::run_trial(safety::robot(), injection.scenario, injection.seed, injection.rig);
  std::cout << safety::format_run(injection, trial);
  if (trial.unsafe != 0 || trial.false_alarm)
    throw Refusal("experiment " + std::to_string(number) + " was unsafe or a false alarm");
}

void inject(const Options& o) {
  if (o.only) return inject_one(o.seed, *o.only);
  const unsigned threads = o.threads == 0 ? std::max(1u, std::thread::hardware_concurrency()) : o.threads;
  const safety::Tally tally = safety::inject(o.seed, o.runs, threads);
  std::cout << safety::format_tally(tally);
  if (tally.unsafe.empty()) return;
  std::string numbers;
  for (std::size_t i = 0; i < tally.unsafe.size() && i < 10; ++i)
    numbers += (i == 0 ? "" : ", ") + std::to_string(tally.unsafe[i].number);
  throw Refusal(std::to_string(tally.unsafe.size()) + " of " + std::to_string(o.runs) +
                " runs were unsafe or a false alarm; the first have the numbers " + numbers);
}

}  // namespace

void add_safety_command(CLI::App& app) {
  const auto options = std::make_shared<Options>();
  CLI::App* group = app.add_subcommand("safety", "What breaks, what the robot does then, and random faults");
  group->require_subcommand(1);
  group->add_subcommand("docs", "Print docs/safety.md (some seconds)")->callback([] {
    std::cout << safety::to_markdown();
  });
  CLI::App* injection = group->add_subcommand("inject", "Random faults in random experiments");
  injection->add_option("--runs", options->runs, "Experiments")->check(CLI::Range(1, 10000000));
  injection->add_option("--seed", options->seed, "Seed of the experiments");
  injection->add_option("--threads", options->threads, "Threads; 0: one for each processor")
      ->check(CLI::Range(0, 256));
  injection->add_option("--only", options->only, "Only the experiment of this number, and what was drawn");
  injection->callback([options] { inject(*options); });
}

}  // namespace furcula::cli
