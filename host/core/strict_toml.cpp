// Strict TOML, see strict_toml.hpp.
#include "host/core/strict_toml.hpp"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <vector>

#include "host/core/byte_source.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/toml_depth.hpp"

namespace furcula::core {

std::string read_small_file(const std::string& path, std::string_view what) {
  constexpr std::size_t kMost = 1 << 20;
  FileSource source(path, what);
  std::string text(kMost + 1, '\0');
  std::size_t size = 0;
  while (size < text.size()) {
    const std::size_t n = source.read(text.data() + size, text.size() - size);
    if (n == 0) break;
    size += n;
  }
  if (size == 0) throw DataError(path + ":1: the file is empty; expected " + std::string(what));
  if (size > kMost) throw DataError(path + ": the file is larger than 1 MiB; expected " + std::string(what));
  text.resize(size);
  if (text.starts_with("\xff\xfe") || text.starts_with("\xfe\xff"))
    throw DataError(path + ":1: the text is UTF-16; expected " + std::string(what) +
                    " in UTF-8 (iconv -f UTF-16 -t UTF-8 makes it)");
  if (const std::size_t nul = text.find('\0'); nul != std::string::npos)
    throw DataError(path + ": byte " + std::to_string(nul + 1) + " is NUL, so this is no text; expected " +
                    std::string(what));
  return text;
}

toml::table parse_toml(std::string_view text, const std::string& name) {
  if (const auto deep = find_too_deep(text))
    throw DataError(name + ":" + std::to_string(deep->line) + ": " + deep->message);
  try {
    return toml::parse(text, std::string_view{name});
  } catch (const toml::parse_error& e) {
    fail(name, e.source(), "no valid TOML: " + std::string(e.description()));
  }
}

void fail(const std::string& name, const toml::source_region& where, const std::string& message) {
  throw DataError(name + ":" + std::to_string(where.begin.line) + ": " + printable(message));
}

std::string toml_float(double value) {
  std::string text = shortest(value);
  // "nan", "inf" and exponents are floats already.
  if (text.find_first_of(".en") == text.npos) text += ".0";
  return text;
}

std::string value_text(const toml::node& node) {
  if (node.is_table()) return "a table";
  if (node.is_array()) return "an array";
  if (const auto* s = node.as_string()) return core::quoted(s->get());
  if (const auto* number = node.as_floating_point()) return toml_float(number->get());
  std::ostringstream out;
  node.visit([&out](const auto& v) {
    if constexpr (toml::is_value<decltype(v)>) out << v;
  });
  return out.str();
}

double number(const toml::node& node, const std::string& name, std::string_view key, double lower,
              double upper, std::string_view unit) {
  std::string expected = "expected a number from " + shortest(lower) + " to " + shortest(upper);
  if (!unit.empty()) expected += " " + std::string(unit);
  if (!node.is_number())
    fail(name, node.source(), std::string(key) + " is " + value_text(node) + "; " + expected);
  const double value = *node.value<double>();
  if (!(value >= lower && value <= upper))
    fail(name, node.source(), std::string(key) + " = " + value_text(node) + "; " + expected);
  return value;
}

const toml::table& table(const toml::node& node, const std::string& name, std::string_view key) {
  if (const toml::table* t = node.as_table()) return *t;
  fail(name, node.source(), std::string(key) + " is " + value_text(node) + "; expected a table");
}

std::string text(const toml::node& node, const std::string& name, std::string_view key) {
  if (const auto* s = node.as_string()) return s->get();
  fail(name, node.source(), std::string(key) + " is " + value_text(node) + "; expected a string in quotes");
}

void refuse_unknown_keys(const toml::table& table, const std::string& name, std::string_view where,
                         std::span<const std::string_view> known) {
  for (const auto& [key, node] : table) {
    bool found = false;
    for (const std::string_view k : known) found = found || k == key.str();
    if (!found)
      fail(name, key.source(),
           "unknown key " + quoted(key.str()) + " in " + std::string(where) + "; expected one of " +
               listed(known) + did_you_mean(key.str(), known));
  }
}

void rename_key(toml::table& table, std::string_view earlier, std::string_view present) {
  const auto found = table.find(earlier);
  if (found == table.end() || table.contains(present)) return;
  toml::key key(present, found->first.source());
  found->second.visit([&](auto& node) {
    auto kept = std::move(node);
    table.erase(earlier);
    table.insert_or_assign(std::move(key), std::move(kept));
  });
}

}  // namespace furcula::core
