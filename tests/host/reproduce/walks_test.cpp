// Document 000 through the program, with walks that are given: each printed figure has its row, and the page its robots.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/host/cli/run_program.hpp"
#include "tests/host/walk/files.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

TEST_CASE("reproduce 000 puts walks beside the printed figures, and says which it does not reach") {
  test::TemporaryFolder folder;
  const std::string model = test::source("models/biped/biped.toml");
  const auto walk = [](const char* mode) {
    return test::source(std::string("tests/host/walk/") + mode + "_walk.toml");
  };
  const test::Ran ran =
      test::run_furcula({"reproduce", "000", "--model", model, "--walk", walk("active"), "--walk",
                         walk("semi_passive"), "--case-steps", "0", "--out", folder.path()},
                        300);
  INFO(ran.out << ran.err);
  // These walks are cheap to find, and dearer than the document's.
  CHECK(ran.status == 4);
  CHECK_THAT(ran.err, Contains("differ without a reason"));
  const auto j = test::json_of(folder.path() + "/reproduction.json");
  CHECK(j["document"] == "000");
  const auto row = [&](const std::string& what) {
    for (const auto& r : j["rows"])
      if (r["what"] == what) return r;
    FAIL(what);
    return j["rows"][0];
  };
  CHECK(row("Active: cost of transport over 10 s, start and stop included")["published"] == "3.2");
  const auto semi = row("Semi-passive: cost of transport over 10 s, start and stop included");
  CHECK(semi["published"] == "2.5");
  CHECK(semi["outcome"] == "differs");
  CHECK(row("Active: cost of transport from the printed energy and way")["ours"].get<double>() ==
        Approx(2.09).margin(0.005));
  // A link whose clutch is open swings as a pendulum with its damper: 0.05 N m s/rad on 0.8 kg m^2 over half a period of 0.63 s takes 2 %.
  CHECK(row("swing from 0.5 rad comes back to, clutch open")["ours"].get<double>() ==
        Approx(0.98).margin(0.003));
  CHECK(row("the same, motor joined")["ours"].get<double>() < 0.1);
  REQUIRE(j["walks"].size() == 2);
  const auto& active = j["walks"][0];
  CHECK(active["cases"].size() == 10);
  // Copper goes with the inverse square of the gear's ratio where nothing else changes.
  const double copper = active["cases"][0]["same"]["10_s"]["copper_j"],
               geared = active["cases"][1]["same"]["10_s"]["copper_j"];
  CHECK(geared == Approx(copper * 160.0 * 160.0 / (500.0 * 500.0)).epsilon(1e-9));
  CHECK_THAT(test::text_of(folder.path() + "/report.html"),
             Contains("active.html") && Contains("Energy by joint"));
  CHECK_THAT(test::text_of(folder.path() + "/semi_passive.html"), Contains("Semi-passive walk"));
  CHECK_THAT(test::text_of(folder.path() + "/active.toml"), Contains("mode = \"active\""));
}

TEST_CASE("reproduce 000 without a robot, and with another robot's walk, says so") {
  test::TemporaryFolder folder;
  const test::Ran none = test::run_furcula({"reproduce", "000", "--out", folder.path()});
  CHECK(none.status == 2);
  CHECK_THAT(none.err, Contains("--model"));
  std::string text = test::text_of(test::source("tests/host/walk/active_walk.toml"));
  text.replace(text.find("furcula_biped"), 13, "another_robot");
  const test::Ran other =
      test::run_furcula({"reproduce", "000", "--model", test::source("models/biped/biped.toml"), "--walk",
                         folder.file("other.toml", text), "--out", folder.path()});
  CHECK(other.status == 3);
  CHECK_THAT(other.err, Contains("another_robot") && Contains("furcula_biped"));
}
