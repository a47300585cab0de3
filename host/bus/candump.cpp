// candump's logs, see candump.hpp.
#include "host/bus/candump.hpp"

#include <algorithm>
#include <cstdio>
#include <cstring>

#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bus {
namespace {

using core::DataError;
using core::quoted;

// linux/can.h: in a log an error frame has this bit in an id of 8 digits.
constexpr std::uint32_t kErrorFlag = 0x20000000, kLargestExtended = 0x1fffffff, kLargestStandard = 0x7ff;

int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

bool all_digits(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

std::int64_t parse_time(std::string_view text) {
  const std::size_t point = std::min(text.find('.'), text.size());
  const std::string_view seconds = text.substr(0, point),
                         rest = text.substr(std::min(point + 1, text.size()));
  // 12 digits of seconds are above any clock and far below what the microseconds overflow at.
  if (seconds.empty() || seconds.size() > 12 || rest.size() != 6 || !all_digits(seconds) || !all_digits(rest))
    throw DataError("time " + quoted(text) +
                    "; expected seconds with six decimals, as in (1436509052.249713)");
  std::int64_t us = 0;
  for (const char c : seconds) us = 10 * us + (c - '0');
  for (const char c : rest) us = 10 * us + (c - '0');
  return us;
}

void parse_id(std::string_view text, LogFrame& out) {
  std::uint32_t id = 0;
  const bool hex = std::all_of(text.begin(), text.end(), [](char c) { return hex_value(c) >= 0; });
  if (!hex || (text.size() != 3 && text.size() != 8))
    throw DataError("id " + quoted(text) + "; expected 3 hexadecimal digits, or 8 for an extended one");
  for (const char c : text) id = id << 4 | static_cast<std::uint32_t>(hex_value(c));
  out.frame.extended = text.size() == 8;
  out.error = out.frame.extended && (id & kErrorFlag) != 0;
  if (out.error) id &= ~kErrorFlag;
  if (id > (out.frame.extended ? kLargestExtended : kLargestStandard))
    throw DataError("id " + quoted(text) + "; expected at most " + (out.frame.extended ? "1FFFFFFF" : "7FF"));
  out.frame.id = id;
}

void parse_data(std::string_view text, Frame& frame) {
  if (text.starts_with('#'))
    throw DataError("a CAN FD frame ('##'); expected classical CAN, of 8 bytes at most");
  if (text.starts_with('R')) {
    frame.remote = true;
    const std::string_view size = text.substr(1);
    if (size.size() > 1 || (size.size() == 1 && (size[0] < '0' || size[0] > '8')))
      throw DataError("remote frame " + quoted(text) + "; expected R, or R and a length from 0 to 8");
    frame.size = size.empty() ? std::uint8_t{0} : static_cast<std::uint8_t>(size[0] - '0');
    return;
  }
  if (text.size() % 2 != 0 || text.size() > 2 * frame.data.size() ||
      !std::all_of(text.begin(), text.end(), [](char c) { return hex_value(c) >= 0; }))
    throw DataError("data " + quoted(text) + "; expected up to 8 bytes of two hexadecimal digits each");
  frame.size = static_cast<std::uint8_t>(text.size() / 2);
  for (std::size_t i = 0; i < frame.size; ++i)
    frame.data[i] = static_cast<std::uint8_t>(hex_value(text[2 * i]) << 4 | hex_value(text[2 * i + 1]));
}

}  // namespace

LogFrame parse_candump(std::string_view line) {
  const std::size_t close = line.find(") ");
  if (!line.starts_with('(') || close == line.npos)
    throw DataError(quoted(line) + "; expected (SECONDS) INTERFACE ID#DATA");
  LogFrame out;
  out.time_us = parse_time(line.substr(1, close - 1));
  std::string_view rest = line.substr(close + 2);
  const std::size_t space = rest.find(' ');
  const std::string_view interface = rest.substr(0, space);
  if (space == rest.npos || interface.empty() || interface.size() > 15 ||
      !std::all_of(interface.begin(), interface.end(), [](char c) { return c > ' ' && c < 0x7f; }))
    throw DataError("interface " + quoted(interface) +
                    "; expected a name of up to 15 characters and a frame");
  out.interface = interface;
  rest.remove_prefix(space + 1);
  // `candump -x` appends the direction.
  if (rest.ends_with(" R") || rest.ends_with(" T")) rest.remove_suffix(2);
  const std::size_t hash = rest.find('#');
  if (hash == rest.npos) throw DataError("frame " + quoted(rest) + "; expected ID#DATA");
  parse_id(rest.substr(0, hash), out);
  parse_data(rest.substr(hash + 1), out.frame);
  return out;
}

std::string format_candump(const LogFrame& f) {
  char text[80];
  std::snprintf(text, sizeof text, "(%010lld.%06lld) %.15s %0*X#",
                static_cast<long long>(f.time_us / 1000000), static_cast<long long>(f.time_us % 1000000),
                f.interface.c_str(), f.frame.extended ? 8 : 3,
                static_cast<unsigned>(f.frame.id | (f.error ? kErrorFlag : 0u)));
  std::string out = text;
  if (f.frame.remote) {
    out += 'R';
    if (f.frame.size != 0) out += static_cast<char>('0' + f.frame.size);
  } else {
    for (std::size_t i = 0; i < f.frame.size; ++i) {
      std::snprintf(text, sizeof text, "%02X", static_cast<unsigned>(f.frame.data[i]));
      out += text;
    }
  }
  return out + "\n";
}

bool CandumpReader::next_line(std::string_view& line) {
  for (;;) {
    const char* const from = buffer_.data() + begin_;
    const auto* const newline = static_cast<const char*>(std::memchr(from, '\n', end_ - begin_));
    if (newline != nullptr || (at_end_ && begin_ < end_)) {
      ++line_;
      const std::size_t size = newline != nullptr ? static_cast<std::size_t>(newline - from) : end_ - begin_;
      line = {from, size};
      begin_ += newline != nullptr ? size + 1 : size;
      if (line.ends_with('\r')) line.remove_suffix(1);
      return true;
    }
    if (at_end_) return false;
    std::memmove(buffer_.data(), from, end_ - begin_);
    end_ -= begin_;
    begin_ = 0;
    if (end_ == buffer_.size())
      throw DataError(name_ + ":" + std::to_string(line_ + 1) + ": a line of more than " +
                      std::to_string(buffer_.size()) + " characters; expected (SECONDS) INTERFACE ID#DATA");
    const std::size_t n = source_.read(buffer_.data() + end_, buffer_.size() - end_);
    at_end_ = n == 0;
    end_ += n;
  }
}

bool CandumpReader::next(LogFrame& frame) {
  std::string_view line;
  do {
    if (!next_line(line)) return false;
  } while (line.empty());
  try {
    frame = parse_candump(line);
  } catch (const DataError& e) {
    throw DataError(name_ + ":" + std::to_string(line_) + ": " + e.what());
  }
  return true;
}

}  // namespace furcula::bus
