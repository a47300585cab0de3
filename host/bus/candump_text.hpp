// Pieces of the text of CAN recordings that several formats share.
#pragma once

#include <algorithm>
#include <cstdint>
#include <string_view>

#include "host/bus/candump.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bus::text {

constexpr int hex_value(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return -1;
}

inline bool all_hex(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return hex_value(c) >= 0; });
}
inline bool all_digits(std::string_view text) {
  return std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

inline void skip_spaces(std::string_view& rest) {
  std::size_t n = 0;
  while (n < rest.size() && (rest[n] == ' ' || rest[n] == '\t')) ++n;
  rest.remove_prefix(n);
}

/// The next word of a line; empty at its end.
inline std::string_view take_word(std::string_view& rest) {
  skip_spaces(rest);
  std::size_t n = 0;
  while (n < rest.size() && rest[n] != ' ' && rest[n] != '\t') ++n;
  const std::string_view word = rest.substr(0, n);
  rest.remove_prefix(n);
  return word;
}

/// The latest stamp, in the year 2096: differences and sums of two are then within 64 bits.
inline constexpr std::int64_t kLatestNs = 4'000'000'000'000'000'000;

/// Seconds with 1 to 9 decimals as nanoseconds. false: it is no such text, or later.
inline bool seconds_to_ns(std::string_view text, std::int64_t& ns) {
  const std::size_t point = text.find('.');
  if (point == text.npos || point == 0 || point > 10) return false;
  const std::string_view seconds = text.substr(0, point), rest = text.substr(point + 1);
  if (rest.empty() || rest.size() > 9 || !all_digits(seconds) || !all_digits(rest)) return false;
  std::int64_t whole = 0, part = 0;
  for (const char c : seconds) whole = 10 * whole + (c - '0');
  for (const char c : rest) part = 10 * part + (c - '0');
  for (std::size_t i = rest.size(); i < 9; ++i) part *= 10;
  if (whole >= kLatestNs / 1'000'000'000) return false;
  ns = whole * 1'000'000'000 + part;
  return true;
}

// linux/can.h: in a log an error frame has this bit in an id of 8 digits.
inline constexpr std::uint32_t kErrorFlag = 0x20000000, kLargestExtended = 0x1fffffff,
                               kLargestStandard = 0x7ff;

/// 3 hexadecimal digits, or 8 of an extended id or an error.
inline void parse_id(std::string_view text, LogFrame& out) {
  using core::quoted;
  std::uint32_t id = 0;
  if (!all_hex(text) || (text.size() != 3 && text.size() != 8))
    throw core::DataError("id " + quoted(text) + "; expected 3 hexadecimal digits, or 8 for an extended one");
  for (const char c : text) id = id << 4 | static_cast<std::uint32_t>(hex_value(c));
  out.frame.extended = text.size() == 8;
  out.error = out.frame.extended && (id & kErrorFlag) != 0;
  if (out.error) id &= ~kErrorFlag;
  if (id > (out.frame.extended ? kLargestExtended : kLargestStandard))
    throw core::DataError("id " + quoted(text) + "; expected at most " +
                          (out.frame.extended ? "1FFFFFFF" : "7FF"));
  out.frame.id = id;
}

/// What names the interface that heard a frame.
inline void parse_interface(std::string_view word, LogFrame& out) {
  if (word.empty() || word.size() > 64 ||
      !std::all_of(word.begin(), word.end(), [](char c) { return c > ' ' && c < 0x7f; }))
    throw core::DataError("interface " + core::quoted(word) +
                          "; expected a name of up to 64 characters and a frame");
  out.interface = word;
}

}  // namespace furcula::bus::text
