// The loop on a robot that is a program: what it leaves, how it goes on, what it says.
#include "host/loop/loop.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/walk/files.hpp"
#include "tests/host/walk/walks.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

const std::string kModel = test::source("models/biped/biped.toml");

/// A loop with brief recordings, one iteration of a fit, and searches of a few walks.
struct Bench {
  test::TemporaryFolder folder;
  loop::LoopOptions options;
  std::string said;

  Bench() {
    options.model = kModel;
    options.walk = test::source("tests/host/walk/active_walk.toml");
    options.out = folder.path() + "/out";
    options.rounds = 1;
    options.steps = 1;
    options.threads = 2;
    options.identify.iterations = 1;
    options.say = [this](const std::string& line) { said += line + "\n"; };
  }
  /// `furcula walk sim` on a model file; its rows after `lines` are cut.
  std::string robot(const std::string& model, int lines) const {
    return test::program("furcula") + " walk sim --model " + model + " --walk {walk} --out " + folder.path() +
           "/whole.csv > /dev/null 2>&1; echo {round} >> " + folder.path() + "/ran; head -n " +
           std::to_string(lines) + " " + folder.path() + "/whole.csv > {log}";
  }
  std::string in(const std::string& name) const { return options.out + "/" + name; }
  bool has(const std::string& name) const { return std::filesystem::exists(in(name)); }
  std::string error() {
    said.clear();
    return test::error_message([&] { loop::run_loop(options); });
  }
  loop::LoopResult run() {
    said.clear();
    return loop::run_loop(options);
  }
  std::size_t trials() const {
    const std::string ran = test::text_of(folder.path() + "/ran");
    return static_cast<std::size_t>(std::count(ran.begin(), ran.end(), '\n'));
  }
};

}  // namespace

TEST_CASE("a loop ends where the robot walks, and is refused with other arguments") {
  Bench bench;
  bench.options.robot = bench.robot(kModel, 2000);
  bench.options.repetitions = 2;
  const loop::LoopResult r = bench.run();
  CHECK(r.walks);
  REQUIRE(r.rounds.size() == 1);
  REQUIRE(r.rounds[0].trials.size() == 2);
  CHECK(r.rounds[0].trials[1].walks);
  CHECK(r.rounds[0].trials[1].outcome.way_m == Approx(r.rounds[0].simulated.distance_m).epsilon(0.1));
  CHECK(r.rounds[0].asked_m == Approx(0.5 * r.rounds[0].simulated.distance_m));
  CHECK(bench.has("round_1/log_2.csv"));
  CHECK_FALSE(bench.has("round_1/identified_model.toml"));
  CHECK_THAT(bench.said, Contains("round 1: 2 of 2 trials stand"));
  const auto j = test::json_of(bench.in("loop.json"));
  CHECK(j["schema"] == "furcula-walk-loop/1");
  CHECK(j["walks"] == true);
  CHECK(j["rounds"][0]["trials"][0]["stands"] == true);
  CHECK(j["rounds"][0]["trials"][0]["fall_s"].is_null());

  // Nothing is left to do.
  bench.options.robot = "exit 1; {walk} {log}";
  CHECK(bench.run().walks);
  CHECK(bench.trials() == 2);

  const auto refused = [&](auto&& change, const std::string& what) {
    loop::LoopOptions other = bench.options;
    change(other);
    CHECK_THAT(test::error_message([&] { loop::run_loop(other); }),
               Contains("loop.json: of another loop: " + what) && Contains("or another folder"));
  };
  refused([](auto& o) { o.steps = 2; }, "steps '1', expected '2'");
  refused([](auto& o) { o.seed = 2; }, "seed '1', expected '2'");
  refused([](auto& o) { o.repetitions = 3; }, "repetitions '2', expected '3'");
  refused([](auto& o) { o.mode = walk::WalkMode::semi_passive; }, "mode 'active', expected 'semi_passive'");
  refused([](auto& o) { o.walk = test::source("models/biped/active_walk.toml"); }, "start 'a walk, ");
  const std::string heavier =
      bench.folder.file("heavier.toml", "[model]\nkind = \"biped\"\nschema = 1\nurdf = \"" +
                                            test::source("models/biped/furcula_biped.urdf") +
                                            "\"\n[deviations]\n\"mass@pelvis\" = 1.0\n");
  refused([&](auto& o) { o.model = heavier; }, "the robot's numbers, as a hash");
}

