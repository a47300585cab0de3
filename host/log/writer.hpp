// Writes `furcula-log/1` (docs/contracts.md, section 1).
#pragma once

#include <string>

#include "host/log/log.hpp"

namespace furcula::log {

/// Whether metadata are written, which other programs may stumble over. Without them a log does not say its own rig.
enum class Comments { with, without };

/// The log as text: metadata (format and rig first), then the columns in the contract's order and the others
/// by name. Each number in its shortest form that reads back as the same double.
/// @throws std::invalid_argument: columns of unequal length, a value that is not finite, a name or metadata
/// that a reader could not read back.
std::string format_log(const Log& log, Comments comments = Comments::with);

/// Writes format_log(log, comments) whole or not at all. @throws OutputError, std::invalid_argument.
void write_log(const Log& log, const std::string& path, Comments comments = Comments::with);

}  // namespace furcula::log
