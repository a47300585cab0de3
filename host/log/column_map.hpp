// The map file (`--map MAP.toml`): which columns of a foreign log are which of ours, with scale and offset, or a
// constant in place of one; and how the foreign log writes its numbers.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace furcula::log {

/// A column of the foreign log in one of ours.
struct MappedPart {
  std::string column;  ///< the foreign log's name
  double scale = 1.0;
};

/// ours = sum of theirs * scale, + offset
struct MappedColumn {
  std::vector<MappedPart> parts;  ///< none: ours is the constant `offset`
  double offset = 0.0;
  std::uint64_t line = 0;  ///< of the map file, for messages
};

/// Columns that it does not name are looked up under their own names.
struct ColumnMap {
  std::string path;                             ///< where it was read from, for messages
  std::string rig;                              ///< one of kMachineTypes; empty: the map does not say
  std::map<std::string, MappedColumn> columns;  ///< our name -> theirs
  std::optional<char>
      separator;  ///< between columns: ',', ';', '|', a tab, or ' ' for runs of blanks; none: seen in the log
  char decimal = '.';   ///< '.' or ','
  std::string topic{};  ///< of a bag, whose messages give the rows; empty: it is chosen
  bool all_topics =
      false;  ///< of a bag, all topics with numbers are read, not only joint states and those that are named
};

/// Reads a map file. @throws DataError: not readable, not TOML, unknown rig or column, wrong type, scale 0,
/// a decimal sign that separates the columns, too.
ColumnMap read_column_map(const std::string& path);

/// The same on text; `name` stands for the path in messages.
ColumnMap parse_column_map(std::string_view text, const std::string& name);

}  // namespace furcula::log
