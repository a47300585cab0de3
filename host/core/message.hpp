// Pieces of error messages: values as they stood in a file, and the name that was perhaps meant.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace furcula::core {

/// Text from a file, a device or an argument as a terminal may get it: UTF-8 stays; control characters, those
/// that change the direction of writing, line separators and bytes that are no UTF-8 are shown as \xNN.
std::string printable(std::string_view text);

/// The same with its line ends left: for a message of several lines.
std::string printable_lines(std::string_view text);

/// The value in single quotes, printable, cut after 40 bytes at most.
std::string quoted(std::string_view value);

/// Shortest decimal form that reads back as the same double.
std::string shortest(double value);

/// At most so many significant digits.
std::string rounded(double value, int digits = 4);

/// ` (did you mean 'x'?)` for the nearest of the names by edit distance, or that it is a part of, or that is
/// a part of it; nothing if none is near.
std::string did_you_mean(std::string_view name, std::span<const std::string_view> names);

/// "a, b, c"
std::string listed(std::span<const std::string_view> names);

}  // namespace furcula::core
