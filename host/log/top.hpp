// What stands above a log's rows: Excel's line "sep=;", comments with metadata, and the first record.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/log/reader.hpp"
#include "host/log/record_stream.hpp"
#include "host/log/wanted.hpp"

namespace furcula::log {

/// Above the rows: Excel's line "sep=;", comments, and the first record that is neither blank nor a comment.
struct Top {
  struct Comment {
    std::string text;  ///< behind its sign
    std::uint64_t line;
  };
  std::optional<char> separator;  ///< that "sep=" names
  std::vector<Comment> comments;  ///< the last few
  std::size_t comment_bytes = 0;  ///< of all of them
  std::string row;                ///< the first record
  std::string flaw;               ///< for which it can be no header row, as a message; empty: none
  std::string not_utf8;           ///< what was not, as a message; empty: all was UTF-8
  std::string
      other_text;  ///< what the file would be if it has no header row (file_kind.hpp), as a message; empty: not known
};

/// Reads up to and with the first record that is neither blank nor a comment. The comments go into the header. `wanted` is what the log must
/// have, of which rig; null: any. A line with '%' or "//" that begins with the name of a column asked for is no comment.
/// @throws core::DataError: nothing there, no text but a known kind of file, a format or rig that is not ours.
Top read_top(RecordStream& records, const Wanted* wanted, LogHeader& header);

/// Takes a comment above the header row. @throws core::DataError: a format or rig that is not ours, too much of it.
void take_comment(std::string_view comment, const RecordStream& records, const Wanted* wanted, Top& top,
                  LogHeader& header);

/// What stands behind a comment's sign.
std::string_view comment_text(std::string_view comment);

/// Without blanks at the ends.
std::string_view trimmed(std::string_view text);

/// "run.csv:12: ", of the last record.
std::string place(const RecordStream& records);

}  // namespace furcula::log
