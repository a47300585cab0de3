// What the documentation shows can be done as shown, and its copies of tables are those of the code.
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "host/log/reader.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

std::string page(const std::string& name) {
  std::ostringstream text;
  text << std::ifstream(test::source("docs/" + name)).rdbuf();
  return text.str();
}

/// The first indented block behind a heading whose first line is `first`, without its indentation.
std::string example(const std::string& text, const std::string& heading, const std::string& first) {
  std::istringstream lines(text.substr(text.find("\n" + heading + "\n")));
  std::string block;
  for (std::string line; std::getline(lines, line);) {
    if (block.empty() && line != "    " + first) continue;
    if (!line.empty() && !line.starts_with("    ")) break;
    block += (line.empty() ? line : line.substr(4)) + "\n";
  }
  return block;
}

}  // namespace

TEST_CASE("the example model and scenario of the documentation run, and the fault that they plant is found") {
  const std::string text = page("logs_and_models.md");
  test::TemporaryFolder folder;
  const std::string model = folder.file("robot.toml", example(text, "## A model file", "[model]"));
  const std::string scenario = folder.file("scenario.toml", example(text, "## A scenario file", "[start]"));
  const std::string out = folder.path() + "/run.csv";
  const test::Ran ran =
      test::run_furcula({"sim", "--model", model, "--scenario", scenario, "--seed", "7", "--out", out});
  INFO(ran.err);
  REQUIRE(ran.status == 0);
  // Whichever comes first (docs/safety.md, encoder_stuck).
  CHECK_THAT(ran.err, Contains("encoder_implausible") || Contains("contact_implausible") ||
                          Contains("parameters_implausible"));
  CHECK(log::read_log(out, "hopper").rows() == 4000);
  CHECK(test::run_furcula({"check", out}).status == 0);
}
