// Logs of named joints: columns, map files, what is written; and what the fits make of them.
#include "host/trees/recording.hpp"

#include <cmath>

#include "host/log/column_map.hpp"
#include "host/log/reader.hpp"
#include "host/log/writer.hpp"
#include "host/trees/conventions.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

std::string refused_log(const std::string& text) {
  return test::error_message([&] { log::parse_log(text, "a.csv", "tree"); });
}

/// 100 rows of the double pendulum at 10 ms: shoulder and elbow on sines.
log::Log pendulum_log() {
  log::Log out;
  out.path = "swing.csv";
  out.rig = "tree";
  for (int k = 0; k < 100; ++k) {
    const double t = 0.01 * k;
    out.columns["time_s"].push_back(t);
    out.columns["angle_shoulder_rad"].push_back(0.5 * std::sin(3.0 * t));
    out.columns["angle_elbow_rad"].push_back(0.3 * std::cos(5.0 * t));
    out.columns["torque_shoulder_nm"].push_back(1.0 + t);
    out.columns["torque_elbow_nm"].push_back(2.0 - t);
  }
  return out;
}
std::string refused(const log::Log& log, const std::string& settings = "") {
  return test::error_message([&] { trees::recording_of(test::double_pendulum(settings), log); });
}

}  // namespace

TEST_CASE("A tree's log has columns by the joints' names, and keeps others") {
  const log::Log log = log::parse_log(
      "# machine_type: tree\ntime_s,angle_knee_rad,torque_cmd_knee_nm,torque_knee_nm,position_lift_m,force_lift_n,temp,current_knee_a\n"
      "0,0.1,1,2,0.3,4,30,0.5\n0.01,0.2,1,2,0.3,4,31,0.5\n",
      "a.csv", "tree");
  CHECK(log.rig == "tree");
  CHECK(log.at("angle_knee_rad") == std::vector<double>{0.1, 0.2});
  CHECK(log.at("torque_cmd_knee_nm") == std::vector<double>{1.0, 1.0});
  CHECK(log.at("force_lift_n") == std::vector<double>{4.0, 4.0});
  CHECK(log.at("temp") == std::vector<double>{30.0, 31.0});
}

TEST_CASE("A tree's columns in other units are refused, with the name that was meant") {
  CHECK_THAT(refused_log("time_s,angle_knee_deg\n0,1\n"),
             Contains("a.csv:1: column 'angle_knee_deg' has the unit 'deg'; expected 'angle_knee_rad'") &&
                 Contains("--map"));
  CHECK_THAT(refused_log("time_s,torque_cmd_knee_mnm\n0,1\n"), Contains("expected 'torque_cmd_knee_nm'"));
  CHECK_THAT(refused_log("time_s,angle_cmd_knee_deg\n0,1\n"), Contains("expected 'angle_cmd_knee_rad'"));
  CHECK_THAT(refused_log("time_s,position_lift_mm\n0,1\n"), Contains("expected 'position_lift_m'"));
  CHECK_THAT(refused_log("time_ms,angle_knee_rad\n0,1\n"),
             Contains("'time_ms'") && Contains("expected 'time_s'"));
  // Both are there: the other one is the rig's own business.
  CHECK(refused_log("time_s,angle_knee_deg,angle_knee_rad\n0,1,1\n").empty());
}

TEST_CASE("Torn and foreign tree logs are refused with file and line") {
  CHECK_THAT(refused_log(""), Contains("a.csv:1: the file is empty"));
  CHECK_THAT(refused_log("time_s,angle_knee_rad\n"), Contains("a.csv"));
  CHECK_THAT(refused_log("angle_knee_rad\n0\n"), Contains("no column 'time_s'"));
  CHECK_THAT(refused_log("time_s,angle_knee_rad\n0,1\n0.1\n"), Contains("a.csv:3"));
  CHECK_THAT(refused_log("time_s,angle_knee_rad\n0,1\nnan,1\n"), Contains("a.csv:3") && Contains("'time_s'"));
  // Whether a joint's column is asked for, its model says.
  for (const char* bad : {"nan", "inf", "", "off"}) {
    const log::Log log =
        log::parse_log("time_s,angle_knee_rad\n0," + std::string(bad) + "\n", "a.csv", "tree");
    CHECK_THAT(log.unusable.at("angle_knee_rad"),
               Contains("no finite number in 1 of 1 rows, the first in line 2"));
  }
  CHECK_THAT(refused_log("time_s,angle_knee_rad\n0,1\n0,1\n"), Contains("a.csv:3"));
  CHECK_THAT(refused_log("# machine_type: hopper\ntime_s,angle_knee_rad\n0,1\n"),
             Contains("machine_type is 'hopper'; expected tree"));
  CHECK_THAT(refused_log("time_s,angle_knee_rad,angle_knee_rad\n0,1,1\n"), Contains("stands twice"));
}

