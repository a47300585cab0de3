// `furcula gait` as a user runs it.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/gait/gait_file.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

std::string model(const std::string& spring) {
  return test::source("tests/host/gait/spear_" + spring + ".toml");
}

}  // namespace

TEST_CASE("furcula gait writes the gait, its JSON and its page") {
  test::TemporaryFolder folder;
  const std::string out = folder.path() + "/out";
  const test::Ran ran = test::run_furcula(
      {"gait", "--model", model("switched"), "--clearance-m", "0.075", "--starts", "2", "--out", out}, 120);
  INFO(ran.err);
  REQUIRE(ran.status == 0);
  CHECK_THAT(ran.out, Contains("J a stride") && Contains("closes to"));
  nlohmann::json j;
  std::ifstream(out + "/gait.json") >> j;
  CHECK(j["schema"] == "furcula-gait/1");
  CHECK(j["cost_j"].get<double>() == Approx(2.4613).epsilon(0.01));
  CHECK(j["cot"].is_null());
  CHECK(j["clearance_m"].get<double>() == Approx(0.075).margin(1e-6));
  CHECK(j["closure"].get<double>() < 1e-9);
  CHECK(j["multipliers"].size() == 6);
  CHECK(j["limits"].empty());
  CHECK(j["local_optima"][0]["starts"] == 2);
  CHECK_THAT(ran.out, Contains("cheapest stable gait: this one"));
  CHECK(j["stability"]["multipliers"][0].get<double>() < 0.25);
  CHECK(j["stability"]["basin"].get<double>() > 0.5);
  CHECK(j["disturbed"]["strides"] == 1000);
  CHECK(j["disturbed"]["falls"] == 0);
  CHECK(j["disturbed"]["falls_without_law"].get<int>() > 100);
  CHECK(j["stability"]["basin_without_law"].get<double>() < 0.05);
  CHECK(j["cheapest_stable"]["cost_j"] == j["cost_j"]);
  CHECK(j["open"].is_null());
  const gait::Gait read = gait::read_gait(out + "/gait.toml");
  CHECK(gait::evaluate(read).cost_j == j["cost_j"].get<double>());
  std::ifstream page(out + "/report.html");
  const std::string html(std::istreambuf_iterator<char>(page), {});
  CHECK_THAT(html, Contains("leg-data") && Contains("furcula gait --model"));

  // From there to a neighbour.
  const std::string next = folder.path() + "/next";
  const test::Ran near = test::run_furcula({"gait", "--model", model("switched"), "--clearance-m", "0.08",
                                            "--from", out + "/gait.toml", "--out", next},
                                           120);
  INFO(near.err);
  CHECK(near.status == 0);
}

TEST_CASE("furcula gait refuses what cannot be meant, with what was expected") {
  test::TemporaryFolder folder;
  const std::string out = folder.path() + "/out";
  const auto refused = [&](std::vector<std::string> options, int status) {
    std::vector<std::string> all{"gait", "--model", model("switched"), "--out", out};
    all.insert(all.end(), options.begin(), options.end());
    const test::Ran ran = test::run_furcula(all);
    CHECK(ran.status == status);
    return ran.err;
  };
  CHECK_THAT(refused({}, 2), Contains("--clearance-m") && Contains("--speed-mps"));
  CHECK_THAT(refused({"--clearance-m", "0.9"}, 2), Contains("less than the leg's length, 0.647 m"));
  CHECK_THAT(refused({"--clearance-m", "0.05", "--speed-mps", "1"}, 2), Contains("expected one of"));
  CHECK_THAT(refused({"--speed-mps", "0"}, 2), Contains("from 0.05 to 20 m/s"));
  CHECK_THAT(refused({"--clearance-m", "0.05", "--lift-off", "toe"}, 2), Contains("--lift-off"));
  CHECK_THAT(refused({"--clearance-m", "0.05", "--touchdown-knee-rad", "3"}, 2),
             Contains("the knee's range"));
  CHECK_THAT(refused({"--speed-mps", "1", "--landing-speed-mps", "-1"}, 2), Contains("from 0 to 10 m/s"));
  CHECK_THAT(refused({"--clearance-m", "0.05", "--from", model("switched")}, 3), Contains("gait file"));
  const std::string late = folder.path() + "/late.toml";
  std::ofstream(late) << std::ifstream(model("switched")).rdbuf()
                      << "\n[clutch]\ncatch_delay_s = 0.01\nlost_knee_rad = 0.0\n";
  const test::Ran ran = test::run_furcula(
      {"gait", "--model", late, "--clearance-m", "0.05", "--lift-off", "knee", "--out", out});
  CHECK(ran.status == 2);
  CHECK_THAT(ran.err, Contains("expected force or unguarded"));
  CHECK(folder.names() == std::vector<std::string>{"late.toml"});
}

TEST_CASE("a planar leg without a gait to play is refused with what it needs") {
  test::TemporaryFolder folder;
  const test::Ran ran =
      test::run_furcula({"sim", "--model", model("switched"), "--out", folder.path() + "/x.csv"});
  CHECK(ran.status == 2);
  CHECK_THAT(ran.err, Contains("is a planar leg") && Contains("expected --scenario with a gait"));
}
