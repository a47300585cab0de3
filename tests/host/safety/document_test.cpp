// The page of what breaks.
#include "host/safety/document.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "tests/paths.hpp"

TEST_CASE(
    "docs/safety.md is what the table and the simulated robot say (furcula safety docs > docs/safety.md)") {
  std::ostringstream page;
  page << std::ifstream(furcula::test::source("docs/safety.md")).rdbuf();
  CHECK(page.str() == furcula::safety::to_markdown());
}
