// Cuts a stream of bytes into the records of a CSV file (RFC 4180); its memory is bounded by kLongestLine.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/core/byte_source.hpp"
#include "host/log/utf8_source.hpp"

namespace furcula::log {

inline constexpr std::size_t kLongestLine = std::size_t{1} << 20;

/// Whether a line is a comment: of Python and the shell, of MATLAB, of C++.
constexpr bool is_comment(std::string_view line) {
  return !line.empty() && (line[0] == '#' || line[0] == '%' || (line[0] == '/' && line.starts_with("//")));
}

class RecordStream {
 public:
  /// The source's text may be UTF-8 or UTF-16 (utf8_source.hpp). Lines end in LF or CRLF, or in CR where the file begins without any LF.
  RecordStream(core::ByteSource& source, std::string name);

  /// The next record without its line end, or false at the end of the file. A record that has
  /// quotes may hold line ends, unless it is a comment. A quote that is not closed within kLongestLine or by the end of the file is a
  /// character like any other: the record is the line, and open_quote() says so.
  /// Of a line above kLongestLine the record is empty, and fault() says what it is. The view lives until the next call.
  bool next(std::string_view& record);

  /// Takes a record that holds line ends back to its first line: the next one begins with the second line. False where it is one line.
  bool first_line_alone(std::string_view& record);

  /// The next call of next() gives the last record again.
  void unread();

  /// What comes next in the file: `size` bytes, or all there are. The view lives until the next call.
  std::string_view ahead(std::size_t size);

  std::uint64_t line() const { return line_; }  ///< at which the last record began, from 1
  std::uint64_t next_line() const { return next_line_; }
  bool ended() const { return ended_; }            ///< whether a line end stood after it
  bool open_quote() const { return open_quote_; }  ///< whether it has a quote that is not closed
  const char* fault() const { return fault_; }     ///< of a line that is no record; null: it is one
  const std::string& name() const { return name_; }

 private:
  bool fill();  // more bytes behind those not yet used; false at the end of the file
  void skip_line();
  std::string_view cut(std::size_t size, std::size_t line_end);

  Utf8Source source_;
  std::string name_;
  std::vector<char> buffer_;
  std::size_t begin_ = 0;  // of what is not yet used
  std::size_t end_ = 0;
  std::size_t record_ = 0;      // where the last record begins
  std::size_t first_line_ = 0;  // length of its first line, without the line end
  std::uint64_t line_ = 0;
  std::uint64_t next_line_ = 1;
  char line_end_ = '\n';
  bool ended_ = true;
  bool open_quote_ = false;
  const char* fault_ = nullptr;
  bool at_end_ = false;
};

/// One field of a record that is not a plain number: trimmed, or without its quotes. `rest` moves behind the
/// field and its separator; `more` says whether there was one.
std::string take_field(std::string_view& rest, bool& more, char separator = ',');

/// All fields of a record; with the separator ' ' those between runs of blanks and tabs.
std::vector<std::string> fields_of(std::string_view record, char separator);

/// A record whose columns stand between runs of blanks and tabs, with one blank for each run and none at the ends; what stands in
/// quotes is left. `to` is overwritten.
void join_blanks(std::string_view record, std::string& to);

}  // namespace furcula::log
