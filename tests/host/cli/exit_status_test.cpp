// What the program says and returns when its arguments are unusable or its result cannot be written.
#include <catch2/catch.hpp>

#include "tests/host/cli/run_program.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;
using test::run_furcula;

TEST_CASE("help and version are results: status 0, on stdout") {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"--help"}, {"--version"}, {"check", "--help"}, {"effects", "--help"}}) {
    const test::Ran ran = run_furcula(arguments);
    CHECK(ran.status == 0);
    CHECK_THAT(ran.out, Contains("furcula"));
    CHECK(ran.err.empty());
  }
}

TEST_CASE("unusable arguments end with status 2 and one message on stderr") {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases{
      {{}, "A subcommand is required"},
      {{"chek"}, "no command 'chek'; expected one of"},
      {{"check"}, "LOG is required"},
      {{"check", "--machine", "hopper"}, "LOG is required"},
      {{"check", "--machine"}, "--machine"},
      {{"check", "--machine", "hopper", "--model", "m.toml", "x.csv"},
       "--machine and --model: expected one of them"},
      {{"check", "--machine", "hopper_linear", "x.csv"}, "(did you mean 'hopper'?)"},
      {{"check", "--machine", "hoper", "x.csv"},
       "--machine hoper: no such machine type; expected one of hopper"},
      {{"check", "--machine", "hopper", "--colour", "x.csv"}, "no option '--colour' of furcula check"},
      // What is required and misspelt is misspelt, not missing.
      {{"diagnose", "--modell=m.toml", "--out", "o", "x.csv"}, "(did you mean '--model'?)"},
      {{"sim", "--modell", "m.toml"}, "no option '--modell' of furcula sim; expected one of"},
      {{"effects", "coulomb"}, "did you mean 'coulomb_friction'?"},
      {{"effects", "--kind", "hexapod"}, "--kind: unknown kind 'hexapod'; expected one of hopper_linear"},
      {{"effects", "torque_gain_error", "--kind", "clutch_bench"},
       "no effect 'torque_gain_error' on clutch_bench"},
      {{"effects", "spring_preload", "--kind", "motor_axis"}, "no effect 'spring_preload' on motor_axis"},
      {{"effects", "--json", "--markdown"}, "--json and --markdown: expected one of them"},
  };
  for (const auto& [arguments, message] : cases) {
    const test::Ran ran = run_furcula(arguments);
    INFO(message);
    CHECK(ran.status == 2);
    CHECK(ran.out.empty());
    CHECK_THAT(ran.err, Contains(message));
    CHECK(ran.err.find('\n') == ran.err.size() - 1);
  }
}

TEST_CASE("a result that cannot be written is not a success") {
  const test::Ran ran =
      test::run_program("/bin/sh", {"-c", "exec " + test::program("furcula") + " effects > /dev/full"});
  CHECK(ran.status == 2);
  CHECK(ran.err == "furcula: stdout: cannot be written\n");
}
