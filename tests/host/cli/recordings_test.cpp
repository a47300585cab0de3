// What `identify` and `diagnose` say about their logs and folders, and what a failed run leaves behind.
#include <catch2/catch.hpp>
#include <filesystem>

#include "host/machines/rules.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/model/example.hpp"

using namespace furcula;
using Catch::Contains;
using test::run_furcula;

namespace {

/// An axis at rest for 0.2 s: less than half of a prediction window.
std::string short_log() {
  std::string text = "time_s,position_m,force_n\n";
  for (int i = 0; i < 200; ++i) text += std::to_string(1e-3 * i) + ",0,0\n";
  return text;
}

const std::string kAxisModel =
    "[model]\nkind = \"motor_axis\"\nschema = 1\n[parameters]\nmass_kg = 60.0\ndamping_nspm = 90.0\n";

}  // namespace

TEST_CASE("a run that fails takes the empty folders with it that it has made, and no others") {
  test::TemporaryFolder folder;
  const std::string model = folder.file("m.toml", kAxisModel + "[free]\nmass_kg = [50.0, 70.0]\n");
  const std::string a = folder.file("a.csv", short_log()), b = folder.file("b.csv", short_log());
  for (const std::string command : {"identify", "diagnose"}) {
    INFO(command);
    const std::string outer = folder.path() + "/" + command, there = folder.path() + "/there";
    const auto run = [&](const std::string& out) {
      return run_furcula({command, "--model", model, "--out", out, a, b});
    };
    CHECK(run(outer + "/inner/").status == 3);
    CHECK_FALSE(std::filesystem::exists(outer));

    std::filesystem::create_directory(there);
    CHECK(run(there).status == 3);
    CHECK(std::filesystem::exists(there));
    CHECK(run(there + "/inner").status == 3);
    CHECK(std::filesystem::exists(there));
    CHECK_FALSE(std::filesystem::exists(there + "/inner"));
  }
}

TEST_CASE("logs that are all held out, or none, are unusable arguments") {
  test::TemporaryFolder folder;
  const std::string model = folder.file("m.toml", kAxisModel), log = folder.file("a.csv", short_log());
  for (const std::string command : {"identify", "diagnose"}) {
    INFO(command);
    const test::Ran held =
        run_furcula({command, "--model", model, "--out", folder.path() + "/out", "--hold-out", log});
    CHECK(held.status == 2);
    CHECK_THAT(held.err, Contains("all logs are held out and none is left to fit; expected some before"));
    const test::Ran none = run_furcula({command, "--model", model, "--out", folder.path() + "/out"});
    CHECK(none.status == 2);
    CHECK_THAT(none.err, Contains("no log is given; expected at least one"));
    CHECK(folder.names() == std::vector<std::string>{"a.csv", "m.toml"});
  }
}

TEST_CASE("a model that leaves nothing free cannot be identified: the message names file and section") {
  test::TemporaryFolder folder;
  const std::string log = folder.file("a.csv", short_log());
  for (const char* free : {"", "[free]\n"}) {
    const std::string model = folder.file("m.toml", kAxisModel + free);
    const test::Ran ran = run_furcula({"identify", "--model", model, "--out", folder.path() + "/out", log});
    CHECK(ran.status == 3);
    CHECK(ran.err == "furcula: " + model +
                         ": no parameter in [free], so there is nothing to identify; expected at least one, "
                         "as in [free] mass_kg = [lower, upper]\n");
  }
  CHECK_FALSE(std::filesystem::exists(folder.path() + "/out"));
}

TEST_CASE("the help of --window-s names each kind that is cut into windows of that length, and no other") {
  std::string help = run_furcula({"diagnose", "--help"}).out;
  help = help.substr(help.find("--window-s"), help.find("--out") - help.find("--window-s"));
  for (const auto& machine : dynamics::kMachines) {
    INFO(std::string(machine.name));
    const bool in_intervals = machines::rules(machine.kind).cut == machines::Cut::intervals;
    CHECK((help.find(machine.name) != std::string::npos) == in_intervals);
  }
  CHECK_THAT(help, Contains("torsion_pendulum") && Contains("tree"));
}

TEST_CASE("what a robot's file was taken for is printed when the recordings are then refused") {
  test::TemporaryFolder folder;
  folder.file(
      "r.urdf",
      "<robot name=\"r\"><link name=\"base\"/><link name=\"arm\"><inertial><origin xyz=\"0 0 -0.2\"/><mass value=\"1\"/>"
      "<inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.01\"/></inertial></link>"
      "<joint name=\"hip\" type=\"continuous\"><parent link=\"base\"/><child link=\"arm\"/><axis xyz=\"0 1 0\"/></joint>"
      "<gazebo reference=\"hip\"><springStiffness>4</springStiffness><springReference>0.3</springReference></gazebo></robot>");
  const std::string model = folder.file(
      "m.toml",
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"r.urdf\"\n[free]\n\"damping_nmspr.hip\" = [0.0, 1.0]\n");
  // Its angle without its torque.
  std::string text = "# machine_type: tree\ntime_s,angle_hip_rad\n";
  for (int i = 0; i < 200; ++i)
    text += std::to_string(1e-2 * i) + "," + std::to_string(0.001 * (i % 50)) + "\n";
  const std::string log = folder.file("a.csv", text), other = folder.file("b.csv", text);
  for (const std::string command : {"diagnose", "identify", "check"}) {
    INFO(command);
    std::vector<std::string> arguments{command, "--model", model};
    if (command != "check") arguments.insert(arguments.end(), {"--out", folder.path() + "/out"});
    arguments.insert(arguments.end(), {log, other});
    const test::Ran ran = run_furcula(arguments);
    CHECK(ran.status == 3);
    CHECK_THAT(ran.err, Contains("r.urdf: note: The URDF gives joints a spring") &&
                            Contains("rest_rad = 0.3") && Contains("joint 'hip' has no column"));
  }
}

TEST_CASE("what is read is not overwritten by results or traces") {
  test::TemporaryFolder folder;
  const std::string out = folder.path() + "/out";
  std::filesystem::create_directories(out + "/traces");
  const std::string model = folder.file("m.toml", kAxisModel + "[free]\nmass_kg = [50.0, 70.0]\n");
  const std::string log = folder.file("out/traces/a.csv", short_log()),
                    result = folder.file("out/extended_model.toml", kAxisModel),
                    other = folder.file("b.csv", short_log());
  for (const std::string command : {"identify", "diagnose"}) {
    INFO(command);
    const test::Ran in_traces = run_furcula({command, "--model", model, "--out", out, other, log});
    CHECK(in_traces.status == 2);
    CHECK_THAT(in_traces.err,
               Contains("a.csv, which is read, lies in") && Contains("expected another folder"));
    // By another way to the same folder, too.
    CHECK(
        run_furcula({command, "--model", model, "--out", folder.path() + "/./out/", other, "--hold-out", log})
            .status == 2);
    const test::Ran own = run_furcula({command, "--model", result, "--out", out, other});
    CHECK(own.status == 2);
    CHECK_THAT(own.err, Contains("extended_model.toml, which is read, would be overwritten"));
    CHECK(run_furcula({command, "--model", result, "--out", folder.path() + "/again", other}).status == 3);
  }
}
