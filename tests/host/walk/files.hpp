// What a program has written, read back.
#pragma once

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string>

namespace furcula::test {

/// Empty where there is no such file.
inline std::string text_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}
inline nlohmann::json json_of(const std::string& path) { return nlohmann::json::parse(text_of(path)); }

}  // namespace furcula::test
