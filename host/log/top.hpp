// What stands above a log's rows: Excel's line "sep=;", comments with metadata, and the first record.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/log/reader.hpp"
#include "host/log/record_stream.hpp"
#include "host/log/rigs.hpp"

namespace furcula::log {

/// Above the rows: Excel's line "sep=;", comments, and the first record that is neither blank nor a comment.
struct Top {
  struct Comment {
    std::string text;  ///< behind the '#'
    std::uint64_t line;
  };
  std::optional<char> separator;  ///< that "sep=" names
  std::vector<Comment> comments;  ///< the last few
  std::string row;                ///< the first record
  std::string not_utf8;           ///< what was not, as a message; empty: all was UTF-8
};

/// Reads up to and with the first record that is neither blank nor a comment. The comments go into the header. `rig` is what the log must be
/// of; null: any. @throws core::DataError: nothing there, no text, a format or rig that is not ours.
Top read_top(RecordStream& records, const RigInfo* rig, LogHeader& header);

/// Without blanks at the ends.
std::string_view trimmed(std::string_view text);

/// "run.csv:12: ", of the last record.
std::string place(const RecordStream& records);

}  // namespace furcula::log
