// Commands in messages, see commands.hpp.
#include "host/core/commands.hpp"

#include <cctype>

namespace furcula::core {

std::string shell_word(const std::string& text) {
  constexpr std::string_view kPlain = "./_-+=:@%,";
  bool plain = !text.empty();
  for (const char c : text)
    plain = plain &&
            (std::isalnum(static_cast<unsigned char>(c)) != 0 || kPlain.find(c) != std::string_view::npos);
  if (plain) return text;
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

std::string python_string(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    if (c == '\t')
      out += "\\t";
    else
      out += c;
  }
  return out + "\"";
}

std::string python_command(const std::string& code) { return "python3 -c " + shell_word(code); }

std::string with_ending(const std::string& path, const std::string& ending) {
  const std::size_t name = path.find_last_of('/') + 1;  // 0 where there is none
  const std::size_t dot = path.rfind('.');
  return (dot == std::string::npos || dot <= name ? path : path.substr(0, dot)) + ending;
}

}  // namespace furcula::core
