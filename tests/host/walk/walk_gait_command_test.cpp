// `furcula walk gait` and `furcula walk search --from` as a user runs them.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/walk/walk_file.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/walk/files.hpp"
#include "tests/host/walk/walks.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

const std::string kModel = test::source("models/biped/biped.toml");

}  // namespace

TEST_CASE("furcula walk gait writes a gait's figures and a walk to start a search from") {
  test::TemporaryFolder folder;
  const std::string out = folder.path() + "/gait";
  const test::Ran ran =
      test::run_furcula({"walk", "gait", "--model", kModel, "--speed-mps", "0.3", "--out", out}, 240);
  INFO(ran.err);
  REQUIRE(ran.status == 0);
  CHECK_THAT(ran.out, Contains("cost of transport") && Contains("at 0.300 m/s") && Contains("--from"));
  const auto j = test::json_of(out + "/gait.json");
  CHECK(j["schema"] == "furcula-walk-gait/1");
  CHECK(j["found"] == true);
  CHECK(j["speed_mps"].get<double>() == Approx(0.3));
  CHECK(j["step_m"].get<double>() == Approx(0.3 * j["duration_s"].get<double>()));
  CHECK(j["energy_j"]["total"].get<double>() ==
        Approx(49.8 * 9.8 * j["step_m"].get<double>() * j["cot"].get<double>()));
  CHECK(j["max"]["torque_nm"]["is"].get<double>() <= 80.0);
  CHECK(walk::read_walk(out + "/walk.toml").robot == "furcula_biped");
}

TEST_CASE("a search that starts from a walk has it from its first generations on") {
  test::TemporaryFolder folder;
  const std::string walk = test::source("tests/host/walk/active_walk.toml");
  const auto objective = [&](std::vector<std::string> more) {
    std::vector<std::string> all{"walk",    "search",  "--model", kModel,
                                 "--steps", "2000000", "--out",   folder.path()};
    all.insert(all.end(), more.begin(), more.end());
    test::run_furcula(all, 120);
    return test::json_of(folder.path() + "/walk.json")["objective"].get<double>();
  };
  CHECK(objective({"--from", walk}) < objective({}));
}

TEST_CASE("where no gait is found furcula walk gait says what stands against it", "[slow]") {
  test::TemporaryFolder folder;
  std::ifstream in(kModel);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::string urdf = "furcula_biped.urdf";
  text.replace(text.find(urdf), urdf.size(), test::source("models/biped/" + urdf));
  const std::string weak = folder.path() + "/weak.toml";
  std::ofstream(weak) << text << "\n[limits]\nheight_m = 1.2\n";
  const test::Ran ran =
      test::run_furcula({"walk", "gait", "--model", weak, "--out", folder.path() + "/out"}, 240);
  CHECK(ran.status == 4);
  CHECK_THAT(ran.err, Contains("no gait was found") && Contains("the pelvis' height"));
  CHECK(test::json_of(folder.path() + "/out/gait.json")["found"] == false);
  const test::Ran fast = test::run_furcula(
      {"walk", "gait", "--model", kModel, "--speed-mps", "50", "--out", folder.path() + "/out"});
  CHECK(fast.status == 2);
  CHECK_THAT(fast.err, Contains("--speed-mps 50: expected from 0.01 to 5"));
}
