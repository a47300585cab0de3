// `furcula demo` at the program's edge: what it leaves behind, and that the diagnosis does not see the truth.
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "host/model/reader.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/schema.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

std::string content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

}  // namespace

TEST_CASE("the demo tells verdict, truth and report, and any number of threads gives the same diagnosis",
          "[long]") {
  test::TemporaryFolder folder;
  const std::string one = folder.path() + "/one run", two = folder.path() + "/two";
  const test::Ran ran = test::run_furcula({"demo", "--seed", "1", "--threads", "1", "--out", one}, 300);
  CAPTURE(ran.err);
  REQUIRE(ran.status == 0);

  const model::Model model = model::read_model(one + "/model.toml");
  const model::Model truth = model::read_model(one + "/truth.toml");
  CHECK(model.effects.empty());
  REQUIRE(truth.effects.size() == 1);
  const std::string cause(dynamics::info(truth.effects.begin()->first).name);
  CHECK_THAT(ran.out, Contains("seed 1"));
  CHECK_THAT(ran.out, Contains("The truth (" + one + "/truth.toml)\n" + cause));
  CHECK_THAT(ran.out, Contains("report: " + one + "/diagnosis/report.html"));
  CHECK(std::filesystem::file_size(one + "/diagnosis/report.html") > 10000);

  // The same command on the files that it left, without the truth among them, says the same.
  std::filesystem::remove(one + "/truth.toml");
  std::vector<std::string> again{"diagnose", "--model", one + "/model.toml", "--threads", "2", "--out", two};
  for (int i = 1; i <= 6; ++i) again.push_back(one + "/hop-0" + std::to_string(i) + ".csv");
  again.insert(again.end(), {"--hold-out", one + "/hop-07.csv", one + "/hop-08.csv"});
  REQUIRE(test::run_furcula(again, 300).status == 0);
  CHECK(content(two + "/diagnosis.json") == content(one + "/diagnosis/diagnosis.json"));
  CHECK(test::schema_violations("furcula-diagnosis-2", content(two + "/diagnosis.json")).value_or("") == "");
  // The reports too: their foot has what the result depends on, and no folder or number of threads.
  const std::string report = content(two + "/report.html");
  CHECK((report == content(one + "/diagnosis/report.html")));
  CHECK_THAT(report.substr(report.rfind("<footer>"), 300),
             Contains("furcula diagnose --model &#39;" + one +
                      "/model.toml&#39; --window-s 0.5 --seed 1 &#39;" + one));
}

TEST_CASE("a demo into a place where no folder can be made ends with status 2 and one message") {
  test::TemporaryFolder folder;
  const std::string file = folder.file("taken", "");
  const test::Ran ran = test::run_furcula({"demo", "--seed", "1", "--out", file});
  CHECK(ran.status == 2);
  CHECK_THAT(ran.err, Contains("cannot make this folder"));
  CHECK(ran.out.empty());
}
