// Gait files, gait.toml: a gait and the robot that it is of (docs/gaits.md).
#pragma once

#include <string>
#include <string_view>

#include "host/gait/gait.hpp"

namespace furcula::gait {

std::string format_gait(const Gait& gait);

/// @throws core::DataError naming file, line and what was expected.
Gait parse_gait(std::string_view text, const std::string& path);
Gait read_gait(const std::string& path);

/// @throws core::DataError where the gait is of another robot than this; the spring may be another.
void require_same_robot(const Gait& gait, const Machine& machine, const std::string& path);

}  // namespace furcula::gait
