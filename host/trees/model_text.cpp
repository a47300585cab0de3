#include "host/trees/model_text.hpp"

#include <filesystem>
#include <sstream>

#include "host/core/strict_toml.hpp"

namespace furcula::trees {

std::string read_model_text(const std::string& path) {
  std::string text = core::read_small_file(path, "a model file (TOML) or a URDF");
  // Behind a byte order mark, too. No TOML begins so.
  const std::size_t begin = text.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (begin == std::string::npos || text[begin] != '<') return text;
  std::ostringstream out;
  out << toml::table{{"model", toml::table{{"kind", "tree"},
                                           {"schema", 1},
                                           {"urdf", std::filesystem::path(path).filename().string()}}},
                     {"drive", toml::table{{"law", "torque"}}}};
  return out.str();
}

}  // namespace furcula::trees
