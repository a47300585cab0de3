// `furcula reproduce`: a source document's figures, computed anew.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/commands.hpp"
#include "host/core/message.hpp"
#include "host/report/html.hpp"
#include "host/reproduce/reproduction.hpp"
#include "host/reproduce/reproduction_000.hpp"
#include "host/reproduce/reproduction_001.hpp"
#include "host/reproduce/reproduction_json.hpp"
#include "host/reproduce/reproduction_report.hpp"
#include "host/walk/walk_report.hpp"

namespace furcula::cli {
namespace {

struct ReproduceOptions {
  unsigned starts = 3;  ///< of each gait of 001
  std::string document, out;
  std::string model;                      ///< of 000's robot
  std::vector<std::string> walks, loops;  ///< of 000
  std::uint64_t steps = 300'000'000, case_steps = 30'000'000;
  reproduce::Options study;
};

void print_rows(std::initializer_list<const std::vector<reproduce::Row>*> tables) {
  using reproduce::Outcome;
  std::printf("%-18s %-82s %-32s %11s %-7s\n", "where", "what", "printed", "here", "unit");
  for (const auto* rows : tables)
    for (const reproduce::Row& row : *rows) {
      const std::string ours = std::isfinite(row.ours) ? report::number(row.ours, 4) : "none";
      std::printf("%-18s %-82s %-32s %11s %-7s %s\n", row.where.c_str(), row.what.c_str(),
                  row.published.c_str(), ours.c_str(), row.unit.c_str(), reproduce::name(row.outcome));
      if (row.outcome == Outcome::explained || row.outcome == Outcome::smaller)
        std::printf("%-18s   %s\n", "", row.remark.c_str());
    }
}

void run(const ReproduceOptions& o) {
  const OutFolder folder(o.out);
  reproduce::Options options = o.study;
  if (options.threads == 0) options.threads = std::max(1u, std::thread::hardware_concurrency());
  reproduce::Reproduction r;
  {
    Progress progress("reproduce " + o.document);
    options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    r = reproduce::reproduce_002(options);
  }
  const std::string command = "furcula reproduce " + o.document + " --seed " + std::to_string(o.study.seed) +
                              " --out '" + o.out + "'";
  core::write_files_together(std::vector<core::NewFile>{
      {o.out + "/reproduction.json", reproduce::to_json_text(r)},
      {o.out + "/report.html", reproduce::render_reproduction_report(r, command)}});

  print_rows({&r.rows});
  using reproduce::Outcome;
  std::printf(
      "%zu met, %zu errors smaller than printed, %zu explained, %zu differ; %zu by construction, %zu computed "
      "beside a picture or no figure; %zu omissions, listed on the page\n",
      count(r.rows, Outcome::met), count(r.rows, Outcome::smaller), count(r.rows, Outcome::explained),
      count(r.rows, Outcome::differs), count(r.rows, Outcome::by_construction),
      count(r.rows, Outcome::computed), r.omissions.size());
  std::printf(
      "identification study %.1f s, with one cause switched %.1f s, energy study %.1f s, on %u threads; the fits alone on one thread:\n",
      r.study.seconds, r.switched_s, r.energy_s, options.threads);
  for (const reproduce::PlainStudy& c : r.study.plain)
    std::printf("  %-20s %zu fits: %.2f s here, %.2f s the plain way (%zu converged); NMSE %.5f here, %.5f\n",
                c.estimates.phase.c_str(), c.fits, c.ours_s, c.plain_s, c.converged, c.ours_nmse,
                c.plain_nmse);
  std::printf("report: %s/report.html\n", core::printable(o.out).c_str());
  if (count(r.rows, Outcome::differs) > 0)
    throw Refusal(std::to_string(count(r.rows, Outcome::differs)) +
                  " printed figures differ without a reason");
}

void run_001(const ReproduceOptions& o) {
  const OutFolder folder(o.out);
  reproduce::GaitStudyOptions options;
  options.seed = o.study.seed;
  options.starts = o.starts;
  options.processes =
      o.study.threads > 0 ? o.study.threads : std::max(1u, std::thread::hardware_concurrency());
  reproduce::GaitReproduction r;
  {
    Progress progress("reproduce 001");
    options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    r = reproduce::reproduce_001(options);
  }
  const std::string command = "furcula reproduce 001 --seed " + std::to_string(o.study.seed) + " --starts " +
                              std::to_string(o.starts) + " --out '" + o.out + "'";
  core::write_files_together(std::vector<core::NewFile>{
      {o.out + "/reproduction.json", reproduce::to_json_text(r)},
      {o.out + "/report.html", reproduce::render_gait_reproduction_report(r, command)}});
  print_rows({&r.rows});
  using reproduce::Outcome;
  std::printf("%zu met, %zu explained, %zu differ; %zu computed beside a picture or no figure\n",
              count(r.rows, Outcome::met), count(r.rows, Outcome::explained), count(r.rows, Outcome::differs),
              count(r.rows, Outcome::computed));
  std::printf("%zu gaits, %u starts each: %.1f s on %u processes\nreport: %s/report.html\n", r.gaits.size(),
              o.starts, r.seconds, options.processes, core::printable(o.out).c_str());
  if (count(r.rows, Outcome::differs) > 0)
    throw Refusal(std::to_string(count(r.rows, Outcome::differs)) +
                  " printed figures differ without a reason");
}

void run_000(const ReproduceOptions& o) {
  if (o.model.empty()) throw UsageError("reproduce 000: expected --model, a model file of kind biped");
  reproduce::WalkStudyOptions options;
  options.seed = o.study.seed;
  options.steps = o.steps;
  options.case_steps = o.case_steps;
  options.threads = o.study.threads > 0 ? o.study.threads : std::max(1u, std::thread::hardware_concurrency());
  options.model = o.model;
  for (const std::string& file : o.walks) {
    options.walks.push_back(walk::read_walk(file));
    walk::require_steps(options.walks.back(), file);
  }
  options.loops = o.loops;
  const OutFolder folder(o.out);
  reproduce::WalkReproduction r;
  {
    Progress progress("reproduce 000");
    options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    r = reproduce::reproduce_000(options);
  }
  std::string command = "furcula reproduce 000 --model " + core::shell_word(o.model) + " --seed " +
                        std::to_string(options.seed) + " --steps " + std::to_string(o.steps) +
                        " --case-steps " + std::to_string(o.case_steps);
  for (const std::string& file : o.walks) command += " --walk " + core::shell_word(file);
  for (const std::string& loop : o.loops) command += " --loop " + core::shell_word(loop);
  command += " --out " + core::shell_word(o.out);
  std::vector<core::NewFile> files{
      {o.out + "/reproduction.json", reproduce::to_json_text(r)},
      {o.out + "/report.html", reproduce::render_walk_reproduction_report(r, command)}};
  for (const reproduce::StudiedWalk& w : r.walks) {
    walk::RolloutOptions rollout;
    rollout.mode = w.mode;
    rollout.limits = r.model.limits;
    const std::string name = o.out + "/" + std::string(walk::kModeNames[static_cast<std::size_t>(w.mode)]);
    files.push_back({name + ".html",
                     walk::render_walk_report(r.model, rollout, w.walk, w.energy.ten_s,
                                              w.search ? w.search->history : std::vector<walk::SearchPoint>{},
                                              {}, command)});
    files.push_back(
        {name + ".toml", walk::format_walk({r.model.name, w.mode, rollout.walk_until_s, w.walk})});
  }
  core::write_files_together(files);
  print_rows({&r.rows, &r.times});
  using reproduce::Outcome;
  std::printf("%zu met, %zu differ; %zu by construction, %zu computed beside a picture or no figure\n",
              count(r.rows, Outcome::met), count(r.rows, Outcome::differs),
              count(r.rows, Outcome::by_construction), count(r.rows, Outcome::computed));
  std::printf("%.1f s on %u threads; report: %s/report.html\n", r.seconds, options.threads,
              core::printable(o.out).c_str());
  if (count(r.rows, Outcome::differs) > 0)
    throw Refusal(std::to_string(count(r.rows, Outcome::differs)) +
                  " printed figures differ without a reason");
}

}  // namespace

void add_reproduce_command(CLI::App& app) {
  auto options = std::make_shared<ReproduceOptions>();
  options->study.threads = 0;
  CLI::App* command =
      app.add_subcommand("reproduce", "A source document's numbers and figures, computed and compared");
  command
      ->add_option(
          "document", options->document,
          "000: the biped that walks actively and semi-passively; 001: the monopod with a switched spring at the knee; 002: the "
          "clutched parallel-elastic hopper")
      ->required()
      ->check(CLI::IsMember({"000", "001", "002"}));
  command
      ->add_option("--seed", options->study.seed,
                   "Of the machine that is identified (002), of the starts (001), of the searches (000)")
      ->capture_default_str();
  command->add_option("--threads", options->study.threads,
                      "Threads, of 001 processes; without it as many as processors");
  command->add_option("--out", options->out, "Folder for report.html and reproduction.json")->required();
  command->add_option("--starts", options->starts, "Of each gait of 001")
      ->check(CLI::Range(1u, 1000u))
      ->capture_default_str();
  command->add_option("--model", options->model, "Of 000's robot: a model file of kind biped");
  command->add_option("--walk", options->walks,
                      "A walk.toml in place of its mode's search (000); may be given twice");
  command->add_option("--loop", options->loops,
                      "Folder of a loop that was run (000, Figs. 7 and 8); may be given several times");
  command->add_option("--steps", options->steps, "Of simulation, of each mode's search (000)")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1'000'000'000'000}))
      ->capture_default_str();
  command
      ->add_option("--case-steps", options->case_steps,
                   "Of simulation, of each case's search in the energy study (000); 0: none")
      ->capture_default_str();
  command->callback([options] {
    if (options->document == "000")
      run_000(*options);
    else if (options->document == "001")
      run_001(*options);
    else
      run(*options);
  });
}

}  // namespace furcula::cli
