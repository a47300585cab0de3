// Reads model files (docs/contracts.md, section 2), strictly.
#pragma once

#include <string>
#include <string_view>

#include "host/model/model.hpp"

namespace furcula::model {

/// What is wrong with a name that is none of dynamics::kMachines, and what was expected.
std::string no_such_kind(std::string_view name);

/// @throws core::DataError naming file, line, key, value and what was expected: not readable, not TOML,
/// unknown key, section, kind, effect or parameter, something missing, wrong type, value outside its physical
/// bounds, bounds of a fit the wrong way round or without the value, effect that this kind does not have,
/// schema other than 1.
Model read_model(const std::string& path);

/// The same on text; `name` stands for the path in messages.
Model parse_model(std::string_view text, const std::string& name);

}  // namespace furcula::model
