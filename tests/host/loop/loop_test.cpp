// The loop on a robot that is a program: what it leaves, how it goes on, what it says.
#include "host/loop/loop.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "host/log/reader.hpp"
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
  int errors_computed = 0;

  Bench() {
    options.model = kModel;
    options.walk = test::source("tests/host/walk/active_walk.toml");
    options.out = folder.path() + "/out";
    options.rounds = 1;
    options.exercise_s = 0.0;
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
  /// Where a step begins whose words end so; none is interrupted where it is empty. Counts errors that are computed.
  void interrupt_at(const std::string& step) {
    errors_computed = 0;
    options.progress = [this, step](double, const std::string& doing) {
      if (!step.empty() && doing.ends_with(step)) throw core::DataError("interrupted: " + doing);
      if (doing.find("errors of the model") != std::string::npos) ++errors_computed;
    };
  }
  bool has(const std::string& name) const { return std::filesystem::exists(in(name)); }
  std::string error() {
    said.clear();
    return test::error_message([&] { loop::run_loop(options); });
  }
  loop::LoopResult run() {
    said.clear();
    errors_computed = 0;
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
  CHECK(j["schema"] == "furcula-walk-loop/2");
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
  refused([](auto& o) { o.ensemble.deviations = 0.5; }, "other robots of a robust search '7, ");
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
  bench.interrupt_at("windows of the model as given");
  CHECK_THAT(bench.error(), Contains("interrupted: round 1: windows of the model as given"));
  CHECK(bench.trials() == 1);
  CHECK(bench.has("round_1/log_1.csv"));
  CHECK_FALSE(bench.has("round_1/identified_model.toml"));
  CHECK_THAT(bench.said, Contains("the log ends after 0.4") && Contains("0 of 1 trials stand"));

  // Of three errors that are left, two are there when the last one is begun.
  bench.interrupt_at("errors of the model of round 1 on " + bench.in("round_2/log_1.csv"));
  CHECK_THAT(bench.error(), Contains("interrupted"));
  CHECK(test::json_of(bench.in("loop.json"))["triangle"].size() == 3);
  CHECK_THAT(test::text_of(bench.in("report.html")), Contains("href=\"round_2/log_1.csv\""));

  bench.interrupt_at("");
  const loop::LoopResult r = bench.run();
  CHECK(bench.errors_computed == 1);
  CHECK(bench.trials() == 2);  // that of the next walk
  CHECK_FALSE(r.walks);
  REQUIRE(r.rounds.size() == 2);
  REQUIRE(r.rounds[0].identification);
  CHECK(r.rounds[0].identification->given.windows > 0);
  CHECK(r.rounds[0].identification->identified.angle_rad > 0.0);
  CHECK_THAT(bench.said,
             Contains("windows, RMS as given and identified") &&
                 Contains("round 1: next: round_2/walk.toml, in simulation of the identified model: stands"));
  for (const char* name :
       {"round_1/identification.json", "round_1/identification.html", "round_1/identified_model.toml",
        "round_2/walk.json", "round_2/report.html", "round_2/walk.toml", "round_2/log_1.csv"})
    CHECK(bench.has(name));
  CHECK(test::json_of(bench.in("round_2/walk.json"))["seed"] == 1);
  CHECK(test::json_of(bench.in("round_2/walk.json"))["ensemble"] == 7);
  CHECK_THAT(test::text_of(bench.in("round_2/report.html")),
             Contains("--from " + bench.in("round_1/walk.toml")));
  const auto written = test::json_of(bench.in("loop.json"));
  CHECK(written["rounds"].size() == 2);
  CHECK(written["rounds"][0]["causes"].size() ==
        test::json_of(bench.in("round_1/identification.json"))["causes"].size());

  // The errors of a single trial are those of its identification, and only they are of the fit.
  const auto training = test::json_of(bench.in("round_1/identification.json"))["training"];
  const auto& triangle = written["triangle"];
  REQUIRE(triangle.size() == 4);
  const auto error_of = [&](const nlohmann::json& model, unsigned round) {
    for (const auto& one : triangle)
      if (one["model"] == model && one["round"] == round) return one;
    return nlohmann::json();
  };
  for (const char* key : {"windows", "rms_angle_rad", "rms_attitude_rad", "rms_gyro_radps"}) {
    CHECK(error_of(nullptr, 1)[key] == training["given"][key]);
    CHECK(error_of(1, 1)[key].get<double>() ==
          Approx(training["identified"][key].get<double>()).epsilon(1e-3));
  }
  for (const nlohmann::json& model : {nlohmann::json(), nlohmann::json(1)})
    for (const unsigned round : {1u, 2u})
      CHECK(error_of(model, round)["training"] == (model == 1 && round == 1));

  // Again: the same, and the robot does nothing.
  const std::string page = test::text_of(bench.in("report.html"));
  const loop::LoopResult again = bench.run();
  CHECK(bench.trials() == 2);
  CHECK(again.rounds[0].identification->given.angle_rad == r.rounds[0].identification->given.angle_rad);
  CHECK(bench.errors_computed == 0);
  CHECK(test::json_of(bench.in("loop.json")) == written);
  CHECK(test::text_of(bench.in("report.html")) == page);

  // On another number of threads and from nothing but the steps' files: the same.
  const std::string text = test::text_of(bench.in("loop.json"));
  std::filesystem::remove(bench.in("loop.json"));
  bench.options.threads = 1;
  bench.run();
  CHECK(bench.errors_computed == 4);
  CHECK(test::text_of(bench.in("loop.json")) == text);
  CHECK(test::text_of(bench.in("report.html")) == page);

  // A trial that is done again has its errors computed again.
  std::filesystem::remove(bench.in("round_2/log_1.csv"));
  bench.run();
  CHECK(bench.trials() == 3);
  CHECK(bench.errors_computed == 2);
}

TEST_CASE(
    "before the first walk the robot moves its legs on its stand: that walk is searched about what is identified from it, and later identifications have it, too") {
  Bench bench;
  bench.options.exercise_s = 4.0;
  bench.options.seed = 7;
  bench.options.robot = bench.robot(kModel, 150);
  const loop::LoopResult r = bench.run();
  CHECK_THAT(bench.said, Contains("round 0: round_0/log_1.csv: 1.4") && Contains("s on the stand"));
  CHECK_THAT(test::text_of(bench.in("round_0/walk.toml")), Contains("exercise_s = 4"));
  CHECK_THAT(test::text_of(bench.in("round_1/walk.toml")), !Contains("exercise_s"));
  CHECK_THAT(test::text_of(bench.in("round_1/identification.html")),
             Contains(bench.in("round_0/log_1.csv")) && Contains(bench.in("round_1/log_1.csv")));
  const log::Log log = log::read_log(bench.in("round_0/log_1.csv"), "tree");
  const auto& knee = log.at("angle_left_knee_rad");
  CHECK(*std::max_element(knee.begin(), knee.end()) - *std::min_element(knee.begin(), knee.end()) > 0.05);
  const auto j = test::json_of(bench.in("loop.json"));
  CHECK(j["exercise"]["log"] == "round_0/log_1.csv");
  // The model of the exercise has the first walk as the first it has not seen.
  REQUIRE(j["triangle"].size() == 5);
  CHECK(r.triangle.contains({0, 1, 1}));
  CHECK(j["exercise"]["training"] == test::json_of(bench.in("round_0/identification.json"))["training"]);
  REQUIRE(r.of_exercise);
  CHECK(r.of_exercise->given.windows > 0);
  CHECK_THAT(bench.said,
             Contains("round 0: next: round_1/walk.toml, in simulation of the identified model: stands"));
  // Each search has the next seed, and begins with one of the walks so far: at first with the given one.
  CHECK(test::json_of(bench.in("round_1/walk.json"))["seed"] == 7);
  CHECK(test::json_of(bench.in("round_2/walk.json"))["seed"] == 8);
  CHECK_THAT(test::text_of(bench.in("round_1/report.html")), Contains("--from " + bench.options.walk));
  CHECK_THAT(test::text_of(bench.in("round_1/report.html")),
             Contains(bench.in("round_0/identified_model.toml")));
  // Nothing is left to do.
  const auto written = test::json_of(bench.in("loop.json"));
  bench.run();
  CHECK(bench.trials() == 3);
  CHECK(bench.errors_computed == 0);
  CHECK(test::json_of(bench.in("loop.json")) == written);
  CHECK(loop::loop_in(bench.in("loop.json")).of_exercise);

  // What is done in round 0 is there, and is not done again, where its search or the first trial is interrupted.
  std::filesystem::remove_all(bench.in("round_1"));
  std::filesystem::remove(bench.in("round_0/identified_model.toml"));
  std::filesystem::remove(bench.in("loop.json"));
  bench.options.progress = [&](double, const std::string& doing) {
    if (bench.has("round_0/identified_model.toml")) throw core::DataError("interrupted: " + doing);
  };
  const std::size_t trials = bench.trials();
  CHECK_THAT(bench.error(), Contains("interrupted: round 0"));
  CHECK_FALSE(bench.has("round_1/walk.toml"));
  CHECK(test::json_of(bench.in("loop.json"))["exercise"] == written["exercise"]);
  bench.interrupt_at("");
  CHECK(bench.run().rounds[0].simulated.distance_m == r.rounds[0].simulated.distance_m);
  CHECK(bench.trials() == trials + 1);  // of the first walk; that of the second is there

  // A semi-passive walk is prepared by an exercise with its pins, and only an identification by windows has one.
  Bench other;
  other.options.exercise_s = 4.0;
  other.options.mode = walk::WalkMode::semi_passive;
  other.options.robot = "exit 3; {walk} {log}";
  CHECK_THAT(other.error(), Contains("ended with status 3"));
  CHECK(walk::read_walk(other.in("round_0/walk.toml")).mode == walk::WalkMode::semi_passive);
  other.options.out += "_whole";
  other.options.identify_by = loop::IdentifyBy::whole_run;
  CHECK_THAT(other.error(), Contains("ended with status 3"));
  CHECK_FALSE(other.has("round_0/walk.toml"));
  CHECK(other.has("round_1/walk.toml"));

  // A robot that walks instead, and one that hangs instead of walking.
  Bench standing;
  standing.options.exercise_s = 4.0;
  standing.options.robot = "sed -i /exercise_s/d {walk}; " + standing.robot(kModel, 250);
  CHECK_THAT(standing.error(),
             Contains("a foot is loaded") && Contains("on its stand") && Contains("goes on with this trial"));
  CHECK_FALSE(standing.has("round_0/log_1.csv"));
  Bench hanging;
  hanging.options.robot = "sed -i 's/^mode/exercise_s = 4.0\\nmode/' {walk}; " + hanging.robot(kModel, 250);
  CHECK_THAT(hanging.error(), Contains("no foot is ever loaded") && Contains("walks"));
  hanging.options.walk = bench.in("round_0/walk.toml");
  CHECK_THAT(hanging.error(), Contains("an exercise on the stand; expected a walk"));
}

TEST_CASE("a robot's model has less error on its walk than a model without its friction") {
  Bench bench;
  const std::string rubbing =
      bench.folder.file("rubbing.toml", "[model]\nkind = \"biped\"\nschema = 1\nurdf = \"" +
                                            test::source("models/biped/furcula_biped.urdf") +
                                            "\"\n[deviations]\n\"coulomb_friction@left_knee\" = 20.0\n");
  bench.options.robot = bench.robot(rubbing, 300);
  const auto error_of = [&](const std::string& model) {
    bench.options.model = model;
    bench.options.out = bench.folder.path() + "/" + std::to_string(bench.trials());
    bench.interrupt_at("windows of the model as given");
    bench.error();
    return test::json_of(bench.in("loop.json"))["triangle"][0];
  };
  const nlohmann::json own = error_of(rubbing), other = error_of(kModel);
  for (const char* key : {"rms_angle_rad", "rms_angle_attitude_rad"})
    CHECK(own[key].get<double>() < 0.6 * other[key].get<double>());
}

TEST_CASE(
    "a loop by whole walks has Eq. 3 in place of causes, and one without identification searches about the model as given") {
  Bench bench;
  bench.options.identify_by = loop::IdentifyBy::whole_run;
  bench.options.steps = 60'000;
  bench.options.robot = bench.robot(kModel, 250);
  const loop::LoopResult r = bench.run();
  REQUIRE(r.rounds.size() == 2);
  REQUIRE(r.rounds[0].identification->whole_run_rad);
  CHECK(r.rounds[0].identification->whole_run_rad->second <=
        r.rounds[0].identification->whole_run_rad->first);
  CHECK(r.rounds[0].identification->causes.empty());
  CHECK_THAT(bench.said, Contains("round 1: model error (Eq. 3) over whole walks: "));
  const auto j = test::json_of(bench.in("loop.json"));
  CHECK(j["settings"]["identify"] == "whole_run");
  CHECK(j["rounds"][0]["whole_run"]["start_rad"].get<double>() ==
        r.rounds[0].identification->whole_run_rad->first);
  // The model as given on its own walk, and what was fitted to it: the first two of the triangle.
  CHECK(j["triangle"][0]["whole_run_rad"].get<double>() ==
        Approx(r.rounds[0].identification->whole_run_rad->first));
  for (const auto& cell : j["triangle"])
    if (cell["model"] == 1 && cell["round"] == 1)
      CHECK(cell["whole_run_rad"].get<double>() ==
            Approx(r.rounds[0].identification->whole_run_rad->second).epsilon(1e-3));
  CHECK(bench.has("round_1/identified_model.toml"));
  const auto numbers = test::json_of(bench.in("round_1/identification.json"));
  CHECK(numbers["parameters"].size() > 260);
  CHECK(numbers["parameters"][0]["posterior_sd"].is_null());
  CHECK(numbers["whole_run"]["simulations"].get<int>() > 1);
  CHECK_FALSE(bench.has("round_1/identification.html"));
  const std::string page = test::text_of(bench.in("report.html"));
  CHECK(page.find("identification.html") == std::string::npos);
  CHECK_THAT(page, Contains("Identified by a search over whole walks"));
  // It goes on with what is there.
  const std::size_t trials = bench.trials();
  CHECK(bench.run().rounds[0].identification->whole_run_rad == r.rounds[0].identification->whole_run_rad);
  CHECK(bench.trials() == trials);

  Bench none;
  none.options.identify_by = loop::IdentifyBy::none;
  none.options.ensemble.robots = 0;
  none.options.robot = none.robot(kModel, 250);
  const loop::LoopResult again = none.run();
  CHECK(again.rounds.size() == 2);
  CHECK_FALSE(again.rounds[0].identification);
  CHECK_FALSE(none.has("round_1/identified_model.toml"));
  CHECK(none.has("round_2/walk.toml"));
  for (const auto& [cell, errors] : again.triangle) CHECK(cell.model == loop::kGiven);
  CHECK_THAT(test::text_of(none.in("round_2/report.html")), !Contains("--robust"));
  none.options.identify_by = loop::IdentifyBy::whole_run;
  CHECK_THAT(none.error(), Contains("identify 'none', expected 'whole_run'"));
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
  CHECK_THAT(ran({"--robot", "manual", "--exercise-s", "-1"}).err,
             Contains("--exercise-s -1: expected 0, or from 4 to 500"));
  CHECK_THAT(ran({"--robot", "manual", "--robots", "-1"}).err,
             Contains("--robots -1: expected from 0 to 1000"));
  CHECK_THAT(ran({"--robot", "manual", "--identify", "guess"}).err, Contains("--identify"));
  CHECK_THAT(ran({"--robot", "manual", "--deviations", "nan"}).err,
             Contains("--deviations nan: expected from 0 to 2"));
  const test::Ran failed = ran({"--exercise-s", "0", "--robot", "false {walk} {log}"});
  CHECK(failed.status == 3);
  CHECK_THAT(failed.err, Contains("ended with status 1"));
  const test::Ran walks = ran(
      {"--exercise-s", "0", "--robot",
       test::program("furcula") + " walk sim --model " + kModel + " --walk {walk} --out {log} > /dev/null"});
  INFO(walks.err);
  CHECK(walks.status == 0);
  CHECK_THAT(walks.out, Contains("round 1: round_1/log_1.csv: stands") &&
                            Contains("the robot walks with " + out + "/round_1/walk.toml"));
}
