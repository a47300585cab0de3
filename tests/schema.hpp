// Whether JSON is as its schema in docs/schemas says.
#pragma once

#include <optional>
#include <string>

namespace furcula::test {

/// What violates the schema `docs/schemas/NAME.schema.json`, a line each; empty: nothing. Nothing, and a warning, where Python's jsonschema is not installed.
std::optional<std::string> schema_violations(const std::string& name, const std::string& json);

inline constexpr const char* kNoValidator = "python3-jsonschema is not installed";

}  // namespace furcula::test
