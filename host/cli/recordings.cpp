#include "host/cli/recordings.hpp"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <optional>
#include <set>
#include <system_error>
#include <thread>

#include "host/cli/errors.hpp"
#include "host/core/commands.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/gait/leg_as_tree.hpp"
#include "host/gait/machine_file.hpp"
#include "host/identify/split.hpp"
#include "host/log/accept_stamps.hpp"
#include "host/log/machine_types.hpp"
#include "host/log/reader.hpp"
#include "host/machines/rules.hpp"
#include "host/model/reader.hpp"
#include "host/trees/joint_choice.hpp"

namespace furcula::cli {

namespace {

/// Kinds whose recordings are cut into windows of one length.
std::string kinds_in_intervals() {
  std::string out;
  for (const auto& machine : dynamics::kMachines)
    if (machines::rules(machine.kind).cut == machines::Cut::intervals)
      out += (out.empty() ? "" : ", ") + std::string(machine.name);
  return out;
}

void require_window(double window_s) {
  if (!(window_s >= 0.0 && window_s <= 60.0))
    throw UsageError("--window-s " + std::to_string(window_s) +
                     " is not a window; expected a number of seconds above 0 and up to 60");
}

std::optional<log::ColumnMap> map_of(const std::string& path) {
  if (path.empty()) return std::nullopt;
  return log::read_column_map(path);
}

/// @throws UsageError where a file that is read would be overwritten by a result, or lies where traces are written.
void require_other_folder(const RecordingOptions& o) {
  namespace fs = std::filesystem;
  const auto in = [](const fs::path& file, const std::string& folder) {
    std::error_code error;
    return fs::equivalent(file.has_parent_path() ? file.parent_path() : fs::path("."), folder, error);
  };
  std::vector<std::string> read{o.model, o.map};
  read.insert(read.end(), o.logs.begin(), o.logs.end());
  read.insert(read.end(), o.held_out.begin(), o.held_out.end());
  for (const std::string& file : read)
    if (!file.empty() && in(file, o.traces_folder()))
      throw UsageError("--out " + o.out + ": " + file + ", which is read, lies in " + o.traces_folder() +
                       ", where traces are written; expected another folder");
  for (const char* result : {"extended_model.toml", "identified_model.toml", "extended.urdf",
                             "extended.mjcf.xml", "fitted_bodies.urdf", "identified.urdf"})
    if (fs::path(o.model).filename() == result && in(o.model, o.out))
      throw UsageError("--out " + o.out + ": " + o.model +
                       ", which is read, would be overwritten by the result; expected another folder");
}

log::Log read_stamped(const std::string& path, const std::string& rig, const log::ColumnMap* map,
                      double window_s) {
  log::Log log = log::read_log(path, rig, map);
  log::accept_stamps(log, map, window_s);
  return log;
}

}  // namespace

void require_other_file(const char* option, const std::string& path,
                        std::initializer_list<std::string> read) {
  for (const std::string& file : read) {
    std::error_code error;
    if (!path.empty() && !file.empty() && std::filesystem::equivalent(path, file, error))
      throw UsageError(std::string(option) + ": " + path + " is what is read; expected another file");
  }
}

std::vector<std::string_view> rig_names() {
  std::vector<std::string_view> names;
  for (const log::MachineType& r : log::kMachineTypes) names.push_back(r.name);
  return names;
}

void require_rig(const std::string& name) {
  if (log::machine_type_named(name) != nullptr) return;
  const std::vector<std::string_view> rigs = rig_names();
  throw UsageError("--machine " + name + ": no such machine type; expected one of " + core::listed(rigs) +
                   core::did_you_mean(name, rigs));
}

void RecordingOptions::add_to(CLI::App& command) {
  command
      .add_option("--model", model,
                  "Model file (TOML), or a robot (URDF, MJCF): a tree; of a URDF all inputs are torques")
      ->required();
  command.add_option("--map", map, "Map file (TOML) for logs with other column names");
  command.add_option("--hold-out", held_out,
                     "Logs that no fit sees (put another option or -- after them); without it a seeded "
                     "fifth, of one log its last quarter");
  command.add_option("--window-s", window_s,
                     "Length of a prediction, s: 0.5 if not given on " + kinds_in_intervals() +
                         " and a hopper that stays on the ground, 0.3 on a tree");
  command.add_option("--out", out, "Folder for the results")->required();
  command.add_flag(
      "--trust-columns", trust_columns,
      "Do not try whether the columns have other units, signs, zeros or joints than their names say");
  command.add_flag("--accept-inertias", accept_inertias, kAcceptInertias);
  command.add_option("--threads", threads, "Threads; the result is the same for any number");
  command.add_option("--seed", seed, "Seed of the choice of held-out logs")->capture_default_str();
  command.add_option("logs", logs, "Logs (furcula-log/1, or as the map says) or ROS 2 bags, at least one");
}

unsigned RecordingOptions::thread_count() const {
  return threads > 0 ? threads : std::max(1u, std::thread::hardware_concurrency());
}

std::string RecordingOptions::command_line(const std::string& command, bool tree) const {
  std::string line = "furcula " + command;
  const auto add = [&line](const std::string& word) { line += " " + core::shell_word(word); };
  const auto option = [&add](const char* name, const std::string& value) {
    add(name);
    add(value);
  };
  option("--model", model);
  if (!map.empty()) option("--map", map);
  if (trust_columns) add("--trust-columns");
  if (accept_inertias) add("--accept-inertias");
  option("--window-s", core::shortest(window(tree)));
  option("--seed", std::to_string(seed));
  for (const std::string& path : logs) add(path);
  if (!held_out.empty()) add("--hold-out");
  for (const std::string& path : held_out) add(path);
  return line;
}

log::Log read_log_of(const std::string& path, const std::string& rig, const std::string& map,
                     double window_s) {
  require_window(window_s);
  const std::optional<log::ColumnMap> columns = map_of(map);
  return read_stamped(path, rig, columns ? &*columns : nullptr, window_s);
}

Logs read_logs(const RecordingOptions& options, const std::string& rig) {
  require_window(options.window_s);
  if (options.logs.empty())
    throw UsageError(
        options.held_out.empty()
            ? "no log is given; expected at least one (furcula COMMAND --help)"
            : "all logs are held out and none is left to fit; expected some before --hold-out, or after another option or --");
  std::set<std::string> seen;
  for (const auto* list : {&options.logs, &options.held_out})
    for (const std::string& path : *list) {
      std::error_code error;
      const auto canonical = std::filesystem::weakly_canonical(path, error);
      if (!seen.insert(error ? path : canonical.string()).second)
        throw UsageError(path + " is given twice; expected each log once, to fit or to hold out");
    }
  if (!options.out.empty()) require_other_folder(options);
  Logs r;
  const std::optional<log::ColumnMap> map = map_of(options.map);
  const auto read = [&](const std::vector<std::string>& paths) {
    std::vector<log::Log> logs;
    for (const std::string& path : paths)
      logs.push_back(read_stamped(path, rig, map ? &*map : nullptr, options.window_s));
    return logs;
  };
  r.training = read(options.logs);
  r.held_out = read(options.held_out);
  if (options.held_out.empty())
    std::tie(r.training, r.held_out) =
        identify::split(std::move(r.training), options.seed, options.least_logs);
  return r;
}

Recordings read_recordings(const RecordingOptions& options) {
  Recordings r;
  r.model = model::read_model(options.model);
  static_cast<Logs&>(r) = read_logs(options, std::string(dynamics::info(r.model.kind).rig));
  return r;
}

bool is_tree_model(const std::string& path) {
  const std::string text = core::read_small_file(path, "a model file (TOML) or a robot (URDF, MJCF)");
  return gait::is_planar_leg(text) || trees::is_tree(text);
}

std::optional<trees::TreeModel> tree_model(const std::string& path, trees::TreeContext context) {
  const std::string text = core::read_small_file(path, "a model file (TOML) or a robot (URDF, MJCF)");
  if (gait::is_planar_leg(text)) {
    const gait::LegAsTree leg = gait::leg_as_tree(gait::parse_machine(text, path));
    context.urdf = leg.urdf;
    return trees::parse_tree_model(leg.model, path, context);
  }
  if (!trees::is_tree(text)) return std::nullopt;
  return trees::parse_tree_model(text, path, context);
}

trees::TreeModel tree_of(const RecordingOptions& options, const Logs& logs) {
  trees::TreeModel model = tree_model(options.model, {{}, columns_of(logs), options.accept_inertias}).value();
  std::vector<const log::Log*> all;
  for (const auto* list : {&logs.training, &logs.held_out})
    for (const log::Log& log : *list) all.push_back(&log);
  for (std::string& note : trees::notes_on_held(model, all)) model.notes.push_back(std::move(note));
  return model;
}

trees::TreeModel tree_of(const std::string& model, const log::Log& log, bool accept_inertias) {
  RecordingOptions options;
  options.model = model;
  options.accept_inertias = accept_inertias;
  Logs logs;
  logs.training.push_back(log);
  return tree_of(options, logs);
}

std::vector<std::string> columns_of(const Logs& logs) {
  std::set<std::string> names;
  for (const auto* list : {&logs.training, &logs.held_out})
    for (const log::Log& log : *list)
      for (const auto& [name, values] : log.columns) names.insert(name);
  return {names.begin(), names.end()};
}

void print_notes(const trees::TreeModel& model) {
  for (const std::string& note : model.notes)
    std::cerr << core::printable(model.urdf.file) << ": note: " << core::printable(note) << "\n";
}

void CommentsOption::add_to(CLI::App& command) {
  command.add_flag(
      "--no-comments", none,
      "Begin the log with its header row, for programs that read no comments. What the lines \"# key: value\" say "
      "is lost: commands that read the log take the machine type from --model, --machine or a map");
}

void print_data_quality(const log::DataQuality& data_quality) {
  for (const std::string& line : log::lines_of(data_quality)) std::cout << core::printable(line) << "\n";
}

OutFolder::OutFolder(const std::string& path) {
  std::error_code error;
  // "a/b/" has an empty last name, which no folder is made of.
  std::filesystem::path folder = std::filesystem::path(path + "/").parent_path();
  for (; !folder.empty() && !std::filesystem::exists(folder, error) && folder != folder.parent_path();
       folder = folder.parent_path())
    made_.push_back(folder);
  std::filesystem::create_directories(path, error);
  if (!std::filesystem::is_directory(path))
    throw UsageError("--out " + path + ": cannot make this folder" +
                     (error ? " (" + error.message() + ")" : "") +
                     "; expected a folder that exists or can be made");
}

OutFolder::~OutFolder() {
  std::error_code error;
  for (const auto& folder : made_)
    if (!std::filesystem::is_empty(folder, error) || error || !std::filesystem::remove(folder, error)) return;
}

}  // namespace furcula::cli