TEST_CASE("a loop goes on after its last finished step, from files that are whole") {
  Bench bench;
  // A robot whose trials are brief: the log ends after half a second, as after a fault.
  const std::string robot = bench.robot(kModel, 50);
  bench.options.robot = "exit 3; {walk} {log}";
  CHECK_THAT(bench.error(), Contains("ended with status 3"));
  CHECK(bench.has("round_1/walk.toml"));
  CHECK(bench.has("loop.json"));

  bench.options.robot = robot;
  bench.options.progress = [](double, const std::string& doing) {
    throw core::DataError("interrupted: " + doing);
  };
  CHECK_THAT(bench.error(), Contains("interrupted: round 1: windows of the model as given"));
  CHECK(bench.trials() == 1);
  CHECK(bench.has("round_1/log_1.csv"));
  CHECK_FALSE(bench.has("round_1/identified_model.toml"));
  CHECK_THAT(bench.said, Contains("the log ends after 0.4") && Contains("0 of 1 trials stand"));

  bench.options.progress = {};
  const loop::LoopResult r = bench.run();
  CHECK(bench.trials() == 2);  // that of the next walk
  CHECK_FALSE(r.walks);
  REQUIRE(r.rounds.size() == 2);
  CHECK(r.rounds[0].given->windows > 0);
  CHECK(r.rounds[0].identified->angle_rad > 0.0);
  CHECK_THAT(bench.said,
             Contains("windows, RMS as given and identified") &&
                 Contains("round 1: next: round_2/walk.toml, in simulation of the identified model: stands"));
  for (const char* name :
       {"round_1/identification.json", "round_1/identification.html", "round_1/identified_model.toml",
        "round_2/walk.json", "round_2/report.html", "round_2/walk.toml", "round_2/log_1.csv"})
    CHECK(bench.has(name));
  CHECK(test::json_of(bench.in("round_2/walk.json"))["seed"] == 1);
  const auto written = test::json_of(bench.in("loop.json"));
  CHECK(written["rounds"].size() == 2);
  CHECK(written["rounds"][0]["causes"].size() ==
        test::json_of(bench.in("round_1/identification.json"))["causes"].size());

  // Again: the same, and the robot does nothing.
  const loop::LoopResult again = bench.run();
  CHECK(bench.trials() == 2);
  CHECK(again.rounds[0].given->angle_rad == r.rounds[0].given->angle_rad);
  CHECK(test::json_of(bench.in("loop.json")) == written);
}

TEST_CASE("what a loop cannot use is said before anything is tried") {
  Bench bench;
  bench.options.robot = "walk {walk}";
  CHECK_THAT(bench.error(), Contains("no {log}"));
  bench.options.robot = "manual";
  walk::Walk other = test::found_walk();
  other.mode = walk::WalkMode::knee_passive;
  bench.options.walk = bench.folder.file("knee.toml", walk::format_walk(other));
  CHECK_THAT(bench.error(), Contains("'knee_passive'; expected active or semi_passive"));
  other = test::found_walk();
  other.robot = "another_robot";
  bench.options.walk = bench.folder.file("another.toml", walk::format_walk(other));
  CHECK_THAT(bench.error(), Contains("a walk of 'another_robot'; expected one of 'furcula_biped'"));
  CHECK_FALSE(std::filesystem::exists(bench.options.out));
}

TEST_CASE(
    "furcula walk loop ends with what the robot did, and with the exit status of a robot that does not walk") {
  test::TemporaryFolder folder;
  const std::string out = folder.path() + "/out";
  const auto ran = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments{"walk",  "loop",   "--model",
                                       kModel,  "--walk", test::source("tests/host/walk/active_walk.toml"),
                                       "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return test::run_furcula(arguments);
  };
  CHECK_THAT(ran({"--robot", "manual", "--rounds", "0"}).err,
             Contains("--rounds 0: expected from 1 to 1000"));
  CHECK_THAT(ran({"--robot", "manual", "--steps", "0"}).err, Contains("--steps 0"));
  const test::Ran failed = ran({"--robot", "false {walk} {log}"});
  CHECK(failed.status == 3);
  CHECK_THAT(failed.err, Contains("ended with status 1"));
  const test::Ran walks = ran({"--robot", test::program("furcula") + " walk sim --model " + kModel +
                                              " --walk {walk} --out {log} > /dev/null"});
  INFO(walks.err);
  CHECK(walks.status == 0);
  CHECK_THAT(walks.out, Contains("round 1: round_1/log_1.csv: stands") &&
                            Contains("the robot walks with " + out + "/round_1/walk.toml"));
}
