// What `identify` and `diagnose` have in common: a model, logs of its rig, and which of them are held out.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
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
};

struct Recordings {
  model::Model model;
  std::vector<log::Log> training;
  std::vector<log::Log> held_out;
};

/// Reads the model and the logs, and splits them where no held-out logs are named.
/// @throws UsageError (a log named twice, a bad window), log::DataError
Recordings read_recordings(const RecordingOptions& options);

/// Makes the folder of the results. @throws UsageError where it cannot be made.
void make_folder(const std::string& path);

}  // namespace furcula::cli
