// Document 001 through the program: each gait against the integrator, the figures against the printed ones and against an
// independent calculation.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/host/cli/run_program.hpp"

using namespace furcula;

TEST_CASE("reproduce 001 finds every gait and puts it beside the printed figures", "[long][slow]") {
  test::TemporaryFolder folder;
  const test::Ran ran =
      test::run_furcula({"reproduce", "001", "--starts", "1", "--out", folder.path()}, 1700);
  INFO(ran.out << ran.err);
  REQUIRE((ran.status == 0 || ran.status == 4));
  nlohmann::json j;
  std::ifstream(folder.path() + "/reproduction.json") >> j;
  CHECK(j["schema"] == "furcula-reproduction/1");
  CHECK(j["document"] == "001");
  std::size_t found = 0;
  for (const auto& g : j["gaits"]) {
    if (!g["found"]) continue;
    ++found;
    INFO(g.dump());
    CHECK(g["closure"].get<double>() < 1e-7);
  }
  CHECK(found + 2 >= j["gaits"].size());
  // What an independent calculation has (docs/studies.md), which one start reaches.
  const auto check = [&](const char* name, const char* key, double elsewhere) {
    for (const auto& g : j["gaits"])
      if (g["name"] == name) {
        INFO(name);
        REQUIRE(g["found"]);
        CHECK(g[key].get<double>() < 1.015 * elsewhere);
        CHECK(g[key].get<double>() > 0.95 * elsewhere);
        return;
      }
    FAIL(name);
  };
  check("switched, 5 cm", "cost_j", 1.880);
  check("switched, 20 cm", "cost_j", 4.954);
  check("parallel, 10 cm", "cost_j", 3.418);
  check("switched, 0.25 m/s", "cot", 0.1969);
  check("switched, 4 m/s", "cot", 0.3228);
  check("parallel, 1 m/s", "cot", 0.1610);
  std::size_t met = j["count"]["met"];
  CHECK(met > j["rows"].size() / 4);
}
