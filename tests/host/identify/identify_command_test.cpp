// `furcula identify` at the program's edge.
#include <catch2/catch.hpp>

#include "host/log/writer.hpp"
#include "host/model/writer.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;

namespace {

struct Files {
  test::TemporaryFolder folder;
  std::string model = folder.file("model.toml", model::format_model(test::axis_model(60.0, 90.0)));
  std::vector<std::string> logs;
  std::string out = folder.path() + "/out";

  Files() {
    for (unsigned i = 0; i < 4; ++i)
      logs.push_back(folder.file("log" + std::to_string(i) + ".csv",
                                 log::format_log(test::axis_log(95.0, 203.5, 1e-4, i, 2.0))));
  }
  test::Ran run(const std::string& command, std::vector<std::string> logs_given,
                std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments{command, "--model", model, "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.insert(arguments.end(), logs_given.begin(), logs_given.end());
    return test::run_furcula(arguments, 120);
  }
};

}  // namespace

TEST_CASE("identify writes its three files and says the parameters") {
  const Files f;
  const auto ran = f.run("identify", f.logs, {"--method", "both"});
  INFO(ran.err);
  CHECK(ran.status == 0);
  CHECK_THAT(ran.out, Catch::Contains("mass_kg") && Catch::Contains("identified"));
  std::vector<std::string> written;
  CHECK(test::run_program("/bin/ls", {f.out}).out ==
        "identification.json\nidentified_model.toml\nreport.html\ntraces\n");
  // The model that it writes is one that it reads, and does not overwrite.
  const auto over = test::run_furcula(
      {"identify", "--model", f.out + "/identified_model.toml", "--out", f.out, f.logs[0], f.logs[1]}, 120);
  CHECK(over.status == 2);
  CHECK_THAT(over.err, Catch::Contains("would be overwritten"));
  const auto again = test::run_furcula({"identify", "--model", f.out + "/identified_model.toml", "--out",
                                        f.out + "_again", f.logs[0], f.logs[1]},
                                       120);
  INFO(again.err);
  CHECK(again.status == 0);
}

TEST_CASE("Bad input to identify and diagnose ends with one message, status 3, and no output") {
  const Files f;
  struct Bad {
    const char* what;
    std::string log;
    const char* message;
  };
  const std::string header = "time_s,position_m,force_n\n";
  const std::vector<Bad> all{
      {"torn rows", header + "0,0,0\n0.001,0\n0.002\n", "fields"},
      {"missing column", "time_s,position_m\n0,0\n", "force_n"},
      {"time backwards", header + "0,0,0\n0.001,0,0\n0.0005,0,0\n", "time_s"},
      {"NaN", header + "0,0,0\n0.001,nan,0\n", "nan"},
      {"wrong unit", "time_s,position_mm,force_n\n0,0,0\n", "position_mm"},
      {"empty", "", ""},
      {"zeros", std::string(4096, '\0'), ""},
      {"too short", header + "0,0,0\n0.001,0,0\n", "2 rows"},
  };
  for (const std::string command : {"identify", "diagnose"})
    for (const Bad& bad : all) {
      const std::string path = f.folder.file("bad.csv", bad.log);
      const auto ran = f.run(command, {path, f.logs[0], f.logs[1]});
      INFO(command << ", " << bad.what << ": " << ran.err);
      CHECK(ran.status == 3);
      CHECK_THAT(ran.err, Catch::Contains("bad.csv") &&
                              (Catch::Contains("expected") || Catch::Contains("must have")) &&
                              Catch::Contains(bad.message));
      CHECK(std::count(ran.err.begin(), ran.err.end(), '\n') == 1);
      CHECK(test::run_program("/bin/ls", {f.out}).out.empty());
    }
}

TEST_CASE("One torn row costs identify and diagnose that row alone, and is told") {
  const Files f;
  const std::string good = log::format_log(test::axis_log(95.0, 203.5, 1e-4, 9, 2.0));
  const std::string path = f.folder.file("torn.csv", good.substr(0, good.rfind(',')));
  for (const std::string command : {"identify", "diagnose"}) {
    const auto ran = f.run(command, {path, f.logs[0], f.logs[1]});
    INFO(command << ": " << ran.err);
    CHECK(ran.status == 0);
    CHECK_THAT(ran.out,
               Catch::Contains("1 row refused: ") && Catch::Contains("torn.csv") && Catch::Contains("torn"));
  }
}

TEST_CASE("A directory for a log, a log given twice and an unusable window are refused") {
  const Files f;
  CHECK(f.run("diagnose", {f.folder.path()}).status == 3);
  const auto twice = f.run("diagnose", {f.logs[0], f.logs[1], f.logs[0]});
  CHECK(twice.status == 2);
  CHECK_THAT(twice.err, Catch::Contains("twice"));
  CHECK(f.run("diagnose", f.logs, {"--window-s", "-1"}).status == 2);
  CHECK(f.run("identify", f.logs, {"--folds", "1"}).status == 2);
  CHECK(f.run("identify", f.logs, {"--folds", "9"}).status == 3);
  CHECK(f.run("identify", f.logs, {"--method", "magic"}).status == 2);
}

TEST_CASE("An unwritable folder for the results is refused before the work") {
  const Files f;
  const std::string file = f.folder.file("not-a-folder", "x");
  const auto ran = test::run_furcula({"diagnose", "--model", f.model, "--out", file, f.logs[0], f.logs[1]});
  CHECK(ran.status == 2);
  CHECK_THAT(ran.err, Catch::Contains("not-a-folder") && Catch::Contains("folder"));
}
