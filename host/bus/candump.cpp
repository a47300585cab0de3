// candump's lines, see candump.hpp.
#include "host/bus/candump.hpp"

#include <algorithm>
#include <cstdio>

#include "host/bus/candump_screen.hpp"
#include "host/bus/candump_text.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::bus {
namespace {

using core::DataError;
using core::quoted;
using text::hex_value;

/// Days from 1970-01-01 (H. Hinnant, "chrono-compatible low-level date algorithms").
constexpr std::int64_t days_from_civil(std::int64_t y, std::int64_t m, std::int64_t d) {
  y -= m <= 2 ? 1 : 0;
  const std::int64_t era = (y >= 0 ? y : y - 399) / 400, of_era = y - era * 400;
  const std::int64_t of_year = (153 * (m > 2 ? m - 3 : m + 9) + 2) / 5 + d - 1;
  return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}
static_assert(days_from_civil(1970, 1, 1) == 0 && days_from_civil(2000, 3, 1) == 11017);

/// `candump -tA`: 2024-11-27 04:18:00.000123. The zone is not written, and only differences matter.
bool date_to_ns(std::string_view t, std::int64_t& ns) {
  constexpr std::string_view kForm = "dddd-dd-dd dd:dd:dd";
  if (t.size() <= kForm.size()) return false;
  for (std::size_t i = 0; i < kForm.size(); ++i)
    if (kForm[i] == 'd' ? t[i] < '0' || t[i] > '9' : t[i] != kForm[i]) return false;
  const auto number = [&](std::size_t at, std::size_t n) {
    std::int64_t value = 0;
    for (const char c : t.substr(at, n)) value = 10 * value + (c - '0');
    return value;
  };
  const std::int64_t year = number(0, 4), month = number(5, 2), day = number(8, 2);
  std::int64_t part_ns = 0;
  if (year < 1970 || year > 2095 || month < 1 || month > 12 || day < 1 || day > 31 ||
      !text::seconds_to_ns("0" + std::string(t.substr(kForm.size())), part_ns))
    return false;
  const std::int64_t s =
      ((days_from_civil(year, month, day) * 24 + number(11, 2)) * 60 + number(14, 2)) * 60 + number(17, 2);
  ns = s * 1'000'000'000 + part_ns;
  return true;
}

std::int64_t parse_time(std::string_view stamp) {
  std::int64_t ns = 0;
  if (!text::seconds_to_ns(stamp, ns) && !date_to_ns(stamp, ns))
    throw DataError("time " + quoted(stamp) +
                    "; expected seconds with 1 to 9 decimals, as in (1436509052.249713)");
  return ns;
}

/// Bytes of two digits each, with a point between them or without.
bool take_bytes(std::string_view digits, Frame& frame) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < digits.size(); i += 2) {
    if (n != 0 && digits[i] == '.') ++i;
    if (i + 1 >= digits.size() || n == frame.data.size()) return false;
    const int high = hex_value(digits[i]), low = hex_value(digits[i + 1]);
    if (high < 0 || low < 0) return false;
    frame.data[n++] = static_cast<std::uint8_t>(high << 4 | low);
  }
  frame.size = static_cast<std::uint8_t>(n);
  return true;
}

/// `candump -8`: "_9" to "_F" behind 8 bytes, or behind a remote frame's 8, is the raw length code.
void take_raw_length(std::string_view& data) {
  const std::size_t at = data.size() - 2;
  if (data.size() >= 3 && data[at] == '_' && hex_value(data[at + 1]) > 8) data.remove_suffix(2);
}

void parse_remote(std::string_view data, Frame& frame) {
  frame.remote = true;
  std::string_view size = data.substr(1);
  take_raw_length(size);
  if (size.size() > 1 || (size.size() == 1 && (size[0] < '0' || size[0] > '8')))
    throw DataError("remote frame " + quoted(data) + "; expected R, or R and a length from 0 to 8");
  frame.size = size.empty() ? std::uint8_t{0} : static_cast<std::uint8_t>(size[0] - '0');
}

/// CAN FD: "#", a digit of flags and up to 64 bytes; CAN XL: flags, type and acceptance field, with colons.
bool is_longer(std::string_view data) {
  if (data.starts_with('#')) return data.size() >= 2 && text::all_hex(data.substr(1, 1));
  return data.size() > 15 && data[2] == ':' && data[5] == ':' && data[14] == '#';
}

