// Where the tests find the project's files, its programs and its images. Compiled in one place: a path on every unit's command line would
// keep one clone from using what another has compiled.
#pragma once

#include <string>

namespace furcula::test {

/// A file or folder of the project, by its path in there.
std::string source(const std::string& path);
/// A program of this build: "furcula", "furculad".
std::string program(const std::string& name);
/// An image of the preset `cortex-m4f`, by its board.
std::string image(const std::string& board);

}  // namespace furcula::test
