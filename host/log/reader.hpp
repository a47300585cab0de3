// Reads `furcula-log/1` (docs/contracts.md, section 1): into memory, or row by row in bounded memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/core/error.hpp"
#include "host/log/column_map.hpp"
#include "host/log/log.hpp"

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
  double interval_max_s = 0.0;
  std::vector<RefusedRow> refused;  ///< bad rows that were skipped, where that was asked for
  std::vector<std::string> notes;   ///< what else was done to it
  bool last_row_ends = true;  ///< false: no line end after the last row, so its last number may have been cut
};

/// Called for each row with the values in the order of LogHeader::columns, NaN where an ignored column holds
/// something else than a number, and the line at which it begins.
using RowVisitor = std::function<void(std::span<const double>, std::uint64_t line)>;

/// What becomes of a row that is torn, holds something else than numbers or an empty cell, or whose time does
/// not increase: the log is refused, or the row is left out and told of. Of a twentieth of the rows and more
/// the log is refused all the same. Where rows are skipped a counter of time that wraps (16 or 32 bits of
/// milli- or microseconds) is taken to go on.
enum class BadRows { refused, skipped };

/// Reads a log into memory. `rig` is that of the model's kind; the `# rig:` line, if there, must agree.
/// @throws core::DataError naming file, line, column, value and what was expected: not readable, empty, no rows,
/// missing required column, wrong unit suffix, duplicate column, ragged or torn row, no number, NaN or
/// infinity, flag that is not 0 or 1, time that does not increase, line above 1 MiB.
Log read_log(const std::string& path, const std::string& rig, const ColumnMap* map = nullptr,
             BadRows bad = BadRows::refused);

/// Checks a log as read_log does, in memory that does not grow with the file.
LogSummary check_log(const std::string& path, const std::string& rig, const ColumnMap* map = nullptr,
                     BadRows bad = BadRows::refused);

/// The rig that the log's own `# rig:` line names, or nothing where it has none. Reads up to the header row.
/// @throws core::DataError naming file and line: not readable, empty, no such rig.
std::string rig_line(const std::string& path);

/// Goes through a log row by row, in memory that does not grow with the file; what the two above stand on.
LogSummary visit_log(const std::string& path, const std::string& rig, const ColumnMap* map,
                     const std::function<RowVisitor(const LogHeader&)>& on_header,
                     BadRows bad = BadRows::refused);

/// As read_log, on text; `name` stands for the path in messages.
Log parse_log(std::string_view text, const std::string& name, const std::string& rig,
              const ColumnMap* map = nullptr, BadRows bad = BadRows::refused);

}  // namespace furcula::log
