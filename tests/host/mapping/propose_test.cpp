// Proposed maps of logs that were renamed and rescaled: under the map the log is what it was.
#include "host/mapping/propose.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <numbers>
#include <sstream>

#include "host/core/error.hpp"
#include "host/log/reader.hpp"
#include "host/mapping/velocities.hpp"
#include "host/trees/conventions.hpp"
#include "host/trees/simulate.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0, kTurn = 2.0 * std::numbers::pi;

/// theirs = (ours - offset) / scale
struct Column {
  std::string ours, theirs;
  double scale = 1.0, offset = 0.0;
  bool whole = false;
};
struct Style {
  std::string what;
  std::vector<Column> columns;
  double tolerance = 1e-6;
  std::string says{};  ///< in the file
  char separator = ',', decimal = '.';
};

/// Two joints, shoulder and elbow, without noise; dry friction that the model lacks at the elbow.
const log::Log& recording() {
  static const log::Log log = [] {
    trees::TreeModel truth = test::double_pendulum();
    truth.causes = {{trees::Effect::coulomb_friction, {test::joint(truth, "elbow")}, {0.3, 0, 0, 0}}};
    trees::Scenario s = trees::default_scenario(truth);
    s.duration_s = 8.0;
    return trees::simulate(truth, s, 3);
  }();
  return log;
}

std::string csv(const Style& style) {
  std::ostringstream out;
  out.precision(12);
  for (std::size_t c = 0; c < style.columns.size(); ++c)
    out << (c == 0 ? "" : std::string(1, style.separator)) << style.columns[c].theirs;
  out << "\n";
  const log::Log& log = recording();
  for (std::size_t row = 0; row < log.rows(); ++row) {
    for (std::size_t c = 0; c < style.columns.size(); ++c) {
      const Column& column = style.columns[c];
      double value = column.ours.empty() ? 24.0 : (log.at(column.ours)[row] - column.offset) / column.scale;
      if (column.whole) value = std::round(value);
      std::ostringstream number;
      number.precision(12);
      number << value;
      std::string text = number.str();
      for (char& sign : text)
        if (sign == '.') sign = style.decimal;
      out << (c == 0 ? "" : std::string(1, style.separator)) << text;
    }
    out << "\n";
  }
  return out.str();
}

mapping::Proposal propose(const std::string& path) {
  const std::string urdf = test::source("tests/host/model/robots/robot.toml");
  return mapping::propose(path, [&](const std::vector<std::string>& columns) {
    return trees::parse_tree_model("[model]\nkind = \"tree\"\nschema = 1\nurdf = \"double_pendulum.urdf\"\n",
                                   urdf, {{}, columns});
  });
}

const std::string kTime = "time_s", kShoulder = "angle_shoulder_rad", kElbow = "angle_elbow_rad",
                  kTorque1 = "torque_shoulder_nm", kTorque2 = "torque_elbow_nm";

}  // namespace

