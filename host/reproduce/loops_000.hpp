// Document 000, section IV: loops of identification and search that were run, beside its Figs. 7 and 8, and what the model of an active loop says of a
// semi-passive walk.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/floating/identify.hpp"
#include "host/loop/loop.hpp"
#include "host/reproduce/comparison.hpp"

namespace furcula::reproduce {

/// A loop's folder, as `furcula walk loop` left it.
struct StudiedLoop {
  std::string folder;
  walk::WalkMode mode = walk::WalkMode::active;  ///< of its first walk
  loop::LoopResult result;
};

/// Eq. 3 of models on the last semi-passive walk, rad: over the whole walk, and over windows.
struct CrossPrediction {
  std::string log;
  loop::CellErrors given, active;
  /// Identified from the recordings of both loops but this one.
  loop::CellErrors together;
};

struct LoopStudy {
  std::vector<StudiedLoop> loops;
  std::optional<CrossPrediction> cross;  ///< where there is a loop of each mode
};

struct LoopStudyOptions {
  std::string model;                 ///< the robot's file, with which the loops began
  std::vector<std::string> folders;  ///< of loops
  unsigned threads = 1;
  std::function<void(double fraction, std::string_view doing)> progress;
  floating::IdentifyOptions identify = {};  ///< from all recordings; threads and progress are those above
};

/// @throws core::DataError: a folder without a loop of that robot, a log that cannot be read.
LoopStudy study_loops(const LoopStudyOptions& options);

/// Each beside the printed figure. The robots are others: nothing is held against the print.
std::vector<Row> rows_of(const LoopStudy& study);

/// Triangles of Eq. 3, printed and computed.
std::string loops_html(const LoopStudy& study);

}  // namespace furcula::reproduce
