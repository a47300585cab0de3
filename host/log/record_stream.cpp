// CSV records, see record_stream.hpp.
#include "host/log/record_stream.hpp"

#include <algorithm>
#include <cstring>

#include "host/core/error.hpp"

namespace furcula::log {

RecordStream::RecordStream(core::ByteSource& source, std::string name)
    : source_(source), name_(std::move(name)), buffer_(std::size_t{1} << 16) {
  // What ends a line is seen in the first 64 KiB.
  while (end_ < buffer_.size() && std::memchr(buffer_.data(), '\n', end_) == nullptr && fill()) {
  }
  if (std::memchr(buffer_.data(), '\n', end_) == nullptr &&
      std::memchr(buffer_.data(), '\r', end_) != nullptr)
    line_end_ = '\r';
}

/// The record of so many bytes from begin_ on, which goes behind it and its line end. A serial line's LF CR and CR CR LF are line ends, too.
inline std::string_view RecordStream::cut(std::size_t size, std::size_t line_end) {
  record_ = begin_;
  begin_ += size + line_end;
  std::string_view record{buffer_.data() + record_, size};
  while (!record.empty() && record.back() == '\r') record.remove_suffix(1);
  while (!record.empty() && record.front() == '\r') record.remove_prefix(1);
  return record;
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
  open_quote_ = false;
  fault_ = nullptr;
  // As a rule a line is there as a whole, and has no quotes.
  const char* const begin = buffer_.data() + begin_;
  if (const auto* const end = static_cast<const char*>(std::memchr(begin, line_end_, end_ - begin_));
      end != nullptr) {
    const auto size = static_cast<std::size_t>(end - begin);
    if (size <= kLongestLine && std::memchr(begin, '"', size) == nullptr) {
      ++next_line_;
      ended_ = true;
      first_line_ = size;
      record = cut(size, 1);
      return true;
    }
  }
  std::size_t searched = 0;  // bytes of this record without its end and without a quote not counted yet
  std::size_t lines = 0;     // line ends within quotes
  bool in_quotes = false;
  for (;;) {
    const char* const from = buffer_.data() + begin_ + searched;
    const std::size_t left = end_ - begin_ - searched;
    const auto* const newline =
        left == 0 ? nullptr : static_cast<const char*>(std::memchr(from, line_end_, left));
    const std::size_t stretch = newline != nullptr ? static_cast<std::size_t>(newline - from) : left;
    // A comment is one line, whatever quotes stand in it.
    if (stretch != 0 && std::memchr(from, '"', stretch) != nullptr &&
        !is_comment({buffer_.data() + begin_, std::min<std::size_t>(2, end_ - begin_)}))
      in_quotes ^= (std::count(from, from + stretch, '"') & 1) != 0;
    searched += stretch;
    if (lines == 0) first_line_ = searched;
    if (first_line_ > kLongestLine) {
      skip_line();
      record = {};
      return true;
    }
    const bool too_long = searched > kLongestLine;
    const bool whole = newline != nullptr && !in_quotes;
    if (!whole && !too_long) {
      if (newline != nullptr) {
        ++searched;  // the line end belongs to a quoted field
        ++lines;
        continue;
      }
      if (fill()) continue;
      if (searched == 0) return false;
    }
    if (whole || !in_quotes) {
      ended_ = newline != nullptr;
      next_line_ += lines + (newline != nullptr ? 1 : 0);
      record = cut(searched, newline != nullptr ? 1 : 0);
      return true;
    }
    // A quote that nothing closes: the line alone.
    open_quote_ = true;
    ended_ = newline != nullptr || lines != 0;
    next_line_ += ended_ ? 1 : 0;
    record = cut(first_line_, ended_ ? 1 : 0);
    return true;
  }
}

void RecordStream::skip_line() {
  fault_ = buffer_[begin_] == '\0' ? "a line of NUL bytes; expected text"
                                   : "the line is longer than 1 MiB; expected a row of a CSV log";
  for (;;) {
    const auto* const newline =
        static_cast<const char*>(std::memchr(buffer_.data() + begin_, line_end_, end_ - begin_));
    begin_ = newline != nullptr ? static_cast<std::size_t>(newline + 1 - buffer_.data()) : end_;
    ended_ = newline != nullptr;
    if (ended_) ++next_line_;
    if (ended_ || !fill()) return;
  }
}

bool RecordStream::first_line_alone(std::string_view& record) {
  if (open_quote_ || next_line_ - line_ < 2) return false;
  begin_ = record_;
  next_line_ = line_ + 1;
  ended_ = true;
  record = cut(first_line_, 1);
  return true;
}

std::string_view RecordStream::ahead(std::size_t size) {
  while (end_ - begin_ < size && fill()) {
  }
  return {buffer_.data() + begin_, std::min(size, end_ - begin_)};
}

void RecordStream::unread() {
  begin_ = record_;
  next_line_ = line_;
}

std::string take_field(std::string_view& rest, bool& more, char separator) {
  const std::string_view blank = separator == '\t' ? " " : separator == ' ' ? "" : " \t";
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

std::vector<std::string> fields_of(std::string_view record, char separator) {
  std::string joined;
  if (separator == ' ') {
    join_blanks(record, joined);
    record = joined;
  }
  std::vector<std::string> fields;
  for (bool more = true; more;) fields.push_back(take_field(record, more, separator));
  return fields;
}

void join_blanks(std::string_view record, std::string& to) {
  to.clear();
  bool in_quotes = false, blank = false;
  for (const char c : record) {
    if (c == '"') in_quotes = !in_quotes;
    if (!in_quotes && (c == ' ' || c == '\t')) {
      blank = true;
      continue;
    }
    if (blank && !to.empty()) to += ' ';
    blank = false;
    to += c;
  }
}

}  // namespace furcula::log
