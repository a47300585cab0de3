// See schema.hpp. The validator is Python's jsonschema, which shares no code with the writer.
#include "tests/schema.hpp"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "tests/paths.hpp"

namespace furcula::test {

std::optional<std::string> schema_violations(const std::string& name, const std::string& json) {
  const std::string file =
      (std::filesystem::temp_directory_path() / ("furcula-schema-" + std::to_string(getpid()) + ".json"))
          .string();
  const std::string said = file + ".txt";
  std::ofstream(file) << json;
  // Debian's own, which is the one that its package is for.
  const std::string command = "/usr/bin/python3 '" + source("tests/validate_json.py") + "' '" +
                              source("docs/schemas/" + name + ".schema.json") + "' '" + file +
                              "' > /dev/null 2> '" + said + "'";
  const int status = std::system(command.c_str());  // NOLINT(concurrency-mt-unsafe)
  std::ostringstream text;
  text << std::ifstream(said).rdbuf();
  std::filesystem::remove(file);
  std::filesystem::remove(said);
  switch (WIFEXITED(status) ? WEXITSTATUS(status) : -1) {
    case 0:
      return "";
    case 1:
      return text.str();
    case 77:
    case 127:  // no Python
      WARN(kNoValidator);
      return std::nullopt;
    default:
      throw std::runtime_error("validate_json.py: " + text.str());
  }
}

}  // namespace furcula::test
