// What was not taken of a log as it stands: rows that were left out, and anything else that was done to it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace furcula::log {

/// A row that nothing is learnt from.
struct RejectedRow {
  std::string log;         ///< its path
  std::size_t row = 0;     ///< among the rows after the header row, from 1
  std::uint64_t line = 0;  ///< of the file, from 1; 0: not known
  std::string column;      ///< what is wrong with it; empty: the row as a whole
  double value = std::numeric_limits<double>::quiet_NaN();
  std::string text;  ///< what stands there, where it is no number
  std::string why;
};

/// "run02.csv row 417 height_m 9.99 (steps out of the rows around and back)"
std::string in_words(const RejectedRow& row);

/// Of rows that were left out, from one log or many: how many, and the first few by name. Empty: none. `count`: how many there are, where
/// that is more than are listed.
std::string in_words(const std::vector<RejectedRow>& rows, std::uint64_t count = 0);

/// What was wrong with recordings, and what was done about it.
struct DataQuality {
  std::vector<RejectedRow> refused;
  std::vector<std::string> notes;  ///< sentences
  struct Excluded {
    std::string log, why;  ///< why goes on after the name
  };
  std::vector<Excluded> excluded;  ///< recordings as a whole
};

/// A line each: the rows that were refused, the notes, the recordings that were left out.
std::vector<std::string> lines_of(const DataQuality& data_quality);

/// Of a log's rows, more than this share cannot be left out: what is left would be another recording.
inline constexpr double kMostRefused = 0.05;

}  // namespace furcula::log
