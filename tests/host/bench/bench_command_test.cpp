// `furcula bench release-catch` as a user runs it.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/host/cli/run_program.hpp"

using namespace furcula::test;
using Catch::Contains;

TEST_CASE("The test writes its page, its figures and two logs that check out") {
  const TemporaryFolder folder;
  const std::string out = folder.path() + "/bench";
  const Ran ran = run_furcula({"bench", "release-catch", "--trials", "20", "--seed", "3", "--out", out});
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out,
             Contains("as given: released after") && Contains("20 varied:") && Contains("pressing force:"));
  std::ifstream file(out + "/release_catch.json");
  const auto json = nlohmann::json::parse(file);
  CHECK(json["schema"] == "furcula-release-catch/1");
  CHECK(json["standard"]["caught_after_s"].get<double>() > 0.0);
  CHECK(json["trials"].size() == 20);
  CHECK(json["holding"].size() == 6);
  for (const char* name : {"/standard.csv", "/worst.csv"}) {
    const Ran checked = run_furcula({"check", "--machine", "clutch_bench", out + name});
    CHECK(checked.status == 0);
  }
  std::ifstream page(out + "/report.html");
  const std::string html((std::istreambuf_iterator<char>(page)), {});
  CHECK_THAT(html, Contains("Holding load against pressing force") && Contains("is caught"));
  // The same again gives the same.
  const Ran again = run_furcula({"bench", "release-catch", "--trials", "20", "--seed", "3", "--out", out});
  CHECK(again.out == ran.out);
}

TEST_CASE("A clutch that misses its limits ends with status 4 and says which") {
  const TemporaryFolder folder;
  const std::string limits =
      folder.file("limits.toml", "[limits]\ncaught_after_max_s = 0.001\nholding_min_kg = 1\n");
  const Ran ran = run_furcula(
      {"bench", "release-catch", "--trials", "2", "--limits", limits, "--out", folder.path() + "/b"});
  CHECK(ran.status == 4);
  CHECK_THAT(ran.out, Contains("FAILED caught_after_max_s") && Contains("passed holding_min_kg"));
  CHECK_THAT(ran.err, Contains("the clutch does not meet its limits"));
}

TEST_CASE("Arguments that make no sense are refused") {
  const TemporaryFolder folder;
  const Ran board = run_furcula({"bench", "release-catch", "--board", "moon", "--out", folder.path() + "/b"});
  CHECK(board.status == 2);
  const Ran port =
      run_furcula({"bench", "release-catch", "--board", "modbus:nowhere", "--out", folder.path() + "/b"});
  CHECK(port.status == 2);
  CHECK_THAT(port.err, Contains("expected modbus:/dev/NAME@BAUD"));
  const Ran nobody =
      run_furcula({"bench", "release-catch", "--board", "modbus:127.0.0.1:9", "--out", folder.path() + "/b"});
  CHECK(nobody.status == 3);
  CHECK_THAT(nobody.err, Contains("modbus:127.0.0.1:9"));
  const Ran can =
      run_furcula({"bench", "release-catch", "--board", "can:nowhere7", "--out", folder.path() + "/b"});
  CHECK(can.status == 3);
  CHECK_THAT(can.err, Contains("can:nowhere7"));
  const Ran number =
      run_furcula({"bench", "release-catch", "--window-ms", "nan", "--out", folder.path() + "/b"});
  CHECK(number.status == 2);
  CHECK_THAT(number.err, Contains("is not a number from 1 to 10000"));
  const Ran none = run_furcula({"bench"});
  CHECK(none.status == 2);
  const Ran limits = run_furcula(
      {"bench", "release-catch", "--limits", folder.path() + "/none.toml", "--out", folder.path() + "/b"});
  CHECK(limits.status == 3);
  CHECK_THAT(limits.err, Contains("none.toml"));
}

TEST_CASE("Where the kernel has no simulated GPIO lines, the board hil says where it runs") {
  if (std::filesystem::exists("/sys/kernel/config/gpio-sim/furcula")) return;
  const TemporaryFolder folder;
  const Ran ran = run_furcula({"bench", "release-catch", "--board", "hil", "--out", folder.path() + "/b"});
  CHECK(ran.status == 3);
  CHECK_THAT(ran.err, Contains("hil: no bank of gpio-sim at ") && Contains("scripts/hil sets it up"));
}
