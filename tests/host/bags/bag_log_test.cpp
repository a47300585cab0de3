// Bags as logs: files that @mcap/core and sqlite3 wrote (data/make.mjs) against the numbers that were put in.
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <sstream>

#include "host/log/reader.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/error_message.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

std::string data(const std::string& name) { return test::source("tests/host/bags/data/" + name); }

log::Log read(const std::string& name, const std::string& map_text = {}) {
  if (map_text.empty()) return log::read_log(data(name), "tree");
  const log::ColumnMap map = log::parse_column_map(map_text, "map.toml");
  return log::read_log(data(name), "tree", &map);
}

std::string refused(const std::string& name, const std::string& map_text = {}) {
  return test::error_message([&] { read(name, map_text); });
}

std::string notes_of(const log::Log& log) {
  std::string out;
  for (const std::string& note : log.notes) out += note + "\n";
  return out;
}

const std::string kCommands =
    "torque_cmd_shoulder_nm = { column = \"/effort_controller/commands/data[0]\" }\n"
    "torque_cmd_elbow_nm = { column = \"/effort_controller/commands/data[1]\" }\n";

}  // namespace

TEST_CASE("a simulated robot's log that another library wrote as MCAP reads back with the same numbers") {
  const log::Log csv = log::read_log(data("arm.csv"), "tree"), bag = read("arm.mcap", kCommands);
  REQUIRE(bag.rows() == csv.rows());
  REQUIRE(bag.columns.size() == csv.columns.size());
  for (const auto& [name, values] : csv.columns) {
    INFO(name);
    REQUIRE(bag.has(name));
    if (name != "time_s") CHECK(bag.at(name) == values);
  }
  for (std::size_t i = 0; i < csv.rows(); ++i)
    CHECK(bag.time_s()[i] == Approx(csv.time_s()[i]).margin(1e-12));
}

TEST_CASE("chunks, compression, index and splits do not change what is read") {
  const log::Log csv = log::read_log(data("arm.csv"), "tree");
  for (const char* name :
       {"plain.mcap", "chunks.mcap", "lz4.mcap", "messages_zstd.mcap", "whole.mcap.zstd", "bag",
        "bag/metadata.yaml", "bag_zstd", "bag_zstd/all_0.db3.zstd", "messages_zstd.db3"}) {
    INFO(name);
    const log::Log bag = read(name, kCommands);
    REQUIRE(bag.rows() == (std::string(name) == "messages_zstd.db3" ? 10 : 20));
    for (const auto& [column, values] : csv.columns)
      for (std::size_t i = 0; i < bag.rows(); ++i)
        CHECK(bag.at(column)[i] == Approx(values[i]).margin(column == "time_s" ? 1e-12 : 0.0).epsilon(0.0));
  }
}

TEST_CASE("the splits of a bag come in the order of their numbers where no metadata lists them") {
  const test::TemporaryFolder folder;
  const auto bytes = [](const std::string& path) {
    std::ostringstream out;
    out << std::ifstream(path, std::ios::binary).rdbuf();
    return out.str();
  };
  folder.file("bag_9.db3", bytes(data("bag/bag_0.db3")));
  folder.file("bag_10.db3", bytes(data("bag/bag_1.db3")));
  const log::Log log = log::read_log(folder.path(), "tree");
  CHECK(log.rows() == 20);
  CHECK(log.at("angle_elbow_rad") == read("bag").at("angle_elbow_rad"));
}

TEST_CASE("topics that a map names are interpolated at the rows' times, commands are held") {
  // make.mjs: the hip's angle is 0.5 t, every 4 ms; the IMU's rate is 3 t, every 5 ms; the command is the number of its row, every 40 ms from
  // row 10 on, recorded 1 ms after that row's stamp.
  const log::Log log = read("mixed.mcap",
                            "torque_cmd_hip_nm = { column = \"/hip/command/data[0]\" }\n"
                            "angle_imu_rad = { column = \"/imu/angular_velocity/x\" }\n"
                            "contact_foot = { column = \"/state/foot/touches\" }\n");
  REQUIRE(
      log.rows() ==
      38);  // from row 11, the first one with a command, to row 48, the last one within the IMU's messages
  for (std::size_t i = 0; i < log.rows(); ++i) {
    const std::size_t row = i + 11;
    const double t = 0.004 * static_cast<double>(row);
    CHECK(log.at("angle_hip_rad")[i] == Approx(0.5 * t).margin(1e-15));
    CHECK(log.at("angle_imu_rad")[i] == Approx(3.0 * t).margin(1e-12));
    CHECK(log.at("torque_cmd_hip_nm")[i] == static_cast<double>(row - 1 - (row - 1) % 10));
    CHECK(log.at("contact_foot")[i] == (t >= 0.15 ? 1.0 : 0.0));
  }
  CHECK_THAT(notes_of(log),
             Contains("rows are the 50 messages of /joint_states (sensor_msgs/msg/JointState), time is "
                      "their header stamp."));
  CHECK_THAT(notes_of(log), Contains("/imu (40 messages) was interpolated at the rows' times."));
  CHECK_THAT(notes_of(log),
             Contains("/hip/command (4 messages) was held from one message to the next; its time is the "
                      "time of recording."));
  CHECK_THAT(notes_of(log), Contains("11 rows at the start and 1 at the end"));
}

