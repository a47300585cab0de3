// Model files of a planar leg: `kind = "planar_leg"` (docs/gaits.md).
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "host/gait/machine.hpp"

namespace furcula::gait {

/// One key of the file and where its value goes.
struct MachineKey {
  std::string_view name, unit;
  double lower, upper;
  double& (*of)(Machine&);
  bool needed = true;

  double value(const Machine& machine) const { return of(const_cast<Machine&>(machine)); }
};
/// Of [parameters], [motors] and [range].
std::span<const MachineKey> parameter_keys();
std::span<const MachineKey> motor_keys();
std::span<const MachineKey> range_keys();

/// Whether the text says kind = "planar_leg" in [model]; false where it is no TOML at all.
bool is_planar_leg(std::string_view text);

/// @throws core::DataError naming file, line and what was expected.
Machine parse_machine(std::string_view text, const std::string& path);
Machine read_machine(const std::string& path);

/// As a file that reads back the same.
std::string format_machine(const Machine& machine);

}  // namespace furcula::gait
