// What `identify` and `diagnose` have in common: a model, logs of its rig, and which of them are held out.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "host/log/log.hpp"
#include "host/model/model.hpp"

namespace furcula::cli {

struct RecordingOptions {
  std::string model;
  std::string map;
  std::string out;
  std::vector<std::string> logs;
  std::vector<std::string> held_out;
  double window_s = 0.5;
  unsigned threads = 0;  ///< 0: as many as the machine has
  std::uint64_t seed = 1;

  void add_to(CLI::App& command);
  /// `threads`, or what the machine has.
  unsigned thread_count() const;
  /// The command line that gives the same results again: what does not change them (--out, --threads) left
  /// out.
  std::string command_line(const std::string& command) const;
};

struct Recordings {
  model::Model model;
  std::vector<log::Log> training;
  std::vector<log::Log> held_out;
};

/// Reads the model and the logs, and splits them where no held-out logs are named.
/// @throws UsageError (no log to fit, a log named twice, a bad window), log::DataError
Recordings read_recordings(const RecordingOptions& options);

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
