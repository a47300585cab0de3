// [deviations] of a biped's model file: by how much the robot differs from its URDF and its design, number by number.
#pragma once

#include <string>

#include "host/biped/machine.hpp"
#include "host/core/strict_toml.hpp"

namespace furcula::biped {

/// Adds "kind@location" = change, in the unknown's unit (at "simulator": of the logarithm). @throws core::DataError naming file and line: an
/// unknown name, no number, a machine that cannot be.
void apply_deviations(const toml::table& deviations, const std::string& file, Machine& machine);

/// The section's text, [deviations] and a line for each number in which `machine` differs from `given`.
std::string format_deviations(const Machine& given, const Machine& machine);

}  // namespace furcula::biped