TEST_CASE("under its proposed map a renamed log is what it was") {
  const std::vector<Style> styles{
      {"joint names first",
       {{kTime, "t"},
        {kShoulder, "shoulder_pos"},
        {kElbow, "elbow_pos"},
        {kTorque1, "shoulder_tau"},
        {kTorque2, "elbow_tau"}}},
      {"brackets",
       {{kTime, "time"},
        {kShoulder, "position[shoulder]"},
        {kElbow, "position[elbow]"},
        {kTorque1, "effort[shoulder]"},
        {kTorque2, "effort[elbow]"}}},
      {"topics and nanoseconds",
       {{kTime, "/joint_states/header/stamp_ns", 1e-9},
        {kElbow, "/joint_states/elbow/position"},
        {kShoulder, "/joint_states/shoulder/position"},
        {kTorque2, "/joint_states/elbow/effort"},
        {kTorque1, "/joint_states/shoulder/effort"}}},
      {"numbers from 1",
       {{kTime, "t"}, {kShoulder, "q1"}, {kElbow, "q2"}, {kTorque1, "tau_1"}, {kTorque2, "tau_2"}},
       1e-6,
       "CONFIRM: joint 'shoulder' by number"},
      {"numbers from 0, in milliseconds",
       {{kTime, "time_ms", 1e-3},
        {kShoulder, "joint0_pos"},
        {kElbow, "joint1_pos"},
        {kTorque1, "joint0_trq"},
        {kTorque2, "joint1_trq"}}},
      {"units in brackets",
       {{kTime, "Time [s]"},
        {kShoulder, "Shoulder angle [deg]", kDegree},
        {kElbow, "Elbow angle [deg]", kDegree},
        {kTorque1, "Shoulder torque (mNm)", 1e-3},
        {kTorque2, "Elbow torque (mNm)", 1e-3}}},
      {"degrees that nothing says",
       {{kTime, "t"},
        {kShoulder, "shoulder_q", kDegree},
        {kElbow, "elbow_q", kDegree},
        {kTorque1, "shoulder_tau"},
        {kTorque2, "elbow_tau"}}},
      {"moteus",
       {{kTime, "timestamp"},
        {kShoulder, "servo_stats.1.position", kTurn},
        {kElbow, "servo_stats.2.position", kTurn},
        {kTorque1, "servo_stats.1.torque"},
        {kTorque2, "servo_stats.2.torque"},
        {"", "servo_stats.1.temperature"}},
       1e-6,
       "servo_stats.1.temperature"},
      {"ODrive",
       {{kTime, "t"},
        {kShoulder, "axis0.encoder.pos_estimate", kTurn},
        {kElbow, "axis1.encoder.pos_estimate", kTurn},
        {kTorque1, "axis0.motor.torque_estimate"},
        {kTorque2, "axis1.motor.torque_estimate"}}},
      {"turns that nothing says",
       {{kTime, "t"},
        {kShoulder, "shoulder_pos", kTurn},
        {kElbow, "elbow_pos", kTurn},
        {kTorque1, "shoulder_tau"},
        {kTorque2, "elbow_tau"}}},
      {"a sign, an order of its own and commas",
       {{kTorque2, "elbow_tau"},
        {kElbow, "elbow_pos"},
        {kTime, "t"},
        {kTorque1, "shoulder_tau", -1.0},
        {kShoulder, "shoulder_pos", -1.0}},
       1e-6,
       "other sign",
       ';',
       ','},
      {"a zero a quarter turn away",
       {{kTime, "t"},
        {kShoulder, "shoulder_pos"},
        {kElbow, "elbow_pos", 1.0, 0.5 * std::numbers::pi},
        {kTorque1, "shoulder_tau"},
        {kTorque2, "elbow_tau"}},
       1e-6,
       "a quarter turn"},
      {"counts of 14 bits",
       {{kTime, "t"},
        {kShoulder, "shoulder_counts", kTurn / 16384.0, 0.0, true},
        {kElbow, "elbow_counts", kTurn / 16384.0, 0.0, true},
        {kTorque1, "shoulder_tau"},
        {kTorque2, "elbow_tau"}},
       4e-4,
       "16384 a turn"},
      {"abbreviations",
       {{kTime, "t"},
        {kShoulder, "sh_pos"},
        {kElbow, "elb_pos"},
        {kTorque1, "sh_tau"},
        {kTorque2, "elb_tau"}}},
  };
  test::TemporaryFolder folder;
  for (const Style& style : styles) {
    const std::string path = folder.file("log.csv", csv(style));
    const mapping::Proposal proposal = propose(path);
    const std::string text = mapping::map_text(proposal);
    INFO(style.what << "\n" << text);
    CHECK_THAT(text, Contains(style.says));
    const log::ColumnMap map = log::parse_column_map(text, "map.toml");
    CHECK(proposal.expected.empty());
    const log::Log back = log::read_log(path, "tree", &map);
    REQUIRE(back.rows() == recording().rows());
    for (const Column& c : style.columns) {
      if (c.ours.empty()) continue;
      INFO(c.ours);
      REQUIRE(back.has(c.ours));
      double off = 0.0;
      for (std::size_t row = 0; row < back.rows(); ++row)
        off = std::max(off, std::abs(back.at(c.ours)[row] - recording().at(c.ours)[row]));
      CHECK(off < style.tolerance);
    }
  }
}

TEST_CASE("where columns cannot be told the message has them and what was expected") {
  test::TemporaryFolder folder;
  CHECK_THROWS_WITH(propose(folder.file("a.csv", "x,y\n0,1\n1,2\n")),
                    Contains("no column is time") && Contains("'x', 'y'"));
  CHECK_THROWS_WITH(propose(folder.file("b.csv", "t,foo,bar\n0,1,2\n0.001,2,3\n0.002,3,4\n")),
                    Contains("'t', 'foo', 'bar'") && Contains("'angle_shoulder_rad', 'angle_elbow_rad'"));
  const mapping::Proposal some =
      propose(folder.file("c.csv", "t,shoulder_pos,bar\n0,1,2\n0.001,2,3\n0.002,3,4\n0.003,3,4\n"));
  CHECK(some.left == std::vector<std::string>{"bar"});
  CHECK_THAT(some.expected, Catch::VectorContains(std::string("angle_elbow_rad")));
}

