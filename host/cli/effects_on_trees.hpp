// The catalogue of effects on robots of several joints, for reading, for programs and for the documentation.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "host/trees/effects.hpp"

namespace furcula::cli {

/// Law, location type, parameters, and what to do about it, in lines.
std::string tree_effect_text(const trees::EffectInfo& effect);
nlohmann::ordered_json tree_effect_json(const trees::EffectInfo& effect);

/// Whether machines of one joint do not have it.
bool on_trees_alone(const trees::EffectInfo& effect);

/// The section of docs/effects.md: location types, a table of all effects, and the words of those that machines of one joint do not have.
std::string tree_effects_markdown();

/// A law in a table's cell, which must not hold its separator; laws hold |v|.
std::string markdown_cell(std::string text);

}  // namespace furcula::cli
