// `furcula safety`: the page of what breaks, random faults in random experiments, and the faults of the page
// on a board's own program.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/rig_options.hpp"
#include "host/core/atomic_file.hpp"
#include "host/rig/fault_trials.hpp"
#include "host/safety/document.hpp"
#include "host/safety/hil_ticks.hpp"
#include "host/safety/injection.hpp"

namespace furcula::cli {
namespace {

struct SafetyOptions {
  std::uint64_t runs = 2000, seed = 1;
  std::optional<std::uint64_t> only;
  unsigned threads = 0;
};

void inject_one(std::uint64_t seed, std::uint64_t number) {
  const safety::Injection injection = safety::draw_injection(seed, number);
  const safety::Trial trial = safety::run(safety::robot(), injection);
  std::cout << safety::format_run(injection, trial);
  if (trial.unsafe != 0 || trial.false_alarm)
    throw Refusal("experiment " + std::to_string(number) + " was unsafe or a false alarm");
}

void inject(const SafetyOptions& o) {
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

struct HilOptions {
  rig::RigOptions rig;
  std::string out;
  std::vector<std::string> only;
  bool one_moment = false;
};

std::string ticks_or_dash(std::optional<std::uint32_t> ticks) { return ticks ? std::to_string(*ticks) : "-"; }

/// A row a line: ticks at each moment that was tried, and what is not as it must be.
std::string describe(const safety::RigRow& row, const std::vector<rig::FaultTrial>& trials) {
  char cell[64];
  std::string line, reasons;
  const auto put = [&](const char* format, const auto&... values) {
    std::snprintf(cell, sizeof cell, format, values...);
    line += cell;
  };
  const std::string allowed =
      row.is_borne() ? "-" : std::to_string(row.found_within_ticks + rig::kSeenLaterTicks);
  put("%-20s%8s%6s", std::string(sim_host::info(row.breaks).name).c_str(), allowed.c_str(),
      ticks_or_dash(safety::hil_ticks(row.breaks)).c_str());
  for (std::size_t m = 0; m < safety::kMoments.size(); ++m) {
    const auto at = std::find_if(trials.begin(), trials.end(), [m](const rig::FaultTrial& t) {
      return t.moment == static_cast<safety::Moment>(m);
    });
    put("%17s", at == trials.end() ? "" : ticks_or_dash(at->told_off_ticks).c_str());
  }
  for (const rig::FaultTrial& trial : trials) {
    if (!trial.broken_limit.empty())
      reasons += "  " + std::string(safety::kMoments[static_cast<std::size_t>(trial.moment)]) + ": " +
                 trial.broken_limit + "\n";
  }
  return line + "\n" + reasons;
}

void try_on_board(HilOptions& options) {
  for (const std::string& name : options.only)
    if (!sim_host::rig_fault_named(name)) throw UsageError("there is no fault '" + name + "'");
  options.rig.configuration_path = options.out + ".furculad.toml";
  std::ofstream table(options.out);
  if (!table) throw core::OutputError(options.out + ": cannot be written");
  table
      << "what breaks          allowed  page           flight           stance  released flight            catch\n";
  unsigned broken = 0;
  std::size_t tried = 0;
  for (const safety::RigRow& row : safety::rig_rows()) {
    const std::string name(sim_host::info(row.breaks).name);
    if (!options.only.empty() &&
        std::find(options.only.begin(), options.only.end(), name) == options.only.end())
      continue;
    if (!safety::tried_on_hil(row.breaks)) continue;
    std::vector<safety::Moment> moments;
    for (std::size_t m = 0; m < safety::kMoments.size(); ++m)
      if (!options.one_moment || m == tried % safety::kMoments.size())
        moments.push_back(static_cast<safety::Moment>(m));
    ++tried;
    const std::vector<rig::FaultTrial> trials = rig::try_on_board(row, moments, options.rig);
    table << describe(row, trials) << std::flush;
    for (const rig::FaultTrial& trial : trials)
      if (!trial.broken_limit.empty()) ++broken;
  }
  if (broken != 0) throw Refusal(std::to_string(broken) + " trials broke the limits of docs/safety.md");
}

}  // namespace

void add_safety_command(CLI::App& app) {
  const auto options = std::make_shared<SafetyOptions>();
  CLI::App* group = app.add_subcommand("safety", "What breaks, what the robot does then, and random faults");
  group->require_subcommand(1);
  group->add_subcommand("docs", "Print docs/safety.md (some seconds)")->callback([] {
    std::cout << safety::to_markdown();
  });
  const auto hil = std::make_shared<HilOptions>();
  CLI::App* on_board = group->add_subcommand(
      "hil", "Each fault of the table in a mocked robot against a board's own program (docs/hil.md)");
  on_board->add_option("--only", hil->only, "These faults alone")->delimiter(',');
  on_board->add_flag("--one-moment", hil->one_moment,
                     "Each fault at one moment of the stride, the moments in turn");
  on_board->add_option("--out", hil->out, "The table to write, as text")->required();
  add_rig_options(*on_board, hil->rig);
  on_board->callback([hil] {
    try {
      try_on_board(*hil);
    } catch (const rig::RigError& e) {
      throw Refusal(e.what());
    }
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