TEST_CASE("A map file makes a tree's columns of foreign ones") {
  const log::ColumnMap map = log::parse_column_map(
      "machine_type = \"tree\"\ntime_s = { column = \"t\" }\nangle_knee_rad = { column = \"knee_deg\", scale = 0.0174532925199433 }\n"
      "torque_knee_nm = { column = \"tau\" }\n",
      "map.toml");
  const log::Log log = log::parse_log("t,knee_deg,tau\n0,180,1\n0.1,90,2\n", "a.csv", "tree", &map);
  CHECK(log.at("angle_knee_rad")[0] == Approx(M_PI));
  CHECK(log.at("angle_knee_rad")[1] == Approx(M_PI_2));
  CHECK(log.at("torque_knee_nm") == std::vector<double>{1.0, 2.0});
  CHECK_THAT(test::error_message([] {
               log::parse_column_map("machine_type = \"tree\"\nangel_knee_rad = { column = \"q\" }\n",
                                     "map.toml");
             }),
             Contains("map.toml:2: unknown key 'angel_knee_rad'"));
}

TEST_CASE("A tree's log is written with all its columns and reads back the same") {
  log::Log log = pendulum_log();
  log.metadata["robot"] = "double_pendulum";
  log.columns["velocity_elbow_radps"].assign(100, 0.1);
  log.columns["angle_cmd_elbow_rad"].assign(100, -1e-17);
  const log::Log back = log::parse_log(log::format_log(log), "back.csv", "tree");
  CHECK(back.columns == log.columns);
  CHECK(back.metadata.at("robot") == "double_pendulum");
}

TEST_CASE("A recording has each joint's angle and what its drive was given") {
  const trees::TreeModel m = test::double_pendulum();
  log::Log log = pendulum_log();
  const trees::Recording r = trees::recording_of(m, log);
  const std::size_t elbow = test::joint(m, "elbow");
  CHECK(r.rows() == 100);
  CHECK(r.interval_s == Approx(0.01));
  CHECK(r.angle_rad[elbow] == log.at("angle_elbow_rad"));
  CHECK(r.input[elbow] == log.at("torque_elbow_nm"));
  CHECK(r.input_measured[elbow]);
  // Without the drive's report its command serves.
  log.columns["torque_cmd_elbow_nm"].assign(100, 7.0);
  CHECK(trees::recording_of(m, log).input[elbow] == log.at("torque_elbow_nm"));
  log.columns.erase("torque_elbow_nm");
  const trees::Recording commanded = trees::recording_of(m, log);
  CHECK(commanded.input[elbow] == std::vector<double>(100, 7.0));
  CHECK_FALSE(commanded.input_measured[elbow]);
  // Under the position law it is the set point.
  const trees::TreeModel led =
      test::double_pendulum("[drive.elbow]\ncontrol_mode = \"position\"\nkp_nmprad = 5.0\n");
  CHECK_THAT(test::error_message([&] { trees::recording_of(led, log); }),
             Contains("joint 'elbow' has no column 'angle_cmd_elbow_rad'"));
  log.columns["angle_cmd_elbow_rad"].assign(100, 0.4);
  CHECK(trees::recording_of(led, log).input[elbow] == std::vector<double>(100, 0.4));
}

TEST_CASE("A recording that lacks a joint or is too short is refused, and one in degrees is asked about") {
  log::Log log = pendulum_log();
  log.columns.erase("angle_elbow_rad");
  CHECK_THAT(refused(log), Contains("swing.csv: joint 'elbow' has no column 'angle_elbow_rad'") &&
                               Contains("joints = [...]"));
  log.unusable["angle_elbow_rad"] = "no finite number in 60 of 600 rows, the first in line 2";
  CHECK_THAT(
      refused(log),
      Contains(
          "has no column 'angle_elbow_rad' that can be used (angle_elbow_rad: no finite number in 60 of 600"));
  CHECK(refused(log, "joints = [\"shoulder\"]\n").empty());
  log = pendulum_log();
  log.columns.erase("torque_shoulder_nm");
  CHECK_THAT(refused(log),
             Contains("joint 'shoulder' has no column 'torque_shoulder_nm' or 'torque_cmd_shoulder_nm'"));

  log = pendulum_log();
  for (auto& [name, values] : log.columns) values.resize(49);
  CHECK_THAT(refused(log), Contains("swing.csv: 49 rows; expected at least 50"));
  log = pendulum_log();
  for (auto& [name, values] : log.columns) values.resize(50);
  CHECK(refused(log).empty());

  // The limits are 3 rad; 170 degrees fit in there, and 20 rad is only a continuous joint's.
  log = pendulum_log();
  for (double& a : log.columns["angle_shoulder_rad"]) a *= 170.0 / 0.5;
  CHECK(refused(log).empty());
  const auto notes = trees::recording_of(test::double_pendulum(), log).log_notes;
  REQUIRE(notes.size() == 1);
  CHECK_THAT(notes.front(), Contains("angle_shoulder_rad reaches") && Contains("is it in degrees?"));
}

