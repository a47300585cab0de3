// The map file (`--map MAP.toml`): which column of a foreign log is which of ours, with scale and offset, or a
// constant in place of one; and how the foreign log writes its numbers.
#pragma once

#include <map>
#include <string>
#include <string_view>

namespace furcula::log {

/// ours = theirs * scale + offset
struct MappedColumn {
  std::string column;  ///< the foreign log's name; empty: none, ours is the constant `offset`
  double scale = 1.0;
  double offset = 0.0;
};

struct ColumnMap {
  std::string path;                             ///< where it was read from, for messages
  std::string rig;                              ///< one of kRigs
  std::map<std::string, MappedColumn> columns;  ///< our name -> theirs
  char separator = ',';                         ///< between columns: ',', ';' or a tab
  char decimal = '.';                           ///< '.' or ','
};

/// Reads a map file. @throws DataError: not readable, not TOML, unknown rig or column, wrong type, scale 0,
/// a decimal sign that separates the columns, too.
ColumnMap read_column_map(const std::string& path);

/// The same on text; `name` stands for the path in messages.
ColumnMap parse_column_map(std::string_view text, const std::string& name);

}  // namespace furcula::log
