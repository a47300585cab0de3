// What stands where in a log: its metadata and header row, resolved against the rig's columns and the map.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/log/column_map.hpp"
#include "host/log/reader.hpp"
#include "host/log/record_stream.hpp"
#include "host/log/rigs.hpp"

namespace furcula::log {

inline constexpr std::size_t kConstant = static_cast<std::size_t>(-1);

/// One of our columns, and how it comes from the file's.
struct Channel {
  std::string name;
  ColumnKind kind;
  bool known;          ///< to the rig: must hold finite numbers
  std::size_t source;  ///< index among the file's columns; kConstant: none, it is `offset` in every row
  bool mapped;
  double scale;
  double offset;
};

struct Layout {
  LogHeader header;
  std::vector<std::string> file_columns;  ///< as the file calls them
  std::vector<bool> needed;               ///< per file column: a known channel comes from it
  std::vector<Channel> channels;          ///< in the order of header.columns
  std::size_t time_channel = 0;
  char separator = ',';
  char decimal = '.';
};

/// Reads up to and with the header row. @throws DataError, see read_log.
Layout read_layout(RecordStream& records, const RigInfo& rig, const ColumnMap* map);

/// The rig that a `# rig:` line before the header row names, or nothing. @throws DataError, see rig_line.
std::string read_rig_line(RecordStream& records);

}  // namespace furcula::log
