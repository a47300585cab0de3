// Cuts a stream of bytes into the records of a CSV file (RFC 4180); its memory is bounded by kLongestLine.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/core/byte_source.hpp"

namespace furcula::log {

inline constexpr std::size_t kLongestLine = std::size_t{1} << 20;

class RecordStream {
 public:
  RecordStream(core::ByteSource& source, std::string name);

  /// The next record without its line end (LF or CRLF), or false at the end of the file. A record that has
  /// quotes may hold line ends, unless it begins with '#'. A byte order mark at the file's start is skipped.
  /// The view lives until the next call.
  /// @throws core::DataError: line above kLongestLine, quote that is not closed.
  bool next(std::string_view& record);

  std::uint64_t line() const { return line_; }  ///< at which the last record began, from 1
  bool ended() const { return ended_; }         ///< whether a line end stood after it
  const std::string& name() const { return name_; }

 private:
  bool fill();  // more bytes behind those not yet used; false at the end of the file

  core::ByteSource& source_;
  std::string name_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // of what is not yet used
  std::size_t end_ = 0;
  std::uint64_t line_ = 0;
  std::uint64_t next_line_ = 1;
  bool ended_ = true;
  bool at_end_ = false;
};

/// One field of a record that is not a plain number: trimmed, or without its quotes. `rest` moves behind the
/// field and its separator; `more` says whether there was one.
std::string take_field(std::string_view& rest, bool& more, char separator = ',');

}  // namespace furcula::log
