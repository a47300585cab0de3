// `furcula replay`: a model run on a log's recorded inputs; measured and predicted traces, and their errors.
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include "host/cli/commands.hpp"
#include "host/cli/errors.hpp"
#include "host/cli/recordings.hpp"
#include "host/core/atomic_file.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/model/reader.hpp"
#include "host/traces/of_axis.hpp"
#include "host/traces/of_tree.hpp"

namespace furcula::cli {
namespace {

struct ReplayOptions {
  std::string model, log, out, layout, map;
  double window_s = 0.0;
  bool accept_inertias = false;

  double window(bool tree) const { return window_s > 0.0 ? window_s : tree ? 0.3 : 0.5; }
};

traces::Traces of_robot(const ReplayOptions& o) {
  const log::Log log = read_log_of(o.log, "tree", o.map, o.window_s);
  const trees::TreeModel model = tree_of(o.model, log, o.accept_inertias);
  print_notes(model);
  const trees::Hypothesis given{model.drives, model.causes};
  return traces::of_tree(model, {{"predicted", given}}, {log}, {}, o.window(true));
}

traces::Traces of_machine(const ReplayOptions& o) {
  const model::Model model = model::read_model(o.model);
  const log::Log log = read_log_of(o.log, std::string(dynamics::info(model.kind).rig), o.map, o.window_s);
  return traces::of_axis({{"predicted", model}}, model, {log}, {}, o.window(false));
}

/// Where a layout finds the traces, from its own folder.
std::string seen_from(const std::string& layout, const std::string& traces) {
  const auto folder = std::filesystem::absolute(layout).parent_path();
  return std::filesystem::absolute(traces).lexically_relative(folder).string();
}

void run(const ReplayOptions& o) {
  require_other_file("--out", o.out, {o.model, o.log, o.map});
  require_other_file("--layout", o.layout, {o.model, o.log, o.map});
  if (!o.out.empty() && o.layout == o.out)
    throw UsageError("--layout: " + o.layout + " is the traces' file, too; expected another file");
  if (!o.layout.empty() && (o.out.empty() || !o.out.ends_with(".csv")))
    throw UsageError("--layout needs the traces' file; expected --out with a name that ends in .csv");
  const bool tree = is_tree_model(o.model);
  const traces::Traces traces = tree ? of_robot(o) : of_machine(o);
  const traces::LogTraces& log = traces.logs.front();
  std::size_t windows = 0, rows = 0;
  for (const std::size_t w : log.window) {
    windows = std::max(windows, w);
    rows += w != 0 ? 1 : 0;
  }
  if (windows == 0)
    throw core::DataError(o.log + ": no window to predict over in " + std::to_string(log.time_s.size()) +
                          " rows; expected a longer log, or a smaller --window-s");
  std::vector<core::NewFile> files;
  if (!o.out.empty()) files.push_back({o.out, traces::csv_text(traces, log)});
  if (!o.layout.empty())
    files.push_back({o.layout, traces::layout_text(traces, {seen_from(o.layout, o.out)})});
  core::write_files_together(files);
  std::cout << core::printable(o.log) << ": " << windows << (windows == 1 ? " window, " : " windows, ")
            << rows << " of " << log.time_s.size() << " rows\n";
  for (const traces::Quantity& q : log.quantities) {
    const traces::Error e = traces::error_of(log, q, 0);
    std::cout << "  " << core::printable(q.column) << ": ";
    if (e.rows == 0)
      std::cout << "no prediction\n";
    else
      std::cout << "RMSE " << core::rounded(e.rmse) << " " << q.unit << ", NMSE "
                << (std::isnan(e.nmse) ? "-" : core::rounded(e.nmse)) << "\n";
  }
}

}  // namespace

void add_replay_command(CLI::App& app) {
  const auto options = std::make_shared<ReplayOptions>();
  CLI::App* command =
      app.add_subcommand("replay", "Run a model on a log's recorded inputs; print the error of each channel");
  command->add_option("MODEL", options->model, "Model file (TOML)")->required();
  command->add_option("LOG", options->log, "Log (CSV, or a ROS 2 bag)")->required();
  command->add_option("-o,--out", options->out, "Measured and predicted traces (CSV)");
  command->add_option("--layout", options->layout, "Layout of PlotJuggler that shows the traces (XML)");
  command->add_option("--map", options->map, "Map file (TOML) for a log with other column names");
  command->add_option(
      "--window-s", options->window_s,
      "Length of a free run, s, as in furcula diagnose: 0.5 if not given, 0.3 on a tree; hops, "
      "flights and releases have their own");
  command->add_flag("--accept-inertias", options->accept_inertias, kAcceptInertias);
  command->callback([options] { run(*options); });
}

}  // namespace furcula::cli
