// Maps of the rig tree: a log of three joints read through one, and its recording.
#include <cmath>
#include <sstream>

#include "host/core/error.hpp"
#include "host/log/column_map.hpp"
#include "host/log/reader.hpp"
#include "host/trees/recording.hpp"
#include "tests/fuzz/message.hpp"
#include "tests/fuzz/target.hpp"
#include "tests/paths.hpp"

namespace furcula::fuzz {
namespace {

std::string log_of_three_joints() {
  std::ostringstream out;
  out << "t,q1,q2,q3,u1,u2,u3,v1\n";
  for (int i = 0; i < 60; ++i) {
    const double t = 0.01 * i;
    out << t << ',' << std::sin(5.0 * t) << ',' << std::cos(4.0 * t) << ',' << 0.05 * std::sin(3.0 * t) << ','
        << std::cos(7.0 * t) << ',' << t << ',' << 1.0 - t << ',' << 5.0 * std::cos(5.0 * t) << '\n';
  }
  return out.str();
}

}  // namespace

bool accepts(std::string_view input) {
  static const std::string log_text = log_of_three_joints();
  static const trees::TreeModel model = trees::parse_tree_model(
      "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"branched.urdf\"\n"
      "joints = [\"left_shoulder\", \"left_elbow\", \"left_reach\"]\n",
      test::source("tests/host/model/robots/robot.toml"));
  log::ColumnMap map;
  try {
    map = log::parse_column_map(input, "input");
    if (map.rig.empty()) map.rig = "tree";
    if (map.rig != "tree") return true;
  } catch (const core::DataError& e) {
    require_printable(e);
    return false;
  }
  try {
    const log::Log log = log::parse_log(log_text, "log", map.rig, &map);
    trees::foreign_joints(model, log);
    const trees::Recording recording = trees::recording_of(model, log);
    require(recording.rows() == 60 && recording.angle_rad.size() == model.joints() &&
                recording.input.size() == model.joints(),
            "a recording has each joint's columns");
  } catch (const core::DataError& e) {
    require_printable(e);
  }
  return true;
}

}  // namespace furcula::fuzz
