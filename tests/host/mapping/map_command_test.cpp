// `furcula map` at the program's edge.
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "tests/host/cli/run_program.hpp"

using namespace furcula;
using Catch::Contains;
using test::run_furcula;

namespace {

const char* kJoint = R"([model]
kind = "rotary_joint"
schema = 1
[parameters]
inertia_kgm2 = 0.05
gravity_torque_nm = 2.5
damping_nmspr = 0.05
)";

/// The simulated log with another header row.
std::string renamed(const std::string& path, const std::string& header) {
  std::ifstream file(path);
  std::string line, out = header + "\n";
  bool rows = false;
  while (std::getline(file, line)) {
    if (rows) out += line + "\n";
    rows = rows || line.starts_with("time_s");
  }
  return out;
}

}  // namespace

TEST_CASE("a proposed map is one that check takes, and the model's own joint needs no name") {
  test::TemporaryFolder folder;
  const std::string model = folder.file("joint.toml", kJoint), made = folder.path() + "/made.csv",
                    map = folder.path() + "/map.toml";
  REQUIRE(run_furcula({"sim", "--model", model, "--out", made, "--no-comments"}).status == 0);
  std::ifstream file(made);
  std::string header;
  std::getline(file, header);
  REQUIRE(header == "time_s,angle_rad,torque_nm");
  const std::string log = folder.file("log.csv", renamed(made, "t,pos,tau"));
  const test::Ran ran = run_furcula({"map", log, "--model", model, "-o", map});
  INFO(ran.out << ran.err);
  REQUIRE(ran.status == 0);
  CHECK_THAT(ran.out, Contains("0 not found"));
  const test::Ran checked = run_furcula({"check", log, "--map", map, "--model", model});
  INFO(checked.err);
  CHECK(checked.status == 0);
  const test::Ran shown = run_furcula({"map", log, "--model", model});
  CHECK_THAT(shown.out,
             Contains("angle_rad = { column = \"pos\" }") && Contains("machine_type = \"rotary_joint\""));
}

TEST_CASE("bad input to map ends with one message and no output") {
  test::TemporaryFolder folder;
  const std::string model = folder.file("joint.toml", kJoint), out = folder.path() + "/map.toml";
  const std::string log = folder.file("log.csv", "t,foo\n0,1\n0.001,2\n0.002,3\n");
  const std::vector<std::pair<std::vector<std::string>, std::pair<int, std::string>>> cases{
      {{"map", log, "--model", model, "-o", out}, {3, "'t', 'foo'"}},
      {{"map", "none.csv", "--model", model, "-o", out}, {3, "none.csv"}},
      {{"map", log, "--model", "none.toml", "-o", out}, {3, "none.toml"}},
      {{"map", log}, {2, "--model is required"}},
      {{"map", log, "--model", model, "-o", log}, {2, "is what is read; expected another file"}},
      {{"map", log, "--model", model, "-o", model}, {2, "is what is read; expected another file"}},
      {{"sim", "--model", model, "--out", model}, {2, "is what is read; expected another file"}},
  };
  for (const auto& [arguments, expected] : cases) {
    const test::Ran ran = run_furcula(arguments);
    INFO(expected.second << ran.err);
    CHECK(ran.status == expected.first);
    CHECK(ran.out.empty());
    CHECK_THAT(ran.err, Contains(expected.second));
    CHECK(ran.err.find('\n') == ran.err.size() - 1);
  }
  CHECK(folder.names() == std::vector<std::string>{"joint.toml", "log.csv"});
}
