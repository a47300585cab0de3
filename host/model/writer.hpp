// Writes model files (docs/contracts.md, section 2).
#pragma once

#include <string>

#include "host/model/model.hpp"

namespace furcula::model {

/// The model as TOML; parse_model of it gives the same model, to the bit.
std::string format_model(const Model& model);

/// Writes format_model(model) whole or not at all. @throws core::OutputError.
void write_model(const Model& model, const std::string& path);

}  // namespace furcula::model
