// `furcula gait-study`: against single searches, and what it refuses.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "tests/host/cli/run_program.hpp"
#include "tests/host/gait/legs.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

TEST_CASE("a study of the clutch says how much of the switch's advantage is left", "[long][slow]") {
  test::TemporaryFolder folder;
  const std::string out = folder.path() + "/out";
  const test::Ran ran =
      test::run_furcula({"gait-study", "--model", test::source("tests/host/gait/spear_switched.toml"), "--of",
                         "clutch", "--out", out},
                        400);
  INFO(ran.err);
  REQUIRE(ran.status == 0);
  nlohmann::json j;
  std::ifstream(out + "/study.json") >> j;
  CHECK(j["schema"] == "furcula-gait-study/1");
  CHECK(j["gaits"].size() == 2 * (1 + 5 + 7));
  // In place, from the one delay to the next: less is left, and of the longest nothing. (The gait without a loss is there twice: it begins
  // the delays and the teeth.)
  double before = 1.0 + 1e-9, delay_s = 0.0;
  for (const auto& g : j["gaits"]) {
    if (g["speed_mps"] != 0.0 || g["spring"] != "switched" || g["tooth_m"] != 0.0) continue;
    if (g["catch_delay_s"] == 0.0) {
      CHECK(g["advantage_left"].get<double>() == Approx(1.0).margin(1e-9));
      continue;
    }
    CHECK(g["catch_delay_s"].get<double>() > delay_s);
    CHECK(g["advantage_left"].get<double>() < before);
    before = g["advantage_left"].get<double>(), delay_s = g["catch_delay_s"].get<double>();
  }
  CHECK(delay_s == Approx(0.03));
  CHECK(before < 0.0);
  // Half of 3 mm at a lever of 30 mm.
  bool seen = false;
  for (const auto& g : j["gaits"]) seen |= g["lost_knee_rad"].get<double>() == Approx(0.05);
  CHECK(seen);
  CHECK_THAT(ran.out, Contains("advantage_left"));
  std::ostringstream text;
  text << std::ifstream(out + "/report.html").rdbuf();
  const std::string page = text.str();
  CHECK_THAT(page, Contains("A real clutch in place of the ideal switch") && Contains("<svg") &&
                       Contains("of 26 gaits were found") && Contains("furcula gait-study --model"));
}

TEST_CASE("a study that cannot be meant is refused") {
  test::TemporaryFolder folder;
  const std::string model = test::source("tests/host/gait/spear_switched.toml"), out = folder.path() + "/out";
  const test::Ran of = test::run_furcula({"gait-study", "--model", model, "--of", "mud", "--out", out});
  CHECK(of.status == 2);
  CHECK_THAT(of.err, Contains("--of"));
  const test::Ran lever = test::run_furcula({"gait-study", "--model", model, "--lever-m", "0", "--out", out});
  CHECK(lever.status == 2);
  CHECK_THAT(lever.err, Contains("from 0.001 to 1 m"));
  CHECK(folder.names().empty());
}
