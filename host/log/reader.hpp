// Reads `furcula-log/1` (docs/contracts.md, section 1): into memory, or row by row in bounded memory. A path may name a ROS 2 bag, too: it is
// read as the log that host/bags/bag_text.hpp makes of it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "host/core/error.hpp"
#include "host/log/column_map.hpp"
#include "host/log/log.hpp"
#include "host/log/time_stamps.hpp"

namespace furcula::log {

/// What stands above the rows.
struct LogHeader {
  std::map<std::string, std::string> metadata;  ///< the `# key: value` lines
  std::vector<std::string> columns;  ///< our names (after the map), in the order of the file's rows
  std::uint64_t line = 0;            ///< of the header row
};

struct LogSummary {
  LogHeader header;
  /// Columns that the rig does not know and that hold something else than finite numbers; not in a Log.
  std::vector<std::string> ignored_columns;
  std::uint64_t rows = 0;
  double duration_s = 0.0;         ///< last time minus first
  double interval_min_s = 0.0;     ///< between neighbouring rows; 0 for a single row
  double interval_median_s = 0.0;  ///< to 0.1 %
  double interval_mean_s = 0.0;
  double interval_max_s = 0.0;
  std::vector<RejectedRow> refused;             ///< rows that were left out, the first kMostNamed of them
  std::uint64_t rejected_rows = 0;              ///< how many there are
  std::vector<std::string> notes;               ///< what else was done to it
  std::map<std::string, std::string> unusable;  ///< optional columns that were left out, and why
  TimeStamps stamps;                            ///< what they imply
  bool last_row_ends = true;  ///< false: no line end after the last row, so its last number may have been cut
};

/// Of a log whose rows are not kept.
inline constexpr std::size_t kMostNamed = 1000;

/// Reads a log into memory. `rig` is that of the model's kind; the `# machine_type:` line, if there, must agree. Empty: the log's own, or tree of a bag
/// with joint states.
///
/// A row that is ragged or torn, holds something else than finite numbers, an empty cell or a flag that is not 0 or 1, or whose time does not
/// increase (time_order.hpp) is left out and named in `refused`. If there are more of them than a twentieth of the rows (kMostRefused), the
/// log is refused. An optional column that lacks a number in more than that share of the rows is left out in place of the rows.
/// @throws core::DataError naming file, line, column, value and what was expected: not readable, empty, no rows,
/// missing required column, wrong unit suffix, a column that is asked for and stands twice, too many bad rows.
Log read_log(const std::string& path, const std::string& rig, const ColumnMap* map = nullptr);

/// Checks a log as read_log does, in memory that does not grow with the file.
LogSummary check_log(const std::string& path, const std::string& rig, const ColumnMap* map = nullptr);

/// The rig that the log's own `# machine_type:` line names, or nothing where it has none; of a bag with joint states tree. Reads up to the header row.
/// @throws core::DataError naming file and line: not readable, empty, no such rig.
std::string rig_line(const std::string& path, const ColumnMap* map = nullptr);

/// The message of a log that names no rig.
std::string no_rig(const std::string& path);

/// The names of a log's columns, after the map. Reads up to the header row. @throws core::DataError, as read_log does of a header row.
std::vector<std::string> column_names(const std::string& path, const std::string& rig,
                                      const ColumnMap* map = nullptr);

/// As read_log, on text or a bag's bytes; `name` stands for the path in messages.
Log parse_log(std::string_view text, const std::string& name, const std::string& rig,
              const ColumnMap* map = nullptr);

}  // namespace furcula::log
