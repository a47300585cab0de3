// The page of what breaks.
#include "host/safety/document.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

TEST_CASE(
    "docs/safety.md is what the table and the simulated robot say (furcula safety docs > docs/safety.md)") {
  std::ostringstream page;
  page << std::ifstream(FURCULA_SOURCE_DIR "/docs/safety.md").rdbuf();
  CHECK(page.str() == furcula::safety::to_markdown());
}
