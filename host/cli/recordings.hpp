// What `identify` and `diagnose` have in common: a model, logs of its rig, and which of them are held out.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/log/log.hpp"
#include "host/log/writer.hpp"
#include "host/model/model.hpp"
#include "host/trees/model.hpp"

namespace furcula::cli {

struct RecordingOptions {
  std::string model;
  std::string map;
  std::string out;
  std::vector<std::string> logs;
  std::vector<std::string> held_out;
  double window_s = 0.0;  ///< 0: 0.5 s, on a tree 0.3 s
  unsigned threads = 0;   ///< 0: as many as the machine has
  std::uint64_t seed = 1;
  std::size_t least_logs = 2;  ///< below so many the last quarter of each is held out
  bool trust_columns = false;
  bool accept_inertias = false;  ///< of a tree

  void add_to(CLI::App& command);
  /// `threads`, or what the machine has.
  unsigned thread_count() const;
  /// `window_s`, or what is usual: on a tree shorter, since errors grow along a chain of joints.
  double window(bool tree) const { return window_s > 0.0 ? window_s : tree ? 0.3 : 0.5; }
  /// Of measured and predicted traces.
  std::string traces_folder() const { return out + "/traces"; }
  /// The command line that gives the same results again: what does not change them (--out, --threads) left
  /// out.
  std::string command_line(const std::string& command, bool tree = false) const;
};

/// Names of the rigs that a log can be of.
std::vector<std::string_view> rig_names();

/// @throws UsageError: no rig has the name that --machine gives.
void require_rig(const std::string& name);

struct Logs {
  std::vector<log::Log> training;
  std::vector<log::Log> held_out;
};

/// Reads one log. @throws as read_logs.
log::Log read_log_of(const std::string& path, const std::string& rig, const std::string& map,
                     double window_s);

/// Reads the logs of a rig, and splits them where no held-out logs are named. What their time stamps imply is among their notes, and
/// intervals that contradict the motion are gaps.
/// @throws UsageError (no log to fit, a log named twice, a bad window), core::DataError, also of stamps from which nothing can be learnt.
Logs read_logs(const RecordingOptions& options, const std::string& rig);

struct Recordings : Logs {
  model::Model model;
};

/// Reads the model and the logs. @throws UsageError, core::DataError
Recordings read_recordings(const RecordingOptions& options);

/// Whether the file is a model of a tree. @throws core::DataError
bool is_tree_model(const std::string& path);

/// The model, where the file is one of a tree. @throws core::DataError
std::optional<trees::TreeModel> tree_model(const std::string& path, trees::TreeContext context = {});

/// The names of all columns of the logs.
std::vector<std::string> columns_of(const Logs& logs);

/// The model of a tree, its joints by what the logs have columns of; what else they say of joints that are held is among its notes. @throws core::DataError
trees::TreeModel tree_of(const RecordingOptions& options, const Logs& logs);

/// The same of one log.
trees::TreeModel tree_of(const std::string& model, const log::Log& log, bool accept_inertias);

/// Prints what a model's URDF was taken for to standard error, a line each.
void print_notes(const trees::TreeModel& model);

/// Does the work. Where it throws, the model's notes are printed to standard error: they may be why, and no report has them.
template <class Work>
void with_notes(const trees::TreeModel& model, const Work& work) {
  try {
    work();
  } catch (...) {
    print_notes(model);
    throw;
  }
}

/// What `--accept-inertias` is.
inline constexpr const char* kAcceptInertias =
    "Take masses and moments of inertia of a URDF as they are, also those that no body has, as long as each joint has an inertia above 0";

/// `--no-comments` of a command that writes a log.
struct CommentsOption {
  bool none = false;

  void add_to(CLI::App& command);
  log::Comments of_log() const { return none ? log::Comments::without : log::Comments::with; }
};

/// Prints what was wrong with the recordings, a line each.
void print_data_quality(const log::DataQuality& data_quality);

/// @throws UsageError where `path`, which an option names to be written, is one of the files `read`. Empty names are no files.
void require_other_file(const char* option, const std::string& path, std::initializer_list<std::string> read);

/// The folder of the results, there from construction on. Where nothing has been written into it by the end
/// of its life, the folders that it has made are gone again: a run that fails leaves nothing behind.
class OutFolder {
 public:
  /// @throws UsageError where it cannot be made.
  explicit OutFolder(const std::string& path);
  ~OutFolder();
  OutFolder(const OutFolder&) = delete;
  OutFolder& operator=(const OutFolder&) = delete;

 private:
  std::vector<std::filesystem::path> made_;  ///< innermost first
};

}  // namespace furcula::cli
