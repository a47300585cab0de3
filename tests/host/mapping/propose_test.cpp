// Proposed maps of logs that were renamed and rescaled: under the map the log is what it was.
#include "host/mapping/propose.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <sstream>

#include "host/core/error.hpp"
#include "host/log/reader.hpp"
#include "host/trees/simulate.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using Catch::Matchers::Contains;

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
