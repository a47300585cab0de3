// `furcula excite`: set points of recordings that tell most, and what recordings will tell or do tell.
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/cli/within.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/error.hpp"
#include "host/excite/result.hpp"

namespace furcula::cli {
namespace {

struct ExciteOptions {
  std::string model, out, map;
  std::vector<std::string> limits, logs;
  excite::Options design;
  std::string criterion = "D", about = "all";
  unsigned threads = 0;
  bool accept_inertias = false;
};

/// Recordings that there are.
excite::Result of_logs(const ExciteOptions& o, unsigned threads) {
  std::vector<log::Log> logs;
  trees::TreeContext context{{}, {}, o.accept_inertias};
  for (const std::string& path : o.logs) {
    logs.push_back(read_log_of(path, "tree", o.map, o.design.window_s));
    if (!context.columns.empty()) continue;
    for (const auto& [name, values] : logs.back().columns) context.columns.push_back(name);
  }
  excite::Result out{*tree_model(o.model, context), {}, o.design, {}, {}, o.logs};
  with_notes(out.model, [&] {
    std::vector<trees::Recording> recordings;
    for (const log::Log& log : logs) recordings.push_back(trees::recording_of(out.model, log));
    const trees::Problem problem(out.model, recordings,
                                 trees::windows_of(out.model, recordings, o.design.window_s), threads);
    out.check = excite::check(out.model, excite::subjects(problem), recordings, o.design.window_s, threads);
  });
  return out;
}

excite::Result designed(const ExciteOptions& o, unsigned threads) {
  excite::Result out{*tree_model(o.model, {{}, {}, o.accept_inertias}), {}, o.design, {}, {}, {}};
  with_notes(out.model, [&] {
    std::vector<excite::Override> overrides;
    for (const std::string& text : o.limits) overrides.push_back(excite::parse_override(text));
    out.limits = excite::limits_of(out.model, overrides);
    Progress progress("designing");
    out.options.threads = threads;
    out.options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    out.design = excite::design(out.model, out.limits, out.options);
    progress.update(1.0, "checking");
    out.check = excite::check_of(out.model, out.design, out.options);
  });
  return out;
}

void run(ExciteOptions& o) {
  if (!is_tree_model(o.model))
    throw UsageError("--model " + o.model +
                     " is a machine of one joint; expected kind = \"tree\", a URDF or an MJCF");
  if (o.logs.empty() && o.out.empty())
    throw UsageError("nothing to do; expected --out DIR for set points, or --check LOG...");
  const unsigned threads = o.threads > 0 ? o.threads : std::max(1U, std::thread::hardware_concurrency());
  o.design.criterion = o.criterion == "D" ? excite::Criterion::d : excite::Criterion::a;
  o.design.about = o.about == "all"    ? excite::About::all
                   : o.about == "free" ? excite::About::free
                                       : excite::About::causes;
  std::optional<OutFolder> folder;
  if (!o.out.empty()) folder.emplace(o.out);
  const excite::Result found = o.logs.empty() ? designed(o, threads) : of_logs(o, threads);
  if (folder) core::write_files_together(excite::files(found, o.out));
  std::fputs(excite::summary(found).c_str(), stdout);
}

}  // namespace

void add_excite_command(CLI::App& app) {
  const auto o = std::make_shared<ExciteOptions>();
  CLI::App* command = app.add_subcommand(
      "excite", "Design recordings of a robot of several joints that tell most about its model");
  command->add_option("--model", o->model, "Model file (TOML) of kind tree, or a robot (URDF, MJCF)")
      ->required();
  command->add_option("--out", o->out, "Folder for set points, scenarios and excitation.json");
  command->add_option("--duration-s", o->design.duration_s, "Length of a recording, s")
      ->check(within(0.1, 600.0))
      ->capture_default_str();
  command->add_option("--recordings", o->design.recordings, "How many")
      ->check(CLI::Range(std::size_t{1}, std::size_t{50}))
      ->capture_default_str();
  command->add_option("--rate-hz", o->design.rate_hz, "Set points a second")
      ->check(within(20.0, 10000.0))
      ->capture_default_str();
  command->add_option("--highest-hz", o->design.highest_hz, "Highest frequency of the motions, Hz")
      ->check(within(0.2, 50.0))
      ->capture_default_str();
  command
      ->add_option(
          "--limit", o->limits,
          "JOINT.KEY=NUMBER in place of the URDF's limit; KEY is lower, upper, velocity or effort, JOINT a joint or all")
      ->allow_extra_args(false);
  command->add_option("--for", o->about, "What the motions are for: all, free ([free] alone) or causes")
      ->check(CLI::IsMember({"all", "free", "causes"}))
      ->capture_default_str();
  command->add_option("--criterion", o->criterion, "D (determinant) or A (trace) of the covariance")
      ->check(CLI::IsMember({"D", "A"}))
      ->capture_default_str();
  command->add_option("--evaluations", o->design.evaluations, "Motions that are tried for each recording")
      ->check(CLI::Range(std::size_t{20}, std::size_t{100000}))
      ->capture_default_str();
  command->add_option("--window-s", o->design.window_s, "Length of a free run, s, as in furcula identify")
      ->check(within(0.05, 10.0))
      ->capture_default_str();
  command->add_option("--seed", o->design.seed, "Seed of the search and of the simulated noise")
      ->capture_default_str();
  command->add_option("--threads", o->threads, "Threads; without it as many as the machine has");
  command->add_option("--check", o->logs, "Say what these logs tell, and design none");
  command->add_option("--map", o->map, "Map file (TOML) of the logs");
  command->add_flag("--accept-inertias", o->accept_inertias, kAcceptInertias);
  command->callback([o] { run(*o); });
}

}  // namespace furcula::cli