TEST_CASE("A column of wrong sign is named as the log has it: a command where the drive reports no torque") {
  const trees::TreeModel m = test::double_pendulum();
  for (const bool measured : {true, false}) {
    std::vector<trees::Recording> recordings;
    for (log::Log& log : test::logs(m, 2, 4.0, 1)) {
      const std::string named = measured ? "torque_elbow_nm" : "torque_cmd_elbow_nm";
      std::vector<double> torque =
          log.columns.at(log.has("torque_elbow_nm") ? "torque_elbow_nm" : "torque_cmd_elbow_nm");
      for (double& t : torque) t = -t;
      log.columns.erase("torque_elbow_nm");
      log.columns[named] = torque;
      recordings.push_back(trees::recording_of(m, log));
    }
    CHECK_THAT(test::error_message([&] { trees::require_conventions(m, recordings, 0.3); }),
               Contains(std::string(measured ? "that torque_elbow_nm" : "that torque_cmd_elbow_nm") +
                        " has the other sign"));
  }
}

TEST_CASE("A load that is heavier than the link that carries it is no scale of the torques") {
  const trees::TreeModel plain = test::double_pendulum();
  const trees::TreeModel loaded =
      test::double_pendulum("[effect.payload.lower]\nmass_kg = 1.5\nx_m = 0.0\ny_m = 0.0\nz_m = -0.3\n");
  std::vector<trees::Recording> recordings;
  for (const log::Log& log : test::logs(loaded, 3, 4.0, 1))
    recordings.push_back(trees::recording_of(plain, log));
  CHECK(test::error_message([&] { trees::require_conventions(plain, recordings, 0.3); }).empty());
}

TEST_CASE("A joint's state about a row is that of a cubic") {
  const trees::TreeModel m = test::wheel();
  trees::Recording r = test::inputs(m, 1.0, 0.004, [](std::size_t, double) { return 0.0; });
  for (std::size_t k = 0; k < r.rows(); ++k) {
    const double t = r.time_s[k] - 0.4;
    r.angle_rad[0][k] = 0.3 + 1.5 * t - 4.0 * t * t + 2.0 * t * t * t;
  }
  const trees::LocalState s = trees::local_state(r, 0, 100, 0.02);
  CHECK(s.angle_rad == Approx(0.3).epsilon(1e-6));
  CHECK(s.velocity_radps == Approx(1.5).epsilon(1e-5));
  CHECK(s.acceleration_radps2 == Approx(-8.0).epsilon(1e-4));
  // At the first row all of the rows lie on one side.
  CHECK(trees::local_state(r, 0, 0, 0.02).angle_rad == Approx(0.3 - 0.6 - 0.64 - 0.128).epsilon(1e-4));
}

TEST_CASE("The noise of an encoder is that of its samples, or of its steps") {
  const trees::TreeModel m = test::wheel();
  log::Log log;
  log.rig = "tree";
  unsigned state = 1;
  const auto uniform = [&] {
    return static_cast<double>(state = state * 1664525u + 1013904223u) / 4294967296.0;
  };
  for (int k = 0; k < 5000; ++k) {
    log.columns["time_s"].push_back(0.002 * k);
    double normal = -6.0;
    for (int i = 0; i < 12; ++i) normal += uniform();
    log.columns["angle_wheel_rad"].push_back(std::sin(0.01 * k) + 3e-4 * normal);
    log.columns["torque_wheel_nm"].push_back(0.0);
  }
  CHECK(trees::recording_of(m, log).angle_noise_rad[0] == Approx(3e-4).epsilon(0.1));
  // Steps of 1e-3: their standard deviation is the twelfth's root.
  for (double& a : log.columns["angle_wheel_rad"]) a = 1e-3 * std::floor(a / 1e-3);
  CHECK(trees::recording_of(m, log).angle_noise_rad[0] >= 0.99e-3 / std::sqrt(12.0));
}

TEST_CASE("Joints of another robot are named, those that are held are not foreign") {
  log::Log log = pendulum_log();
  log.columns["angle_wrist_rad"].assign(100, 0.0);
  log.columns["temperature"].assign(100, 0.0);
  const trees::TreeModel m = test::double_pendulum("joints = [\"shoulder\"]\n");
  CHECK(trees::foreign_joints(m, log) == std::vector<std::string>{"wrist"});
}

TEST_CASE("A joint whose name begins like a quantity's end is not foreign") {
  trees::TreeModel m = test::pendulum();
  m.urdf.joints[0].name = m.robot.joints[0].name = "cmd_y";
  log::Log log;
  for (const char* column : {"time_s", "angle_cmd_y_rad", "torque_cmd_y_nm"})
    log.columns[column].assign(50, 0.0);
  CHECK(trees::foreign_joints(m, log).empty());
}
