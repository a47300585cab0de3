// The depth of a TOML text, see toml_depth.hpp.
#include "host/core/toml_depth.hpp"

#include <algorithm>

namespace furcula::core {
namespace {

/// Where the string that begins at `at` (a quote) ends: the index behind its last quote. One that is not
/// closed ends with its line, one of several lines with the text, as it does for the parser.
std::size_t end_of_string(std::string_view text, std::size_t at) {
  const char quote = text[at];
  const bool escapes = quote == '"';
  const std::string three(3, quote);
  const bool several_lines = text.substr(at, 3) == three;
  for (std::size_t i = at + (several_lines ? 3 : 1); i < text.size(); ++i) {
    if (escapes && text[i] == '\\') {
      // An escaped line break does not end the line's string: that is an error, and the parser's.
      if (several_lines || i + 1 == text.size() || text[i + 1] != '\n') ++i;
    } else if (several_lines && text.substr(i, 3) == three) {
      // Up to two quotes may stand before the closing three.
      i += 3;
      for (int more = 0; more < 2 && i < text.size() && text[i] == quote; ++more) ++i;
      return i;
    } else if (!several_lines && text[i] == quote) {
      return i + 1;
    } else if (!several_lines && text[i] == '\n') {
      return i;
    }
  }
  return text.size();
}

}  // namespace

std::optional<TooDeep> find_too_deep(std::string_view text) {
  const std::string most = std::to_string(kTomlDepthMax);
  std::size_t depth = 0, dots = 0;
  std::size_t line = 1, i = 0;
  while (i < text.size()) {
    switch (text[i]) {
      case '#':
        i = std::min(text.find('\n', i), text.size());
        continue;
      case '"':
      case '\'': {
        const std::size_t end = end_of_string(text, i);
        line += static_cast<std::size_t>(std::count(text.begin() + static_cast<std::ptrdiff_t>(i),
                                                    text.begin() + static_cast<std::ptrdiff_t>(end), '\n'));
        i = end;
        continue;
      }
      case '[':
      case '{':
        dots = 0;
        if (++depth > kTomlDepthMax)
          return TooDeep{line, "more than " + most + " brackets within each other; expected at most " + most};
        break;
      case ']':
      case '}':
        dots = 0;
        if (depth > 0) --depth;
        break;
      case '.':
        if (++dots >= kTomlDepthMax)
          return TooDeep{line, "more than " + most + " names joined by dots; expected at most " + most};
        break;
      case '\n':
        ++line;
        dots = 0;
        break;
      case '=':
      case ',':
        dots = 0;
        break;
      default:
        break;
    }
    ++i;
  }
  return std::nullopt;
}

}  // namespace furcula::core
