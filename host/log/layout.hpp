// What stands where in a log: its metadata and header row, resolved against the rig's columns and the map.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/log/column_map.hpp"
#include "host/log/machine_types.hpp"
#include "host/log/reader.hpp"
#include "host/log/record_stream.hpp"

namespace furcula::log {

/// A column of the file in one of ours.
struct Source {
  std::size_t column;  ///< index among the file's columns
  double scale;
};

/// One of our columns, and how it comes from the file's.
struct Channel {
  std::string name;
  ColumnKind kind;
  bool known;                   ///< to the rig: must hold finite numbers
  std::vector<Source> sources;  ///< which are added; none: it is `offset` in every row
  bool mapped;
  double offset;
  bool required;  ///< by the rig

  /// A row that lacks it may be used, if most have it.
  bool optional() const { return !required && !mapped; }
};

struct Layout {
  LogHeader header;
  std::vector<std::string> file_columns;  ///< as the file calls them
  std::vector<bool> needed;               ///< per file column: a known channel comes from it
  std::vector<Channel> channels;          ///< in the order of header.columns
  std::size_t time_channel = 0;
  char separator = ',';  ///< ' ': runs of blanks
  char decimal = '.';
  std::vector<std::string> notes;  ///< what is odd about the header row, in sentences
  std::string
      rows_hint;  ///< what the first rows' number of fields suggests where it is not the header's; to follow a message
  std::string time_hint;  ///< the same of a time that stands still
};

/// Reads up to and with the header row, and a row of units below it. Without a separator in the map or a first line `sep=;` it is seen in
/// the header row. A header row may stand in a comment (numpy.savetxt). Columns that nothing asks for may lack a name or stand twice.
/// @throws DataError, see read_log.
Layout read_layout(RecordStream& records, const MachineType& rig, const ColumnMap* map);

/// The rig that a `# machine_type:` line before the header row names, or nothing. @throws DataError, see rig_line.
std::string read_rig_line(RecordStream& records);

}  // namespace furcula::log