TEST_CASE("a type of the robot's own is read by the definition in the file") {
  const log::Log log = read("mixed.mcap",
                            "topic = \"/drive\"\n"
                            "angle_a_rad = { column = \"/drive/ticks\", scale = -1 }\n"
                            "angle_b_rad = { column = \"/drive/phases[1]/amps\" }\n"
                            "angle_c_rad = { column = \"/drive/volts\" }\n"
                            "angle_d_rad = { column = \"/drive/count\" }\n"
                            "contact_a = { column = \"/drive/brakes[0]\" }\n");
  REQUIRE(log.rows() == 40);  // its own messages are the rows
  for (std::size_t i = 0; i < log.rows(); ++i) {
    CHECK(log.at("angle_a_rad")[i] == static_cast<double>(i));
    CHECK(log.at("angle_b_rad")[i] == -0.25);
    CHECK(log.at("angle_c_rad")[i] == 24.5);
    CHECK(log.at("angle_d_rad")[i] == 10.0 * static_cast<double>(i));
    CHECK(log.at("contact_a")[i] == (i >= 20 ? 1.0 : 0.0));
    CHECK(log.at("angle_hip_rad")[i] == Approx(0.0025 * static_cast<double>(i)).margin(1e-12));
  }
}

TEST_CASE("a database that stores definitions is read by them") {
  const log::Log log = read("defined.db3", "angle_a_rad = { column = \"/drive/ticks\", scale = -1 }\n");
  REQUIRE(log.rows() > 10);
  for (std::size_t i = 0; i < log.rows(); ++i)
    CHECK(log.at("angle_a_rad")[i] == Approx(log.time_s()[i] / 0.005).margin(1e-9));
}

TEST_CASE("numbers of JSON messages are named by their paths") {
  const log::Log log = read("no_joints.mcap", "angle_a_rad = { column = \"/state/foot/force[1]\" }\n");
  REQUIRE(log.rows() == 40);
  for (std::size_t i = 0; i < log.rows(); ++i) {
    CHECK(log.at("angle_a_rad")[i] == 2.0 * static_cast<double>(i));
    CHECK(log.time_s()[i] == Approx(0.005 * static_cast<double>(i)).margin(1e-12));
  }
}

TEST_CASE("an arm and its gripper that publish on one topic become one log") {
  const log::Log log = read("partial.mcap");
  // The finger's messages have the stamp of each other row, the last but one the last.
  REQUIRE(log.rows() == 39);
  for (std::size_t i = 0; i < log.rows(); ++i) {
    CHECK(log.at("angle_elbow_rad")[i] == Approx(0.02 * static_cast<double>(i)).margin(1e-15));
    CHECK(log.at("angle_finger_rad")[i] == Approx(static_cast<double>(i)));
  }
}

TEST_CASE("a map reads a joint that slides by the path of its position") {
  CHECK(read("mixed.mcap", "position_hip_m = { column = \"/joint_states/hip/position\" }\n")
            .at("position_hip_m") == read("mixed.mcap").at("angle_hip_rad"));
}

TEST_CASE("efforts that are no numbers make no column") {
  CHECK_FALSE(read("mixed.mcap").has("torque_hip_nm"));
  CHECK(read("mixed.mcap").has("velocity_hip_radps"));
}

TEST_CASE("of two robots one must be chosen") {
  CHECK_THAT(refused("two_robots.mcap"),
             Contains("2 topics of joint states: /left/joint_states (20 messages: elbow, shoulder), "
                      "/right/joint_states (20 messages: elbow, shoulder)") &&
                 Contains("furcula convert --topic /left/joint_states") &&
                 Contains("topic = \"/left/joint_states\" in a map"));
  CHECK(read("two_robots.mcap", "topic = \"/right/joint_states\"\n").rows() == 20);
  CHECK_THAT(refused("two_robots.mcap", "topic = \"/rihgt/joint_states\"\n"),
             Contains("no topic '/rihgt/joint_states' (did you mean '/right/joint_states'?)"));
}

TEST_CASE("commands in the form of joint states are not taken for the robot") {
  const log::Log log =
      read("commands.mcap", "angle_cmd_elbow_rad = { column = \"/joint_commands/elbow/position\" }\n");
  const std::vector<double>& measured = log.at("angle_elbow_rad");
  CHECK(measured == read("plain.mcap").at("angle_elbow_rad"));
  for (std::size_t i = 0; i < measured.size(); ++i)
    CHECK(log.at("angle_cmd_elbow_rad")[i] == measured[i] + 1.0);
  CHECK_THAT(notes_of(log), Contains("rows are the 20 messages of /joint_states"));
}

