// A signal's numbers as a DBC file and the documentation have them.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>

#include "furcula/bus/codec.hpp"

namespace furcula::bus {

/// Shortest decimal form that reads back as the same double, without an exponent: parsers of DBC files differ
/// in whether they know exponents, and candied passes over a signal that has one.
inline std::string decimal(double value) {
  char text[400];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::fixed).ptr};
}

/// Physical units for one step of the raw number.
inline double factor(const Signal& s) { return static_cast<double>(s.span) / static_cast<double>(s.counts); }

inline double physical(const Signal& s, std::uint32_t raw) {
  const double number = s.encoding == Encoding::signed_integer ? static_cast<double>(extended_sign(s, raw))
                                                               : static_cast<double>(raw);
  return number * static_cast<double>(s.span) / static_cast<double>(s.counts) + static_cast<double>(s.offset);
}

/// Ends of the range of an integer signal.
inline double lowest(const Signal& s) {
  return physical(s, s.encoding == Encoding::signed_integer ? 1u << (s.width - 1u) : 0u);
}
inline double highest(const Signal& s) {
  const std::uint32_t ones = s.width >= 32 ? 0xffffffffu : (1u << s.width) - 1u;
  return physical(s, s.encoding == Encoding::signed_integer ? ones >> 1 : ones);
}

}  // namespace furcula::bus
