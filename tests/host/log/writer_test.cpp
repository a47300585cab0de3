// Written logs read back the same.
#include "host/log/writer.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <stdexcept>

#include "host/log/reader.hpp"
#include "tests/host/cli/run_program.hpp"

using namespace furcula;

namespace {

log::Log example() {
  return {"a.csv",
          "hopper",
          {{"experiment", "drop-01"}, {"machine_type", "hopper"}},
          {{"torque_cmd_nm", {0.0, -0.1, 1e300}},
           {"time_s", {0.0, 0.001, 0.3}},
           {"height_m", {0.1, 1.0 / 3.0, std::numeric_limits<double>::denorm_min()}},
           {"contact", {1.0, 0.0, 0.0}},
           {"knee_c", {20.0, 21.5, 22.0}},
           {"a, \"b\"", {1.0, 2.0, 3.0}}}};
}

}  // namespace

TEST_CASE("a log is written in the contract's order with the shortest numbers") {
  CHECK(log::format_log(example()) ==
        "# format: furcula-log/1\n# machine_type: hopper\n# experiment: drop-01\n"
        "time_s,height_m,contact,torque_cmd_nm,\"a, \"\"b\"\"\",knee_c\n"
        "0,0.1,1,0,1,20\n0.001,0.3333333333333333,0,-0.1,2,21.5\n0.3,5e-324,0,1e+300,3,22\n");
}

TEST_CASE("a written log reads back to the bit") {
  test::TemporaryFolder folder;
  const std::string path = folder.path() + "/out.csv";
  log::write_log(example(), path);
  const log::Log back = log::read_log(path, "hopper");
  CHECK(back.columns == example().columns);
  CHECK(back.metadata.at("experiment") == "drop-01");
  CHECK(log::format_log(back) == log::format_log(example()));
}

TEST_CASE("a log that could not be read back is not written") {
  test::TemporaryFolder folder;
  log::Log bad = example();
  bad.columns["height_m"][1] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THROWS_AS(log::write_log(bad, folder.path() + "/out.csv"), std::invalid_argument);
  bad = example();
  bad.columns["height_m"].pop_back();
  CHECK_THROWS_AS(log::format_log(bad), std::invalid_argument);
  bad = example();
  bad.metadata["note"] = "two\nlines";
  CHECK_THROWS_AS(log::format_log(bad), std::invalid_argument);
  bad = example();
  bad.rig = "bicycle";
  CHECK_THROWS_AS(log::format_log(bad), std::invalid_argument);
  CHECK(folder.names().empty());
}
