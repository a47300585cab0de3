// `furcula check`: reads logs as the other commands would, in bounded memory, and says what is in them.
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/message.hpp"
#include "host/log/reader.hpp"
#include "host/model/reader.hpp"
#include "host/trees/joint_choice.hpp"
#include "host/trees/recording.hpp"

namespace furcula::cli {
namespace {

struct CheckOptions {
  std::string rig;
  std::string model;
  std::string map;
  bool accept_inertias = false;
  std::vector<std::string> logs;
};

/// What the options say, or the map; empty: each log must tell its own.
std::string rig_of(const CheckOptions& options, const log::ColumnMap* map) {
  if (!options.model.empty()) {
    if (is_tree_model(options.model)) return "tree";
    const model::Model m = model::read_model(options.model);
    return std::string(dynamics::info(m.kind).rig);
  }
  if (options.rig.empty()) return map != nullptr ? map->rig : "";  // which may not say
  require_rig(options.rig);
  return options.rig;
}

/// Of all logs: what their header rows say. A log that has none is told of where it is read.
std::vector<std::string> header_columns(const CheckOptions& options, const log::ColumnMap* map) {
  std::set<std::string> names;
  for (const std::string& path : options.logs) {
    // What is read of a pipe is gone.
    std::error_code error;
    if (!std::filesystem::is_regular_file(path, error) && !std::filesystem::is_directory(path, error))
      continue;
    try {
      for (std::string& name : log::column_names(path, "tree", map)) names.insert(std::move(name));
    } catch (const core::DataError&) {  // which reading it says, too
    }
  }
  return {names.begin(), names.end()};
}

void print(const std::string& file, const log::LogSummary& s) {
  const std::string path = core::printable(file);
  char figures[200];
  std::snprintf(figures, sizeof figures,
                "%llu rows, %.6g s, interval min %.6g, median %.6g, mean %.6g, max %.6g ms",
                static_cast<unsigned long long>(s.rows), s.duration_s, 1e3 * s.interval_min_s,
                1e3 * s.interval_median_s, 1e3 * s.interval_mean_s, 1e3 * s.interval_max_s);
  std::cout << path << ": " << figures << "\n";
  for (const std::string& column : s.ignored_columns)
    std::cerr << path << ": note: column " << core::quoted(column)
              << " is not of this machine type and not numeric: ignored\n";
  if (!s.refused.empty()) std::cout << core::printable(log::in_words(s.refused, s.rejected_rows)) << "\n";
  for (const auto* notes : {&s.notes, &s.stamps.notes, &s.stamps.remarks})
    for (const std::string& note : *notes) std::cout << core::printable(note) << "\n";
  if (!s.last_row_ends)
    std::cerr << path << ": note: no line end after the last row: its last number may have been cut\n";
}

void run(const CheckOptions& options) {
  if (!options.rig.empty() && !options.model.empty())
    throw UsageError("--machine and --model: expected one of them");
  std::optional<log::ColumnMap> map;
  if (!options.map.empty()) map = log::read_column_map(options.map);
  const std::string rig = rig_of(options, map ? &*map : nullptr);
  std::optional<trees::TreeModel> tree;
  if (!options.model.empty() && rig == "tree") {
    tree = tree_model(options.model,
                      {{}, header_columns(options, map ? &*map : nullptr), options.accept_inertias});
    print_notes(*tree);
  }
  std::string errors;
  for (const std::string& path : options.logs) {
    try {
      const std::string own = rig.empty() ? log::rig_line(path, map ? &*map : nullptr) : rig;
      if (own.empty()) throw core::DataError(log::no_rig(path));
      const log::LogSummary summary = log::check_log(path, own, map ? &*map : nullptr);
      if (!summary.stamps.fatal().empty()) throw core::DataError(summary.stamps.fatal());
      // Which columns a robot's log must have, its joints say.
      std::vector<std::string> of_robot;
      if (tree) {
        const log::Log log = log::read_log(path, own, map ? &*map : nullptr);
        // Before what may refuse the log.
        for (const std::string& note : trees::notes_on_held(*tree, {&log}))
          std::cerr << core::printable(path) << ": note: " << core::printable(note) << "\n";
        for (const std::string& note : trees::recording_of(*tree, log).log_notes)
          if (std::find(log.notes.begin(), log.notes.end(), note) == log.notes.end())
            of_robot.push_back(note);
      }
      print(path, summary);
      for (const std::string& note : of_robot) std::cout << core::printable(note) << "\n";
    } catch (const core::DataError& e) {
      // One line for each bad log; the good ones after it are checked all the same.
      errors += (errors.empty() ? "" : "\nfurcula: ") + std::string(e.what());
    }
  }
  if (!errors.empty()) throw core::DataError(errors);
}

}  // namespace

void add_check_command(CLI::App& app) {
  const auto options = std::make_shared<CheckOptions>();
  CLI::App* command = app.add_subcommand("check", "Check logs, however large, and print what is in them");
  command->add_option("--machine,--rig", options->rig,
                      "Machine type of the logs: " + core::listed(rig_names()) +
                          "; without it that of the model, of the map, or of the log's own line");
  command->add_option("--model", options->model,
                      "Model file or robot (URDF, MJCF), whose kind tells the machine type");
  command->add_option("--map", options->map, "Map file, for logs with other columns");
  command->add_flag("--accept-inertias", options->accept_inertias, kAcceptInertias);
  command->add_option("LOG", options->logs, "Logs (CSV, or ROS 2 bags)")->required();
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
