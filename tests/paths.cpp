#include "tests/paths.hpp"

namespace furcula::test {

std::string source(const std::string& path) { return FURCULA_SOURCE_DIR "/" + path; }
std::string program(const std::string& name) { return FURCULA_PROGRAMS "/" + name; }
std::string image(const std::string& board) { return FURCULA_IMAGES "/" + board + ".elf"; }

}  // namespace furcula::test
