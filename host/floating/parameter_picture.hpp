// What recordings tell of all numbers: prior beside posterior, a row each.
#pragma once

#include <string>

#include "host/floating/identify.hpp"

namespace furcula::floating {

/// Of its prior's; below it a number counts as narrowed.
inline constexpr double kNarrowed = 0.5;

std::size_t narrowed(const Identified& found);

/// The section's content: rows by kind, those that are narrowed first; then all numbers as a table.
std::string parameters_html(const Identified& found);

}  // namespace furcula::floating
