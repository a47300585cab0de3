// `furcula bench`: experiments on a test stand.
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "host/bench/bus_board.hpp"
#include "host/bench/hil_board.hpp"
#include "host/bench/limits.hpp"
#include "host/bench/pil_board.hpp"
#include "host/bench/release_catch.hpp"
#include "host/bench/release_catch_json.hpp"
#include "host/bench/release_catch_report.hpp"
#include "host/bench/sim_board.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/progress.hpp"
#include "host/cli/recordings.hpp"
#include "host/cli/within.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/log/writer.hpp"
#include "host/pil/own_image.hpp"

namespace furcula::cli {
namespace {

struct BenchOptions {
  std::string board = "sim", limits, out;
  bench::Conditions conditions;
  double window_ms = 40.0;
  int pulley_teeth = 20;
  std::size_t trials = 100;
  std::uint64_t seed = 0;
};

std::string milliseconds(double time_s) {
  return time_s == time_s ? core::shortest(std::round(1e4 * time_s) / 10.0) + " ms" : "never";
}
std::string millimetres(double length_m) {
  return length_m == length_m ? core::shortest(std::round(1e4 * length_m) / 10.0) + " mm" : "-";
}

constexpr const char* kBoards =
    "sim, pil, pil:IMAGE, hil, hil:FURCULAD, modbus:HOST:PORT, modbus:/dev/NAME@BAUD or can:INTERFACE";

/// Where nobody sits, the stand hangs its load up by itself.
void ask_to_hang(const bench::Conditions& c) {
  if (::isatty(STDIN_FILENO) == 0) return;
  std::fprintf(stderr,
               "Hang %g kg at rest at the top of its way (window %g ms), then press Enter: ", c.load_kg,
               1e3 * c.window_s);
  for (int key = std::getchar(); key != '\n' && key != EOF;) key = std::getchar();
}

std::unique_ptr<bench::Board> open_board(const BenchOptions& o) {
  const std::string& text = o.board;
  if (text == "sim") return std::make_unique<bench::SimBoard>();
  if (text == "pil") return std::make_unique<bench::PilBoard>(pil::own_image());
  if (text.starts_with("pil:") && text.size() > 4) return std::make_unique<bench::PilBoard>(text.substr(4));
  if (text == "hil") return std::make_unique<bench::HilBoard>("");
  if (text.starts_with("hil:") && text.size() > 4) return std::make_unique<bench::HilBoard>(text.substr(4));
  if (text.starts_with("modbus:") || text.starts_with("can:")) {
    modbus::Port port;
    try {
      port = modbus::parse_port(text);
    } catch (const core::DataError& e) {
      throw UsageError(std::string("--board: ") + e.what());
    }
    return std::make_unique<bench::BusBoard>(port, o.pulley_teeth, ask_to_hang);
  }
  throw UsageError("--board: " + core::quoted(text) + "; expected " + kBoards);
}

void run(const BenchOptions& o) {
  const bench::Limits limits = o.limits.empty() ? bench::Limits{} : bench::read_limits(o.limits);
  const std::unique_ptr<bench::Board> stand = open_board(o);
  bench::Board& board = *stand;
  const OutFolder folder(o.out);
  bench::Options options;
  options.conditions = o.conditions;
  options.conditions.window_s = 1e-3 * std::round(o.window_ms);  // whole ticks
  options.trials = o.trials;
  options.seed = o.seed;
  bench::ReleaseCatch r;
  {
    Progress progress("release and catch");
    options.progress = [&](double fraction, std::string_view doing) { progress.update(fraction, doing); };
    r = bench::run_release_catch(board, options, limits);
  }
  std::string command = "furcula bench release-catch --board " + o.board + " --load-kg " +
                        core::shortest(o.conditions.load_kg) + " --window-ms " + core::shortest(o.window_ms) +
                        " --supply-v " + core::shortest(o.conditions.supply_v) + " --pressing-n " +
                        core::shortest(o.conditions.pressing_n) + " --trials " + std::to_string(o.trials) +
                        " --seed " + std::to_string(o.seed) +
                        (o.limits.empty() ? "" : " --limits " + o.limits) + " --out " + o.out;
  std::vector<core::NewFile> files{
      {o.out + "/standard.csv", log::format_log(bench::to_log(r.standard, board, "standard.csv"))},
      {o.out + "/release_catch.json", bench::to_json_text(r)},
      {o.out + "/report.html", bench::render_release_catch_report(r, board.metres_per_count(), command)}};
  const std::string worst = o.out + "/worst.csv";
  std::vector<std::string> obsolete;
  if (r.trials.empty())
    obsolete.push_back(worst);
  else
    files.push_back({worst, log::format_log(bench::to_log(r.trials[r.worst], board, "worst.csv"))});
  core::write_files_together(files, obsolete);

  const bench::Summary& s = r.summary;
  const bench::Trial& given = r.standard;
  if (!given.held)
    std::printf("as given: not held before the release\n");
  else
    std::printf("as given: released after %s, caught after %s, drop %s%s\n",
                milliseconds(given.released_after_s).c_str(), milliseconds(given.caught_after_s).c_str(),
                given.caught() ? millimetres(given.drop_m).c_str() : "-",
                given.slipped ? ", then slipped" : "");
  if (s.trials > 0) {
    if (std::isfinite(s.caught_after_worst_s))
      std::printf("%zu varied: caught after %s (median), %s to %s (5 to 95 %%), %s (worst); drop up to %s; ",
                  s.trials, milliseconds(s.caught_after_median_s).c_str(),
                  milliseconds(s.caught_after_p5_s).c_str(), milliseconds(s.caught_after_p95_s).c_str(),
                  milliseconds(s.caught_after_worst_s).c_str(), millimetres(s.drop_worst_m).c_str());
    else
      std::printf("%zu varied: none caught; ", s.trials);
    std::printf("%zu not held, %zu never released, %zu not caught, %zu slipped\n", s.not_held, s.not_released,
                s.not_caught, s.slips);
  }
  const char* before = "pressing force: ";
  for (const bench::Holding& h : r.holding) {
    std::printf("%s%g N holds %.2f kg", before, h.pressing_n, h.load_kg);
    before = ", ";
  }
  if (!r.holding.empty()) std::printf("\n");
  for (const bench::Check& c : r.checks) {
    char measured[32] = "not in every trial";
    if (std::isfinite(c.measured)) std::snprintf(measured, sizeof measured, "%.6g", c.measured);
    std::printf("%s %s: %s, asked %s %g%s%s\n", c.passed ? "passed" : "FAILED", std::string(c.name).c_str(),
                measured, c.at_most ? "at most" : "at least", c.limit, c.unit.empty() ? "" : " ",
                std::string(c.unit).c_str());
  }
  std::printf("report: %s/report.html\n", core::printable(o.out).c_str());
  std::fflush(stdout);
  if (!r.passed) throw Refusal("the clutch does not meet its limits (" + o.limits + ")");
}

}  // namespace

void add_bench_command(CLI::App& app) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* group = app.add_subcommand("bench", "Experiments on a test stand");
  group->require_subcommand(1);
  CLI::App* command = group->add_subcommand(
      "release-catch",
      "Let a weight on the clutch's belt go and catch it; varied trials, sweeps, holding load");
  command->add_option("--board", options->board, std::string("The stand: ") + kBoards)->capture_default_str();
  command->add_option("--load-kg", options->conditions.load_kg, "Weight on the belt")
      ->check(within(0.01, 1000.0))
      ->capture_default_str();
  command->add_option("--window-ms", options->window_ms, "From the release command to the catch command")
      ->check(within(1.0, 10000.0))
      ->capture_default_str();
  command->add_option("--supply-v", options->conditions.supply_v, "Supply of the coil")
      ->check(within(0.1, 1000.0))
      ->capture_default_str();
  command->add_option("--pressing-n", options->conditions.pressing_n, "Return spring's force on the key")
      ->check(within(0.01, 1000.0))
      ->capture_default_str();
  command
      ->add_option("--trials", options->trials, "With load, window and supply varied by 20 %, 5 ms and 10 %")
      ->check(CLI::Range(std::size_t{0}, std::size_t{1000000}))
      ->capture_default_str();
  command
      ->add_option("--pulley-teeth", options->pulley_teeth,
                   "Of the belt's pulley at the encoder of a board on a bus, for its angle in the logs")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the varied trials")->capture_default_str();
  command->add_option("--limits", options->limits,
                      "What the test must meet (TOML): status 4 where it does not");
  command
      ->add_option("--out", options->out,
                   "Folder for report.html, release_catch.json, standard.csv, worst.csv")
      ->required();
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
