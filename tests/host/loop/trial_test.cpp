// Trials: the robot's command, the log that it writes, how a trial ended.
#include "host/loop/trial.hpp"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "furcula/dynamics/biped/design.hpp"
#include "host/log/writer.hpp"
#include "host/walk/simulation.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/walk/files.hpp"
#include "tests/host/walk/walks.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

floating::Machine nominal() {
  floating::Machine m;
  m.robot = dynamics::biped::design();
  return m;
}

/// The first rows of a walk.
log::Log log_of(double until_s) {
  walk::RolloutOptions options;
  log::Log log =
      simulate_walk(dynamics::biped::design(), options, test::found_walk().parameters, 0.01, {}).log;
  for (auto& [name, column] : log.columns) column.resize(static_cast<std::size_t>(until_s / 0.01));
  return log;
}

/// A robot whose log is prepared, in a folder whose name has to be quoted.
struct Bench {
  test::TemporaryFolder folder;
  std::string at = folder.path() + "/it's here";
  std::string prepared = folder.path() + "/prepared.csv";
  std::vector<std::string> said;
  loop::Request request;

  explicit Bench(const std::string& robot) {
    std::filesystem::create_directory(at);
    log::write_log(log_of(1.0), prepared, log::Comments::with);
    request.robot = robot;
    request.walk = at + "/walk.toml";
    request.log = at + "/log_2.csv";
    request.round = 3;
    request.repetition = 2;
    request.say = [this](const std::string& line) { said.push_back(line); };
    std::ofstream(request.walk) << walk::format_walk(test::found_walk());
  }
  std::string error() {
    return test::error_message([&] { loop::get_log(request); });
  }
};

}  // namespace

TEST_CASE("placeholders of a robot's command are words of the shell, and other braces stay") {
  loop::Request r{"f() { cp {walk} {log}; }; f {round} {repetition} ${X}",
                  "/a b/walk.toml",
                  "/a b/log_1.csv",
                  3,
                  2,
                  0.3,
                  {}};
  CHECK(loop::command_of(r) == "f() { cp '/a b/walk.toml' '/a b/new_log_1.csv'; }; f 3 2 ${X}");
  r.walk = "/{log}/walk.toml";
  r.robot = "{walk} {log}";
  CHECK(loop::command_of(r) == "'/{log}/walk.toml' '/a b/new_log_1.csv'");
  r.robot = "walk {walk}";
  CHECK_THAT(test::error_message([&] { loop::command_of(r); }),
             Contains("no {log}") && Contains("expected a command with {walk} and {log}, or manual"));
}

TEST_CASE("a trial's log gets its name when it is whole, and a log that is there is not asked for again") {
  Bench bench("");
  bench.request.robot = "echo {round} {repetition} >> " + bench.folder.path() +
                        "/ran; test -s {walk} && cp " + bench.prepared + " {log}";
  CHECK(bench.error().empty());
  CHECK(test::text_of(bench.request.log) == test::text_of(bench.prepared));
  CHECK_FALSE(std::filesystem::exists(loop::incoming(bench.request.log)));
  CHECK(bench.error().empty());
  CHECK(test::text_of(bench.folder.path() + "/ran") == "3 2\n");
  CHECK(loop::read_recording(bench.request.log, bench.request).rows.size() == 100);
}

TEST_CASE("a robot's command that fails is told, with how to go on, and leaves no log") {
  const auto told = [](const std::string& robot, const std::string& what) {
    Bench bench(robot);
    CHECK_THAT(bench.error(), Contains(what) && Contains(robot.substr(0, 4)) &&
                                  Contains("the same command goes on with this trial"));
    CHECK_FALSE(std::filesystem::exists(bench.request.log));
  };
  told("exit 7; {walk} {log}", "ended with status 7");
  told("kill -INT $$; {walk} {log}", "ended by signal 2");
  told("cat {walk} > /dev/null || {log}", "wrote no log");
}

TEST_CASE("a log that cannot be used is told and kept under another name") {
  const auto told = [](const std::string& robot, const std::string& what) {
    Bench bench(robot);
    CHECK_THAT(bench.error(), Contains("the robot's log cannot be used") && Contains("new_log_2.csv") &&
                                  Contains(what) && Contains("goes on with this trial"));
    CHECK_FALSE(std::filesystem::exists(bench.request.log));
    CHECK(std::filesystem::exists(loop::incoming(bench.request.log)));
  };
  told("cp {walk} {log}", "is not a number; expected a finite decimal number");
  told("echo time_s,roll_rad > {log}; echo 0.0,0.0 >> {log}; echo 0.01,0.0 >> {log}; : {walk}",
       "no column 'angle_left_hip_yaw_rad'");
  Bench bench("");
  const std::string brief = bench.folder.path() + "/brief.csv";
  log::write_log(log_of(0.1), brief, log::Comments::with);
  bench.request.robot = "cp " + brief + " {log}; : {walk}";
  CHECK_THAT(bench.error(), Contains("no window of 0.15 s"));
}

TEST_CASE("of a trial by hand the log that is there already is taken") {
  Bench bench("manual");
  std::filesystem::copy_file(bench.prepared, loop::incoming(bench.request.log));
  CHECK(bench.error().empty());
  CHECK(test::text_of(bench.request.log) == test::text_of(bench.prepared));
  REQUIRE_FALSE(bench.said.empty());
  CHECK_THAT(bench.said[0], Contains("copy " + bench.request.walk) && Contains("new_log_2.csv"));
}

TEST_CASE(
    "a trial ends in a fall where roll leaves 0.35 rad, and stands where its log is as long as the walk") {
  log::Log log = log_of(10.0);
  const loop::Outcome whole = loop::outcome_of(floating::recording_of(log), nominal(), 10.0);
  CHECK(whole.stands);
  CHECK(whole.time_s == Approx(9.99));
  CHECK(whole.way_m == Approx(log.at("base_x_m").back()).epsilon(0.08));
  CHECK_FALSE(loop::outcome_of(floating::recording_of(log), nominal(), 20.0).stands);

  log::Log falls = log;
  for (std::size_t k = 400; k < falls.rows(); ++k) falls.columns["roll_rad"][k] = 0.36;
  const loop::Outcome fell = loop::outcome_of(floating::recording_of(falls), nominal(), 10.0);
  CHECK_FALSE(fell.stands);
  CHECK(fell.fall_s.value() == Approx(4.0));
  CHECK(fell.time_s == Approx(3.84));  // the rows before the last 0.15 s
  CHECK(fell.way_m < whole.way_m);
}
