// The page on Modbus is what the tables say.
#include "host/bus/modbus_document.hpp"

#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "tests/host/cli/run_program.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

TEST_CASE("docs/modbus.md is what the tables say (furcula bus docs modbus > docs/modbus.md)") {
  std::ostringstream page;
  page << std::ifstream(test::source("docs/modbus.md")).rdbuf();
  CHECK(page.str() == bus::modbus_to_markdown());
}

TEST_CASE("furcula bus docs prints either page, and names what it can print") {
  CHECK(test::run_furcula({"bus", "docs", "modbus"}).out == bus::modbus_to_markdown());
  CHECK_THAT(test::run_furcula({"bus", "docs"}).out, Contains("# CAN messages"));
  const test::Ran wrong = test::run_furcula({"bus", "docs", "lin"});
  CHECK(wrong.status == 2);
  CHECK_THAT(wrong.err, Contains("modbus"));
}
