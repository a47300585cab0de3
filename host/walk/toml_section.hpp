// Sections and keys of the walk room's files that must be there.
#pragma once

#include <toml++/toml.h>

#include <cstdint>
#include <string>
#include <string_view>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::walk {

inline const toml::table& section(const toml::table& file, const std::string& name, const char* key) {
  const toml::node* node = file.get(key);
  if (node == nullptr) core::fail(name, file.source(), "no section [" + std::string(key) + "]; expected one");
  return core::table(*node, name, "[" + std::string(key) + "]");
}
inline const toml::node& entry(const toml::table& table, const std::string& name, std::string_view key,
                               const std::string& where) {
  const toml::node* node = table.get(key);
  if (node == nullptr)
    core::fail(name, table.source(), "no key '" + std::string(key) + "' in " + where + "; expected one");
  return *node;
}
inline void expect_schema(const toml::table& table, const std::string& name, const std::string& where) {
  const toml::node& schema = entry(table, name, "schema", where);
  if (!schema.is_integer() || schema.value<std::int64_t>() != 1)
    core::fail(name, schema.source(), "schema = " + core::value_text(schema) + "; expected 1");
}

}  // namespace furcula::walk