namespace {

trees::TreeModel arm_model(const std::vector<std::string>& columns = {}) {
  return trees::parse_tree_model("[model]\nkind = \"tree\"\nschema = 1\nurdf = \"arm3.urdf\"\n",
                                 test::source("tests/host/trees/robots/arm.toml"), {{}, columns});
}

/// A log of the arm whose columns are so many times what they are; and further columns.
struct Distorted {
  std::map<std::string, double> times;
  bool velocities = false;
};
/// What the proposed map makes of the columns, as shares of what they are; and its text.
struct Mended {
  std::map<std::string, double> share;
  std::string text;
};
Mended mended(const Distorted& of) {
  static const log::Log recorded = [] {
    const trees::TreeModel arm = arm_model();
    return trees::simulate(arm, trees::default_scenario(arm), 5);
  }();
  const std::vector<std::string> joints{"yaw", "shoulder", "elbow"};
  const std::vector<double>& time = recorded.time_s();
  std::map<std::string, std::vector<double>> columns;  // ours
  std::map<std::string, std::string> theirs;
  for (const std::string& j : joints) {
    const std::vector<double>& q = columns["angle_" + j + "_rad"] = recorded.at("angle_" + j + "_rad");
    columns["torque_" + j + "_nm"] = recorded.at("torque_" + j + "_nm");
    theirs["angle_" + j + "_rad"] = j + "_pos", theirs["torque_" + j + "_nm"] = j + "_tau";
    if (!of.velocities) continue;
    std::vector<double>& v = columns["velocity_" + j + "_radps"];
    v.assign(q.size(), 0.0);
    for (std::size_t i = 1; i + 1 < q.size(); ++i) v[i] = (q[i + 1] - q[i - 1]) / (time[i + 1] - time[i - 1]);
    theirs["velocity_" + j + "_radps"] = j + "_vel";
  }
  std::ostringstream out;
  out.precision(12);
  out << "t";
  for (const auto& [ours, values] : columns) out << "," << theirs[ours];
  for (std::size_t i = 0; i < time.size(); ++i) {
    out << "\n" << time[i];
    for (const auto& [ours, values] : columns)
      out << "," << values[i] * (of.times.contains(ours) ? of.times.at(ours) : 1.0);
  }
  test::TemporaryFolder folder;
  const std::string path = folder.file("log.csv", out.str() + "\n");
  const mapping::Proposal p = mapping::propose(path, arm_model);
  Mended m{{}, mapping::map_text(p)};
  for (const mapping::Line& line : p.lines)
    if (columns.contains(line.ours))
      m.share[line.ours] =
          line.column.parts[0].scale * (of.times.contains(line.ours) ? of.times.at(line.ours) : 1.0);
  return m;
}

}  // namespace

TEST_CASE("several wrong signs are found together, and unequal units and gears") {
  const std::string yaw = "angle_yaw_rad", shoulder = "angle_shoulder_rad", elbow = "angle_elbow_rad",
                    tau1 = "torque_yaw_nm", tau2 = "torque_shoulder_nm", tau3 = "torque_elbow_nm";
  const std::vector<std::map<std::string, double>> all{
      {{elbow, -1.0}, {tau3, -1.0}, {tau1, -1.0}},
      {{shoulder, -1.0}, {tau2, -1.0}, {tau1, -1.0}},
      {{elbow, -1.0}, {shoulder, -1.0}, {tau2, -1.0}, {tau3, -1.0}},
      {{elbow, 1.0 / kDegree}, {tau2, -1.0}},
      {{elbow, -1.0 / kDegree}, {yaw, 1.0 / kDegree}, {shoulder, -1.0}, {tau3, 1e3}},
      {{tau2, 1.0 / 50.0}, {tau3, -1.0 / 9.0}, {elbow, -1.0}}};
  for (const auto& times : all) {
    const Mended m = mended({times});
    INFO(m.text);
    // The yaw's axis is upright: its position and torque may have the other sign together, and the map says so.
    const double sign = m.share.at(yaw) < 0.0 ? -1.0 : 1.0;
    if (sign < 0.0)
      CHECK_THAT(m.text, Contains("does not show the signs of 'angle_yaw_rad', 'torque_yaw_nm'"));
    for (const auto& [ours, share] : m.share) {
      INFO(ours);
      const bool of_yaw = ours == yaw || ours == tau1;
      CHECK(share * (of_yaw ? sign : 1.0) == Approx(1.0).epsilon(0.05));
    }
  }
}

