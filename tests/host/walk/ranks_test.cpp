// A search on several MPI processes, as a user runs it.
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/host/cli/run_program.hpp"
#include "tests/host/walk/files.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

/// As root too, and with more ranks than processors.
test::Ran mpirun(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"--allow-run-as-root", "--oversubscribe"});
  return test::run_program("/usr/bin/mpirun", arguments);
}

std::vector<std::string> search(const std::string& steps, const std::string& out) {
  return {test::program("furcula-mpi"),
          "walk",
          "search",
          "--model",
          test::source("models/biped/biped.toml"),
          "--steps",
          steps,
          "--seed",
          "4",
          "--out",
          out};
}

}  // namespace

TEST_CASE("one seed gives one walk on any number of MPI ranks, the one of furcula itself") {
  const test::TemporaryFolder folder;
  std::vector<std::string> alone = search("700000", folder.path() + "/alone");
  alone.erase(alone.begin());
  CHECK(test::run_furcula(alone).status == 4);  // too few steps for a walk
  const std::string walk = test::text_of(folder.path() + "/alone/walk.toml");
  CHECK(walk.size() > 1000);
  for (const char* ranks : {"1", "2", "4"}) {
    std::vector<std::string> arguments = search("700000", folder.path() + "/" + ranks);
    arguments.insert(arguments.begin(), {"-n", ranks});
    const test::Ran ran = mpirun(arguments);
    INFO(ranks << " ranks: " << ran.err);
    CHECK_THAT(ran.err, Contains("no walk within all limits that gets ahead was found in this budget"));
    CHECK(test::text_of(folder.path() + "/" + ranks + "/walk.toml") == walk);
    CHECK(test::json_of(folder.path() + "/" + ranks + "/walk.json")["rollouts"] ==
          test::json_of(folder.path() + "/alone/walk.json")["rollouts"]);
  }
}

TEST_CASE("a robust search gives one walk on any number of MPI ranks") {
  const test::TemporaryFolder folder;
  std::string walk;
  for (const char* ranks : {"1", "3"}) {
    // From a walk that stands, so that the other robots are asked.
    std::vector<std::string> arguments = search("4000000", folder.path() + "/" + ranks);
    arguments.insert(arguments.begin(), {"-n", ranks});
    arguments.insert(arguments.end(),
                     {"--robust", "--from", test::source("tests/host/walk/active_walk.toml")});
    const test::Ran ran = mpirun(arguments);
    INFO(ranks << " ranks: " << ran.err);
    CHECK(test::json_of(folder.path() + "/" + ranks + "/walk.json")["ensemble"] == 7);
    const std::string found = test::text_of(folder.path() + "/" + ranks + "/walk.toml");
    if (walk.empty()) walk = found;
    CHECK(found == walk);
  }
}

TEST_CASE("a rank that dies ends the job, which says so and keeps a checkpoint that one process goes on with",
          "[slow]") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path() + "/out";
  // mpirun waits so long, s, for those that it has told to end.
  std::vector<std::string> arguments{"--mca", "odls_base_sigkill_timeout", "5", "-n", "2"};
  // Rank 1 is killed a second after the search has begun.
  arguments.insert(arguments.end(), {"/bin/bash", "-c",
                                     "if [ \"$OMPI_COMM_WORLD_RANK\" = 1 ]; then (until [ -d '" + out +
                                         "' ]; do sleep 0.1; done; sleep 1; kill -9 $$) & fi; exec \"$@\"",
                                     "rank"});
  const auto endless = search("1000000000000", out);
  arguments.insert(arguments.end(), endless.begin(), endless.end());
  const test::Ran died = mpirun(arguments);
  INFO(died.out << died.err);
  CHECK(died.status > 0);
  CHECK_THAT(died.out + died.err, Contains("rank 1") && Contains("signal 9"));
  // Open MPI 5 gives the other ranks no time to write one: the last of each 10 s is what stays.
  const test::Ran version = test::run_program("/usr/bin/mpirun", {"--version"});
  if (version.out.find("(Open MPI) 4.") == std::string::npos) return;
  CHECK_FALSE(test::text_of(out + "/search.checkpoint").empty());

  std::vector<std::string> on = search("100000", folder.path() + "/on");
  on.erase(on.begin());
  on.insert(on.end(), {"--resume", out + "/search.checkpoint"});
  const test::Ran ran = test::run_furcula(on);
  CHECK_THAT(ran.err, Contains("goes on after") && Contains("another build"));
  CHECK(test::json_of(folder.path() + "/on/walk.json")["steps"].get<double>() >= 100000);
}

TEST_CASE("a mistake ends every rank") {
  std::vector<std::string> arguments = search("-5", "/nowhere");
  arguments.insert(arguments.begin(), {"-n", "2"});
  const test::Ran ran = mpirun(arguments);
  CHECK(ran.status == 2);
  CHECK_THAT(ran.err, Contains("--steps -5"));
}
