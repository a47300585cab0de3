// `furcula sim` at the program's edge: what it writes, and that bad input leaves nothing behind.
#include <catch2/catch.hpp>

#include "host/log/reader.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/model/example.hpp"

using namespace furcula;
using Catch::Contains;
using Catch::StartsWith;
using test::run_furcula;

TEST_CASE("a simulated log is one that the reader takes, the same for the same seed") {
  test::TemporaryFolder folder;
  const std::string model = folder.file("m.toml", test::kHopperModel);
  const std::string a = folder.path() + "/a.csv", b = folder.path() + "/b.csv";
  REQUIRE(run_furcula({"sim", "--model", model, "--seed", "7", "--out", a}).status == 0);
  REQUIRE(run_furcula({"sim", "--model", model, "--seed", "7", "--out", b}).status == 0);
  const log::Log first = log::read_log(a, "hopper");
  CHECK(first.rows() > 1000);
  CHECK(first.columns == log::read_log(b, "hopper").columns);
  CHECK(folder.names() == std::vector<std::string>{"a.csv", "b.csv", "m.toml"});
}

TEST_CASE("bad models and scenarios end with status 3, one message, and no output") {
  struct Case {
    std::string what, model, scenario, place, value, expected;
  };
  const auto model = [](const std::string& from, const std::string& to) {
    return test::with(test::kHopperModel, from, to);
  };
  const std::string good = test::kHopperModel, s = "s.toml", m = "m.toml";
  const std::vector<Case> cases{
      {"an unknown key", model("mass_kg", "mas_kg"), "\n", m + ":6:", "'mas_kg'", "expected one of mass_kg"},
      {"an unknown section", model("[free]", "[fre]"), "\n", m + ":17:", "'fre'", "did you mean 'free'?"},
      {"an unknown effect", model("coulomb", "columb"), "\n", m + ":20:", "'columb_friction'",
       "expected one of"},
      {"a bound the wrong way round", model("[1.2, 2.0]", "[2.0, 1.2]"), "\n", m + ":18:", "[2, 1.2]",
       "expected lower < upper"},
      {"a NaN", model("1.554", "nan"), "\n", m + ":6:", "nan", "expected a number from 0.001 to 1000 kg"},
      {"a clutch", model("[free]", "catch_delay_s = 0.02\n[free]"), "\n", m + ":17:", "catch_delay_s = 0.02",
       "expected one above 0"},
      {"an empty model", "", "\n", m + ":1:", "empty", "expected a model file"},
      {"a model of zeros", std::string(1000, '\0'), "\n", m + ":", "NUL", "expected a model file"},
      {"an empty scenario", good, "", s + ":1:", "empty", "expected a scenario"},
      {"an unknown scenario section", good, "[runn]\nduration_s = 1\n", s + ":1:", "'runn'",
       "did you mean 'run'?"},
      {"an unknown scenario key", good, "[run]\nduration = 1\n", s + ":2:", "'duration'",
       "did you mean 'duration_s'?"},
      {"time that runs backwards", good, "[run]\nduration_s = -1\n", s + ":2:", "duration_s = -1",
       "expected a number from"},
      {"a wrong unit suffix", good, "[start]\nheight_mm = 300\n", s + ":2:", "'height_mm'",
       "did you mean 'height_m'?"},
      {"a NaN in the scenario", good, "[start]\nheight_m = nan\n", s + ":2:", "height_m = nan",
       "expected a number from"},
      {"a scenario of zeros", good, std::string(1000, '\0'), s + ":", "NUL", "expected a scenario"},
  };
  for (const Case& c : cases) {
    INFO(c.what);
    test::TemporaryFolder folder;
    const test::Ran ran =
        run_furcula({"sim", "--model", folder.file("m.toml", c.model), "--scenario",
                     folder.file("s.toml", c.scenario), "--out", folder.path() + "/out.csv"});
    CHECK(ran.status == 3);
    CHECK(ran.out.empty());
    CHECK_THAT(ran.err, StartsWith("furcula: " + folder.path() + "/" + c.place));
    CHECK_THAT(ran.err, Contains(c.value) && Contains(c.expected));
    CHECK(ran.err.find('\n') == ran.err.size() - 1);
    CHECK(folder.names() == std::vector<std::string>{"m.toml", "s.toml"});
  }
}

TEST_CASE(
    "a directory in the place of a model or scenario ends with status 3, in the place of the log with 2") {
  test::TemporaryFolder folder;
  const std::string model = folder.file("m.toml", test::kHopperModel), out = folder.path() + "/out.csv";
  const test::Ran as_model = run_furcula({"sim", "--model", folder.path(), "--out", out});
  CHECK(as_model.status == 3);
  CHECK(as_model.err == "furcula: " + folder.path() +
                            ": is a directory; expected a model file (TOML) or a robot (URDF, MJCF)\n");
  CHECK(run_furcula({"sim", "--model", model, "--scenario", folder.path(), "--out", out}).status == 3);
  const test::Ran as_log = run_furcula({"sim", "--model", model, "--out", folder.path()});
  CHECK(as_log.status == 2);
  CHECK(as_log.err == "furcula: " + folder.path() + ": cannot be written: Is a directory\n");
  CHECK(run_furcula({"sim", "--model", model, "--out", folder.path() + "/none/out.csv"}).status == 2);
  CHECK(folder.names() == std::vector<std::string>{"m.toml"});
}

TEST_CASE("sim without a model or an output is unusable") {
  CHECK(run_furcula({"sim"}).status == 2);
  CHECK(run_furcula({"sim", "--model", "m.toml"}).status == 2);
}

TEST_CASE(
    "a robot that is let go for good, on a spring too soft to carry it, ends the simulation with one message") {
  test::TemporaryFolder folder;
  const std::string clutch =
      "release_delay_s = 0.02\ncatch_delay_s = 0.02\nauxiliary_stiffness_npm = 5.0\ntooth_pitch_m = 0.003\n";
  const std::string model =
      folder.file("m.toml", test::with(test::kHopperModel, "[free]", clutch + "[free]"));
  const std::string scenario =
      folder.file("s.toml",
                  "[start]\nheight_m = 0.33\n[run]\nduration_s = 2.0\n[torque]\nprofile = \"zero\"\n"
                  "[[clutch]]\ntime_s = 0.3\naction = \"release\"\n");
  const auto ran =
      run_furcula({"sim", "--model", model, "--scenario", scenario, "--out", folder.path() + "/a.csv"});
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err,
             Contains("the leg is folded flat") && Contains("Expected a clutch that catches before"));
  CHECK(folder.names() == std::vector<std::string>{"m.toml", "s.toml"});
}