TEST_CASE("what the motion does not show is to be confirmed, not said to be found") {
  const Mended m = mended({{{"angle_yaw_rad", -1.0}, {"torque_shoulder_nm", -1.0}}});
  INFO(m.text);
  CHECK_THAT(m.text, Contains("The motion does not show the signs of 'angle_yaw_rad', 'torque_yaw_nm'"));
  const std::size_t at = m.text.find("torque_yaw_nm = ");
  REQUIRE(at != std::string::npos);
  const std::size_t comment = m.text.rfind("# CONFIRM", at);
  CHECK(m.text.substr(comment, at - comment).find("\n\n") == std::string::npos);
}

TEST_CASE("positions and velocities are put into units in which one is the slope of the other") {
  // Small angles in degrees, which no range tells, beside rad/s.
  std::vector<double> time, position, velocity_of;
  for (int i = 0; i < 2000; ++i) {
    const double t = 4e-3 * i;
    time.push_back(t), position.push_back(0.1 * std::sin(3.0 * t) / kDegree);
    velocity_of.push_back(0.3 * std::cos(3.0 * t));
  }
  const auto factor = mapping::velocity_factor(time, position, velocity_of);
  REQUIRE(factor);
  CHECK(factor->factor == kDegree);
  CHECK(factor->what == "degrees beside rad/s");
  for (double& v : velocity_of) v /= -7.0 * kDegree;
  CHECK(mapping::velocity_factor(time, position, velocity_of)->factor == Approx(-1.0 / 7.0).epsilon(0.01));
  for (double& v : velocity_of) v *= -7.0;
  CHECK_FALSE(mapping::velocity_factor(time, position, velocity_of));
  // Another motion says nothing.
  for (std::size_t i = 0; i < time.size(); ++i) velocity_of[i] = std::sin(17.0 * time[i]);
  CHECK_FALSE(mapping::velocity_factor(time, position, velocity_of));

  // Degrees a second beside rad, and the other sign.
  const Mended velocity =
      mended({{{"velocity_shoulder_radps", 1.0 / kDegree}, {"velocity_yaw_radps", -1.0}}, true});
  INFO(velocity.text);
  for (const auto& [ours, share] : velocity.share) CHECK(share == Approx(1.0).epsilon(0.02));
  CHECK_THAT(velocity.text, Contains("rad beside degrees/s") && Contains("the other sign"));
}

TEST_CASE("rostopic's columns are those of the joints that it names") {
  std::ostringstream out;
  out.precision(12);
  out << "%time,field.header.stamp,field.name0,field.name1,field.position0,field.position1,field.effort0,"
         "field.effort1\n";
  const log::Log& log = recording();
  for (std::size_t i = 0; i < log.rows(); ++i) {
    const auto ns = 1700000000000000000LL + std::llround(1e9 * log.time_s()[i]);
    out << ns << "," << ns << ",elbow,shoulder," << log.at(kElbow)[i] << "," << log.at(kShoulder)[i] << ","
        << log.at(kTorque2)[i] << "," << log.at(kTorque1)[i] << "\n";
  }
  test::TemporaryFolder folder;
  const std::string path = folder.file("joint_states.csv", out.str());
  const mapping::Proposal p = propose(path);
  const std::string text = mapping::map_text(p);
  INFO(text);
  CHECK_THAT(text, Contains("angle_elbow_rad = { column = \"field.position0\" }") &&
                       Contains("torque_shoulder_nm = { column = \"field.effort1\" }") &&
                       Contains("time_s = { column = \"%time\", scale = 1e-09 }"));
  const log::ColumnMap map = log::parse_column_map(text, "map.toml");
  const log::Log back = log::read_log(path, "tree", &map);
  CHECK(back.rows() == log.rows());
  CHECK(back.time_s().back() == Approx(log.time_s().back()).epsilon(1e-6));
}

TEST_CASE("a diagnosis under a map says what to write over the log's own columns") {
  const trees::TreeModel model = test::double_pendulum();
  log::Log log = recording();
  for (double& q : log.columns[kElbow]) q = -q;
  log.mapped[kElbow] = {{{"elbow_pos", 2.0}}, 0.25, 3};
  const std::vector<trees::Recording> recordings{trees::recording_of(model, log)};
  CHECK_THROWS_WITH(trees::require_conventions(model, recordings, 0.3),
                    Contains("angle_elbow_rad = { column = \"elbow_pos\", scale = -2, offset = -0.25 }"));
}