TEST_CASE("a bag without joint states is refused with its topics, types and paths") {
  CHECK_THAT(refused("no_joints.mcap"),
             Contains("no joint states") &&
                 Contains("/state (State, 40 messages): foot/force[0], foot/force[1]") &&
                 Contains("/imu (sensor_msgs/msg/Imu, 40 messages): orientation/x"));
}

TEST_CASE("a column that no topic has is refused with the one that was perhaps meant") {
  CHECK_THAT(refused("mixed.mcap", "angle_a_rad = { column = \"/imu/angular_velocity/w\" }\n"),
             Contains("no column '/imu/angular_velocity/w', which map.toml names") &&
                 Contains("did you mean '/imu/angular_velocity/"));
}

TEST_CASE("other encodings and compressions are refused by name") {
  CHECK_THAT(refused("protobuf.mcap"),
             Contains("/state (arm.State, 1 message): not read, its messages have the "
                      "encoding 'protobuf'; expected cdr or json"));
  CHECK_THAT(refused("unknown_compression.mcap"),
             Contains("a chunk has the compression 'xz'; expected none, zstd or lz4") &&
                 Contains("mcap compress --compression zstd"));
}

TEST_CASE("a clock that is set back is a gap where rows stand alone, and an error where topics are joined") {
  CHECK_THAT(notes_of(read("reset.mcap")), Contains("line 36: time steps back by 10.096 s"));
  CHECK_THAT(refused("reset.mcap", "angle_a_rad = { column = \"/imu/angular_velocity/x\" }\n"),
             Contains("the clock of '/joint_states' (header stamps) goes back by 10.1 s at its message 31") &&
                 Contains("expected one clock throughout"));
}

TEST_CASE("a directory without a bag, and a bag that lacks a file, are refused") {
  const test::TemporaryFolder folder;
  CHECK_THAT(
      test::error_message([&] { log::read_log(folder.path(), "tree"); }),
      Contains(
          "is a directory without a bag; expected a log (CSV), or a directory with .mcap or .db3 files"));
  folder.file("metadata.yaml",
              "rosbag2_bagfile_information:\n  relative_file_paths:\n    - gone_0.db3\n  duration:\n");
  const test::TemporaryFolder several;
  several.file("monday.mcap", "");
  several.file("tuesday.mcap", "");
  CHECK_THAT(
      test::error_message([&] { log::read_log(several.path(), "tree"); }),
      Contains("has files of several recordings and no metadata.yaml, as monday.mcap and tuesday.mcap"));
  CHECK_THAT(test::error_message([&] { log::read_log(folder.path(), "tree"); }),
             Contains("metadata.yaml: lists 'gone_0.db3', which is not there"));
}

TEST_CASE("furcula convert writes a bag as a log, which reads back the same") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path() + "/run.csv";
  const test::Ran ran = test::run_furcula({"convert", data("arm.mcap"), "--out", out});
  INFO(ran.err);
  REQUIRE(ran.status == 0);
  CHECK_THAT(ran.out, Contains("run.csv: 80 rows, 0.316 s, columns /effort_controller/commands/data[0]") &&
                          Contains("angle_elbow_rad"));
  const log::Log written = log::read_log(out, "tree");
  CHECK(written.at("angle_elbow_rad") == log::read_log(data("arm.csv"), "tree").at("angle_elbow_rad"));
  CHECK(log::rig_line(out) == "tree");
  const test::Ran check = test::run_furcula({"check", data("arm.mcap"), data("bag"), out});
  CHECK(check.status == 0);
  CHECK_THAT(check.out,
             Contains("arm.mcap: 80 rows") && Contains("bag: 20 rows") && Contains("run.csv: 80 rows"));
}

TEST_CASE("furcula convert says what it cannot read, with status 3") {
  const test::TemporaryFolder folder;
  const std::string out = folder.path() + "/run.csv";
  const test::Ran two = test::run_furcula({"convert", data("two_robots.mcap"), "--out", out});
  CHECK(two.status == 3);
  CHECK_THAT(two.err, Contains("2 topics of joint states"));
  CHECK(test::run_furcula({"convert", data("two_robots.mcap"), "--topic", "/left/joint_states", "--out", out})
            .status == 0);
  const test::Ran no_joints = test::run_furcula({"convert", data("no_joints.mcap"), "--out", out});
  CHECK(no_joints.status == 3);
  CHECK_THAT(no_joints.err,
             Contains("no joint states") && Contains("/state (State, 40 messages): foot/force[0]"));
  CHECK(test::run_furcula({"convert", data("arm.mcap"), "--out", data("arm.mcap")}).status == 2);
  const test::Ran none = test::run_furcula({"convert", folder.path() + "/none.mcap", "--out", out});
  CHECK(none.status == 3);
  CHECK_THAT(none.err, Contains("none.mcap: cannot be read: No such file or directory"));
}
