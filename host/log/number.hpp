// A field of a log as a number.
#pragma once

#include <charconv>
#include <cstdlib>
#include <string>
#include <system_error>

namespace furcula::log {

/// A whole field as a double, "inf" and "nan" included; false if it is no number.
inline bool parse_number(const std::string& field, double& value) {
  const char* begin = field.data();
  const char* const end = begin + field.size();
  if (end - begin > 1 && *begin == '+' && begin[1] != '-') ++begin;
  const auto [stopped, error] = std::from_chars(begin, end, value);
  if (stopped != end || begin == end) return false;
  if (error == std::errc::result_out_of_range) value = std::strtod(begin, nullptr);  // 0 or infinity
  return true;
}

}  // namespace furcula::log
