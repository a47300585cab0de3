// How deep a TOML text nests, found before it is parsed: toml++ (3.3) recurses once a level in its parser or
// when it destroys what it parsed, and 50,000 dots in a key overflow its stack.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace furcula::core {

/// Of brackets and braces within each other, and of names that dots join. The files of this project need 3.
inline constexpr std::size_t kTomlDepthMax = 16;

struct TooDeep {
  std::size_t line = 1;
  std::string message;  ///< what it is and what was expected
};

/// The first place at which `text` nests deeper, or joins more names. What stands in strings and comments
/// does not count. Of a text that is no TOML it says nothing else: the parser does.
std::optional<TooDeep> find_too_deep(std::string_view text);

}  // namespace furcula::core
