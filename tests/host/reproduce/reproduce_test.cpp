// What is met, what is explained, and the command from end to end.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <regex>
#include <string>
#include <vector>

#include "host/report/html.hpp"
#include "host/reproduce/comparison.hpp"
#include "host/reproduce/reproduction.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/reproduce/document_002.hpp"

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

TEST_CASE("A smaller error is put down to the first cause with which it is met, or to none") {
  const auto of = [](const std::vector<Counterfactual>& causes) {
    return compare_error({"", "", "mm", "2 mm", 0.5}, 2.0, {}, causes);
  };
  const Row found = of({{"with this", 0.9}, {"with that", 1.3}, {"with all", 3.0}});
  CHECK(found.outcome == Outcome::smaller);
  CHECK(found.remark == "Smaller by this cause: with that it is 1.30 mm.");
  CHECK(found.counterfactuals.size() == 3);
  const Row beyond = of({{"with this", 0.9}, {"with that", 5.0, {}, true}});
  CHECK(beyond.remark.find("more than enough: with that it is 5.00 mm.") != std::string::npos);
  CHECK(beyond.remark.find("conjecture") != std::string::npos);
  CHECK(of({{"with that", 5.0}, {"with all", 3.0}}).remark ==
        "Smaller by this cause: with all it is 3.00 mm.");
  const Row none = of({{"with this", 0.7}, {"with that", 0.9}});
  CHECK(none.remark.find("the most is 0.900 mm, with that") != std::string::npos);
  CHECK(none.remark.find("conjecture") != std::string::npos);
  CHECK(of({{"with this", std::nan("")}, {"with that", 0.9}}).remark.find("with that") != std::string::npos);
  CHECK(of({}).remark == "Why it is smaller was not computed.");
  // One that is met needs no cause.
  CHECK(compare_error({"", "", "mm", "2 mm", 1.5}, 2.0, {}, {{"with that", 1.3}}).remark.empty());
}

TEST_CASE("What was put in is not met, and differs where it does not even come out") {
  const Row in = put_in({"", "", "", "1.5", 1.5}, {1.0, 2.0}, "chosen");
  CHECK(in.outcome == Outcome::by_construction);
  CHECK(std::string(name(in.outcome)) == "by construction");
  CHECK(in.remark == "chosen");
  CHECK(put_in({"", "", "", "1.5", 2.5}, {1.0, 2.0}, "chosen").outcome == Outcome::differs);
  CHECK(put_in({"", "", "", "1.5", std::nan("")}, {1.0, 2.0}, "chosen").outcome == Outcome::differs);
}

TEST_CASE("The reasons beside table 3.1 are computed from the table") {
  auto table = table_parameters();
  Trajectory linear, nonlinear;
  const auto liftoff = [&] {
    for (const Row& row : table_3_1_rows(table, linear, nonlinear))
      if (row.published == "1") return row;
    return Row{};
  };
  // By hand: 1 - e / (2 L m).
  const Row printed = liftoff();
  CHECK(printed.outcome == Outcome::explained);
  CHECK(printed.ours == Approx(1.0 - 0.038 / (2.0 * 0.15 * 1.6)).margin(1e-3));
  CHECK(printed.remark.find("0.9208") != std::string::npos);
  table.inertia_e_kgm = 0.030;
  const Row lighter = liftoff();
  CHECK(lighter.remark.find("= 0.9375") != std::string::npos);
  REQUIRE(lighter.counterfactuals.size() == 2);
  CHECK(lighter.counterfactuals[1].value == Approx(1.0 - 0.015 / (2.0 * 0.15 * 1.6)).margin(1e-3));
  table.mass_kg = 2.0;
  CHECK(liftoff().remark.find("= 0.9500") != std::string::npos);

  // By hand, of section 3.2.2: sum I + m_L L^2 = 20e-4 + 0.1 0.15^2.
  for (const Row& row : table_3_1_rows(table, linear, nonlinear))
    if (row.published == "42e-4") {
      REQUIRE(row.counterfactuals.size() == 2);
      CHECK(row.counterfactuals[0].value == Approx(42.5e-4));
      CHECK(row.counterfactuals[1].value == Approx(row.ours + 8e-4));
    }
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
  CHECK(json["count"]["met"] > 20);
  std::size_t counted = 0;
  for (const auto& count : json["count"]) counted += count.get<std::size_t>();
  CHECK(counted == json["rows"].size());
  std::vector<std::string> by_construction;
  for (const auto& row : json["rows"]) {
    INFO(row.dump());
    CHECK(row["ours"].is_number());
    const std::string outcome = row["outcome"], remark = row["remark"];
    if (outcome == "by construction") {
      by_construction.push_back(row["what"]);
      CHECK(!remark.empty());
    }
    // Each reason has the figures that show it, and says one of them at least.
    if (outcome == "explained" || outcome == "smaller") {
      CHECK(!row["counterfactuals"].empty());
      bool said = false;
      for (const auto& c : row["counterfactuals"]) {
        REQUIRE(c["value"].is_number());
        for (const double scale : {1.0, 1e4})
          for (const int digits : {2, 3, 4})
            said = said ||
                   remark.find(report::number(scale * c["value"].get<double>(), digits)) != std::string::npos;
      }
      CHECK(said);
    }
  }
  CHECK(std::is_permutation(by_construction.begin(), by_construction.end(), test::kPutIn002.begin(),
                            test::kPutIn002.end()));
  CHECK(json["count"]["by construction"] == test::kPutIn002.size());
  for (const auto& phase : json["identification"])
    CHECK(phase["validation"].size() == (phase["phase"] == "flight" ? 20 : 60));

  // Each number of the document is a row or an omission, each figure is named on the page.
  for (const test::Printed& printed : test::kPrinted002) {
    INFO(printed.where << ": " << printed.number);
    bool found = false;
    for (const char* list : {"rows", "omissions"})
      for (const auto& entry : json[list]) {
        const std::string text = entry["published"].get<std::string>() + " " + entry.value("what", "");
        found = found || (entry["where"].get<std::string>().find(printed.where) != std::string::npos &&
                          text.find(printed.number) != std::string::npos);
      }
    CHECK(found);
  }
  for (const auto& omission : json["omissions"]) {
    CHECK(!omission["because"].get<std::string>().empty());
    CHECK(!omission["why"].get<std::string>().empty());
  }
  std::ifstream page_file(folder.path() + "/report.html");
  const std::string page{std::istreambuf_iterator<char>(page_file), {}};
  for (const auto& [chapter, figures] : test::kFigures002)
    for (int i = 1; i <= figures; ++i) {
      const std::string figure = std::to_string(chapter) + "." + std::to_string(i);
      INFO("Fig. " << figure);
      CHECK(std::regex_search(page, std::regex("Fig\\. ([0-9.a-c]+, )*" + figure + "[^0-9]")));
    }
  CHECK(page.find("id=\"omissions\"") != std::string::npos);
}

TEST_CASE("furcula reproduce knows its documents") {
  const auto ran = test::run_furcula({"reproduce", "003", "--out", "nowhere"});
  CHECK(ran.status == 2);
  CHECK(ran.err.find("002") != std::string::npos);
}