void parse_log_frame(std::string_view word, std::size_t hash, LogFrame& out) {
  std::string_view data = word.substr(hash + 1);
  out.longer = is_longer(data);
  if (out.longer) {
    // Of CAN XL the id is one of 11 bits, behind the two digits of a virtual network.
    const std::string_view id = word.substr(0, hash);
    text::parse_id(id.size() == 5 ? id.substr(2) : id, out);
    const std::string_view rest = data.substr(data.find('#') + 1);
    if (rest.find_first_not_of("0123456789ABCDEFabcdef.") != rest.npos)
      throw DataError("data " + quoted(data) + "; expected hexadecimal digits");
    return;
  }
  text::parse_id(word.substr(0, hash), out);
  if (data.starts_with('R')) return parse_remote(data, out.frame);
  const std::string_view whole = data;
  if (data.size() > 2) take_raw_length(data);
  if (!take_bytes(data, out.frame))
    throw DataError("data " + quoted(whole) + "; expected up to 8 bytes of two hexadecimal digits each");
}

/// `candump -x`: the direction, and on a screen two signs of a CAN FD frame's flags.
bool is_direction(std::string_view word) { return word == "RX" || word == "TX"; }

}  // namespace

TimeFrom parse_candump(std::string_view line, LogFrame& out) {
  std::string_view rest = line;
  text::skip_spaces(rest);
  out.frame = Frame{};
  out.error = out.longer = false;
  TimeFrom stamp = TimeFrom::none;
  std::string_view time;
  if (rest.starts_with('(')) {
    const std::size_t close = rest.find(')');
    if (close == rest.npos) throw DataError(quoted(line) + "; expected (SECONDS) INTERFACE ID#DATA");
    time = rest.substr(1, close - 1);
    out.time_ns = parse_time(time);
    stamp = TimeFrom::absolute;
    rest.remove_prefix(close + 1);
  }
  const std::string_view interface = text::take_word(rest);
  text::skip_spaces(rest);
  if (rest.empty() && stamp == TimeFrom::none)
    throw DataError(quoted(line) + "; expected (SECONDS) INTERFACE ID#DATA");
  // "read: Network is down", "can0: interface down".
  if (stamp == TimeFrom::none && interface.ends_with(':'))
    throw DataError(
        quoted(line) +
        " is a program's message, not a frame; if the interface failed there, frames are missing: "
        "look at it with ip -details -statistics link show can0, and record again");
  if (rest.empty())
    throw DataError("interface " + quoted(interface) +
                    "; expected a name of up to 64 characters and a frame");
  text::parse_interface(interface, out);
  const std::string_view behind = rest;
  const std::string_view word = text::take_word(rest);
  if (const std::size_t hash = word.find('#'); hash != word.npos && stamp != TimeFrom::none) {
    text::skip_spaces(rest);
    if (!rest.empty() && rest != "R" && rest != "T")  // -x
      throw DataError(quoted(rest) + " after the frame; expected nothing");
    parse_log_frame(word, hash, out);
    return stamp;
  }
  // Without a time it is a screen's line if it has an id.
  if (stamp == TimeFrom::none && !is_direction(word) &&
      !(text::all_hex(word) && (word.size() == 3 || word.size() == 8)))
    throw DataError(quoted(line) + "; expected (SECONDS) INTERFACE ID#DATA");
  text::skip_spaces(rest);
  if (rest.empty()) throw DataError("frame " + quoted(word) + "; expected ID#DATA");
  if (is_direction(word)) {
    for (int i = 0; i < 2; ++i)
      if (text::take_word(rest).size() != 1)
        throw DataError(quoted(behind) + "; expected RX or TX, two signs, and a frame");
    parse_candump_screen(rest, out);
  } else {
    parse_candump_screen(behind, out);
  }
  // Seconds since 1970 have ten digits there, differences three or a few more.
  if (stamp == TimeFrom::absolute && std::min(time.find('.'), time.size()) < 10) stamp = TimeFrom::relative;
  return stamp;
}

LogFrame parse_candump(std::string_view line) {
  LogFrame out;
  parse_candump(line, out);
  return out;
}

std::string format_candump(const LogFrame& f) {
  const auto s = static_cast<long long>(f.time_ns / 1'000'000'000),
             ns = static_cast<long long>(f.time_ns % 1'000'000'000);
  const bool whole_us = ns % 1000 == 0;
  char buffer[128];
  std::snprintf(buffer, sizeof buffer, "(%010lld.%0*lld) %.64s %0*X#", s, whole_us ? 6 : 9,
                whole_us ? ns / 1000 : ns, f.interface.c_str(), f.frame.extended || f.error ? 8 : 3,
                static_cast<unsigned>(f.frame.id | (f.error ? text::kErrorFlag : 0u)));
  std::string out = buffer;
  if (f.frame.remote) {
    out += 'R';
    if (f.frame.size != 0) out += static_cast<char>('0' + f.frame.size);
  } else {
    for (std::size_t i = 0; i < f.frame.size; ++i) {
      std::snprintf(buffer, sizeof buffer, "%02X", static_cast<unsigned>(f.frame.data[i]));
      out += buffer;
    }
  }
  return out + "\n";
}

}  // namespace furcula::bus
