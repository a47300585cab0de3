// TOML files read strictly: each error names file, line, key, value and what was expected.
#pragma once

#include <toml++/toml.h>

#include <span>
#include <string>
#include <string_view>

namespace furcula::core {

/// The text of a file of at most 1 MiB. @throws DataError: not readable, a directory, empty, too large.
std::string read_small_file(const std::string& path, std::string_view what);

/// @throws DataError with file and line where it is not TOML 1.0, or nested deeper than any file of this
/// project needs to be (host/core/toml_depth.hpp).
toml::table parse_toml(std::string_view text, const std::string& name);

/// Throws DataError "file:line: message", the line being the node's (or key's); the message in one printable
/// line, since it may hold keys of the file.
[[noreturn]] void fail(const std::string& name, const toml::source_region& where, const std::string& message);

/// A float as TOML writes it: shortest, and told from an integer (605.0, 1e+22, nan).
std::string toml_float(double value);

/// How a value looks in the file, for messages: `"abc"`, `12`, `true`, `a table`, `an array`.
std::string value_text(const toml::node& node);

/// A finite number (integer or float) within [lower, upper]. `key` and `unit` are for the message.
double number(const toml::node& node, const std::string& name, std::string_view key, double lower,
              double upper, std::string_view unit = "");

/// A table, or DataError. `key` is for the message.
const toml::table& table(const toml::node& node, const std::string& name, std::string_view key);

/// A string, or DataError.
std::string text(const toml::node& node, const std::string& name, std::string_view key);

/// Refuses keys that are not in `known`, with "did you mean". `where` is the section's name as in "[run]".
void refuse_unknown_keys(const toml::table& table, const std::string& name, std::string_view where,
                         std::span<const std::string_view> known);

/// A key that has an earlier version's name gets the present one, unless the table has that, too.
void rename_key(toml::table& table, std::string_view earlier, std::string_view present);

}  // namespace furcula::core
