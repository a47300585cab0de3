// candump's screen, see candump_screen.hpp.
#include "host/bus/candump_screen.hpp"

#include "host/bus/candump_text.hpp"

namespace furcula::bus {
namespace {

using core::DataError;
using core::quoted;

bool is_binary(std::string_view word) {
  return word.size() == 8 &&
         std::all_of(word.begin(), word.end(), [](char c) { return c == '0' || c == '1'; });
}

/// The next byte: two hexadecimal digits, or eight binary ones.
std::uint8_t take_byte(std::string_view& rest) {
  const std::size_t end = std::min(rest.find_first_of(" \t`"), rest.size());
  const std::string_view word = rest.substr(0, end);
  rest.remove_prefix(end);
  unsigned byte = 0;
  if (word.size() == 2 && text::all_hex(word)) {
    byte = static_cast<unsigned>(text::hex_value(word[0]) << 4 | text::hex_value(word[1]));
  } else if (is_binary(word)) {
    for (const char c : word) byte = byte << 1 | static_cast<unsigned>(c - '0');
  } else {
    throw DataError("data " + quoted(word) +
                    "; expected as many bytes of two hexadecimal digits as [ ] says");
  }
  return static_cast<std::uint8_t>(byte);
}

void parse_data(std::string_view rest, Frame& frame) {
  bool swapped = false;
  for (std::size_t i = 0; i < frame.size; ++i) {
    if (i != 0 && rest.starts_with('`')) {
      swapped = true;
      rest.remove_prefix(1);
    }
    text::skip_spaces(rest);
    frame.data[i] = take_byte(rest);
  }
  if (swapped) std::reverse(frame.data.begin(), frame.data.begin() + frame.size);
  // -a: the bytes as characters, between quotes or, where bytes are swapped, these.
  text::skip_spaces(rest);
  if (!rest.empty() && rest.front() != '\'' && rest.front() != '`' && rest != "ERRORFRAME")
    throw DataError(quoted(rest) + " after " + std::to_string(frame.size) + " bytes; expected nothing");
}

}  // namespace

void parse_candump_screen(std::string_view rest, LogFrame& out) {
  text::parse_id(text::take_word(rest), out);
  const std::string_view length = text::take_word(rest);
  // -8: a raw length code of 9 to 15, of 8 bytes, in {}.
  const bool raw = length.size() == 3 && length.front() == '{' && length.back() == '}';
  const bool plain = length.size() >= 3 && length.front() == '[' && length.back() == ']';
  const std::string_view digits = raw || plain ? length.substr(1, length.size() - 2) : std::string_view();
  if (plain && digits.size() >= 2 && digits.size() <= 4 && text::all_digits(digits)) {
    out.longer = true;
    return;
  }
  const int n = digits.size() == 1 ? text::hex_value(digits[0]) : -1;
  if (n < 0 || (plain && n > 8))
    throw DataError("length " + quoted(length) + "; expected bytes of data, as in [8]");
  out.frame.size = static_cast<std::uint8_t>(std::min(n, 8));
  text::skip_spaces(rest);
  if (rest == "remote request") {
    out.frame.remote = true;
    return;
  }
  parse_data(rest, out.frame);
}

}  // namespace furcula::bus
