// CSV records, see record_stream.hpp.
#include "host/log/record_stream.hpp"

#include <algorithm>
#include <cstring>

#include "host/core/error.hpp"

namespace furcula::log {

RecordStream::RecordStream(core::ByteSource& source, std::string name)
    : source_(source), name_(std::move(name)), buffer_(std::size_t{1} << 16) {
  while (end_ < 3 && fill()) {
  }
  if (end_ >= 3 && std::memcmp(buffer_.data(), "\xEF\xBB\xBF", 3) == 0) begin_ = 3;
}

bool RecordStream::fill() {
  if (at_end_) return false;
  if (begin_ > 0) {
    std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(2 * buffer_.size());
  const std::size_t n = source_.read(buffer_.data() + end_, buffer_.size() - end_);
  at_end_ = n == 0;
  end_ += n;
  return n != 0;
}

bool RecordStream::next(std::string_view& record) {
  line_ = next_line_;
  std::size_t searched = 0;  // bytes of this record without its end and without a quote not counted yet
  bool in_quotes = false;
  for (;;) {
    const char* const from = buffer_.data() + begin_ + searched;
    const std::size_t left = end_ - begin_ - searched;
    const auto* const newline = left == 0 ? nullptr : static_cast<const char*>(std::memchr(from, '\n', left));
    const std::size_t stretch = newline != nullptr ? static_cast<std::size_t>(newline - from) : left;
    // A comment is one line, whatever quotes stand in it.
    if (stretch != 0 && std::memchr(from, '"', stretch) != nullptr && buffer_[begin_] != '#')
      in_quotes ^= (std::count(from, from + stretch, '"') & 1) != 0;
    searched += stretch;
    if (searched > kLongestLine)
      throw core::DataError(name_ + ":" + std::to_string(line_) +
                            (buffer_[begin_] == '\0' ? ": a line of NUL bytes; expected text"
                             : in_quotes ? ": a quote is not closed within 1 MiB; expected a closing '\"'"
                                         : ": the line is longer than 1 MiB; expected a row of a CSV log"));
    if (newline == nullptr) {
      if (fill()) continue;
      if (searched == 0) return false;
      if (in_quotes)
        throw core::DataError(name_ + ":" + std::to_string(line_) +
                              ": the file ends within quotes: the last row is torn; expected a closing '\"'");
      ended_ = false;
      record = {buffer_.data() + begin_, searched};
      begin_ += searched;
      return true;
    }
    ++next_line_;
    if (in_quotes) {
      ++searched;  // the line end belongs to a quoted field
      continue;
    }
    record = {buffer_.data() + begin_, searched};
    if (record.ends_with('\r')) record.remove_suffix(1);
    begin_ += searched + 1;
    return true;
  }
}

std::string take_field(std::string_view& rest, bool& more, char separator) {
  const std::string_view blank = separator == '\t' ? " " : " \t";
  const std::size_t first = std::min(rest.find_first_not_of(blank), rest.size());
  std::string field;
  if (first < rest.size() && rest[first] == '"') {
    std::size_t i = first + 1;
    while (i < rest.size() && !(rest[i] == '"' && (i + 1 == rest.size() || rest[i + 1] != '"'))) {
      field += rest[i];
      i += rest[i] == '"' ? 2 : 1;
    }
    // Kept: what stands between the closing quote and the comma makes the field something else.
    const std::size_t comma = std::min(rest.find(separator, std::min(i + 1, rest.size())), rest.size());
    std::string_view tail = rest.substr(std::min(i + 1, comma), comma - std::min(i + 1, comma));
    if (tail.find_first_not_of(blank) != std::string_view::npos) field += tail;
    more = comma < rest.size();
    rest.remove_prefix(std::min(comma + 1, rest.size()));
    return field;
  }
  const std::size_t comma = std::min(rest.find(separator), rest.size());
  const std::size_t last = rest.substr(0, comma).find_last_not_of(blank);
  if (last != std::string_view::npos) field = rest.substr(first, last + 1 - first);
  more = comma < rest.size();
  rest.remove_prefix(std::min(comma + 1, rest.size()));
  return field;
}

}  // namespace furcula::log
