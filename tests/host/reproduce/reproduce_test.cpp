// What is met, what is explained, and the command from end to end.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "host/reproduce/comparison.hpp"
#include "tests/host/cli/run_program.hpp"

using namespace furcula;
using namespace furcula::reproduce;

TEST_CASE("A figure outside of its range differs, unless its reason holds") {
  const Range range{1.0, 2.0};
  const auto row = [](double ours) { return Row{"", "", "", "1.5", ours}; };
  CHECK(compare(row(1.5), range).outcome == Outcome::met);
  CHECK(compare(row(2.5), range).outcome == Outcome::differs);
  CHECK(compare(row(2.5), range, Reason{false, "no"}).outcome == Outcome::differs);
  const Row explained = compare(row(2.5), range, Reason{true, "because"});
  CHECK(explained.outcome == Outcome::explained);
  CHECK(explained.remark == "because");
  CHECK(compare(row(1.5), range, Reason{true, "because"}).remark.empty());
  // What could not be computed is not explained by anything.
  CHECK(compare(row(std::nan("")), range, Reason{true, "because"}).outcome == Outcome::differs);
}

TEST_CASE("An error is met within a factor of two, and one below that is not called met") {
  const auto row = [](double ours) { return Row{"", "", "", "2 mm", ours}; };
  CHECK(compare_error(row(1.1), 2.0).outcome == Outcome::met);
  CHECK(compare_error(row(3.9), 2.0).outcome == Outcome::met);
  CHECK(compare_error(row(0.9), 2.0).outcome == Outcome::smaller);
  CHECK(compare_error(row(4.1), 2.0).outcome == Outcome::differs);
  CHECK(compare_error(row(4.1), 2.0, Reason{true, "because"}).outcome == Outcome::explained);
  CHECK(compare_error(row(-0.1), 2.0).outcome == Outcome::differs);
  CHECK(compare_error(row(std::nan("")), 2.0).outcome == Outcome::differs);
}

TEST_CASE("furcula reproduce 002 meets or explains every printed figure, and writes page and table") {
  const test::TemporaryFolder folder;
  const auto ran = test::run_furcula({"reproduce", "002", "--out", folder.path()}, 280);
  INFO(ran.out << ran.err);
  REQUIRE(ran.status == 0);
  CHECK(folder.names() == std::vector<std::string>{"report.html", "reproduction.json"});
  CHECK(ran.out.find("0 differ;") != std::string::npos);
  std::ifstream file(folder.path() + "/reproduction.json");
  const auto json = nlohmann::json::parse(file);
  CHECK(json["schema"] == "furcula-reproduction/1");
  CHECK(json["count"]["differs"] == 0);
  CHECK(json["count"]["met"] > 25);
  bool coil = false;
  for (const auto& row : json["rows"]) {
    CHECK(row["ours"].is_number());
    if (row["outcome"] == "explained") CHECK(!row["remark"].get<std::string>().empty());
    coil = coil || row["what"] == "coil at 10 V and 1.5 A for that flight";
  }
  CHECK(coil);
  for (const auto& phase : json["identification"])
    CHECK(phase["validation"].size() == (phase["phase"] == "flight" ? 20 : 60));
}

TEST_CASE("furcula reproduce knows its documents") {
  const auto ran = test::run_furcula({"reproduce", "003", "--out", "nowhere"});
  CHECK(ran.status == 2);
  CHECK(ran.err.find("002") != std::string::npos);
}
