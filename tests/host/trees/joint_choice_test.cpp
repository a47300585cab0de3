// Which joints move where a model file does not say so, and what a log calls them.
#include "host/trees/joint_choice.hpp"

#include <catch2/catch.hpp>

#include "host/trees/model.hpp"
#include "host/trees/recording.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using Catch::Matchers::Contains;
using trees::JointChoice;

namespace {

/// A chain of joints of these names; "name>leader" mimics, "name|" slides, "name?" floats.
std::string chain(const std::vector<std::string>& names) {
  std::string out = "<robot name=\"chain\"><link name=\"l0\"/>";
  for (std::size_t i = 0; i < names.size(); ++i) {
    std::string name = names[i], leader, type = "continuous";
    if (const auto at = name.find('>'); at != name.npos) {
      leader = name.substr(at + 1);
      name.resize(at);
    }
    if (name.ends_with('|')) type = "prismatic";
    if (name.ends_with('?')) type = "floating";
    if (type != "continuous") name.pop_back();
    const std::string parent = "l" + std::to_string(i), link = "l" + std::to_string(i + 1);
    out +=
        "<link name=\"" + link +
        "\"><inertial><origin xyz=\"0 0 -0.1\"/><mass value=\"1\"/><inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" "
        "izz=\"0.01\"/></inertial></link><joint name=\"" +
        name + "\" type=\"" + type + "\"><parent link=\"" + parent + "\"/><child link=\"" + link +
        "\"/><origin xyz=\"0 0 -0.2\"/><axis xyz=\"0 1 0\"/>" +
        (leader.empty() ? "" : "<mimic joint=\"" + leader + "\"/>") + "</joint>\n";
  }
  return out + "</robot>";
}
std::vector<std::string> angles(const std::vector<std::string>& names) {
  std::vector<std::string> out{"time_s"};
  for (const std::string& name : names) {
    out.push_back("angle_" + name + "_rad");
    out.push_back("torque_" + name + "_nm");
  }
  return out;
}
JointChoice choose(const std::vector<std::string>& joints, const std::vector<std::string>& columns,
                   const std::vector<std::string>& wanted = {}) {
  return trees::choose_joints(model::parse_urdf(chain(joints), "c.urdf"), wanted, {}, columns);
}
std::map<std::string, std::string> logged(const std::vector<std::string>& joints,
                                          const std::vector<std::string>& names) {
  return choose(joints, angles(names)).logged;
}
using Names = std::map<std::string, std::string>;

trees::TreeModel model_of(const std::vector<std::string>& joints, const trees::TreeContext& with,
                          const std::string& more = "") {
  trees::TreeContext context = with;
  context.urdf = chain(joints);
  return trees::parse_tree_model("[model]\nkind = \"tree\"\nschema = 1\nurdf = \"c.urdf\"\n" + more, "c.toml",
                                 context);
}

}  // namespace

TEST_CASE("Without joints in the model file those move that the recordings have columns of") {
  const JointChoice c =
      choose({"a", "b", "c", "d|"}, {"time_s", "angle_a_rad", "angle_c_rad", "position_d_m"});
  CHECK(c.moving == std::vector<std::string>{"a", "c", "d"});
  REQUIRE(c.notes.size() == 1);
  CHECK_THAT(c.notes[0], Contains("'a', 'c', 'd'. Held at 0: 'b'") &&
                             Contains("write joints = [\"a\", \"c\", \"d\"] in [model]"));
  // Of all, or of none: all that can, and no word about it.
  for (const auto& columns : {angles({"a", "b"}), std::vector<std::string>{}}) {
    const JointChoice all = choose({"a", "b"}, columns);
    CHECK(all.moving.empty());
    CHECK(all.notes.empty());
  }
  // A set point is no angle.
  CHECK(choose({"a", "b"}, {"angle_a_rad", "angle_cmd_b_rad"}).moving == std::vector<std::string>{"a"});
}

TEST_CASE(
    "Joints that mimic, those that are mimicked, and floating ones do not move unless the file says so") {
  const JointChoice c = choose({"a", "f", "g>f", "h?"}, angles({"a", "f", "g"}));
  CHECK(c.moving == std::vector<std::string>{"a"});
  REQUIRE(c.notes.size() == 1);
  CHECK_THAT(c.notes[0], Contains("since one mimics another: 'f', 'g'"));
  const trees::TreeModel m = model_of({"a", "f", "g>f", "h?"}, {{}, angles({"a"}), false});
  REQUIRE(m.joints() == 1);
  // What is written names them, so that it reads back without the recordings.
  CHECK(trees::parse_tree_model(trees::format_tree_model(m, "c.urdf"), "c.toml", m.urdf_text).joints() == 1);
}

TEST_CASE("More joints than a tree has room for are read where the recordings have columns of fewer") {
  std::vector<std::string> many, some;
  for (int i = 0; i < 60; ++i) many.push_back("joint_" + std::to_string(i));
  for (int i = 0; i < 36; ++i) some.push_back(many[static_cast<std::size_t>(i)]);
  CHECK(model_of(many, {{}, angles(some), false}).joints() == 36);
  CHECK_THAT(test::error_message([&] { model_of(many, {}); }),
             Contains("60 joints that move, expected at most 48") && Contains("joints = [...]"));
}

TEST_CASE("A log's names are taken for the URDF's where one alone fits") {
  CHECK(logged({"shoulder", "elbow"}, {"Shoulder", "ELBOW"}) ==
        Names{{"shoulder", "Shoulder"}, {"elbow", "ELBOW"}});
  CHECK(logged({"l_hip", "r_hip"}, {"left_hip", "right_hip"}) ==
        Names{{"l_hip", "left_hip"}, {"r_hip", "right_hip"}});
  CHECK(logged({"LHipPitch"}, {"left-hip pitch"}) == Names{{"LHipPitch", "left-hip pitch"}});
  CHECK(logged({"FL_knee", "RL_knee"}, {"knee_front_left", "knee_hind_left"}) ==
        Names{{"FL_knee", "knee_front_left"}, {"RL_knee", "knee_hind_left"}});
  CHECK(logged({"shoulder", "elbow"}, {"robot/shoulder_joint", "robot/elbow_joint"}) ==
        Names{{"shoulder", "robot/shoulder_joint"}, {"elbow", "robot/elbow_joint"}});
  CHECK(logged({"panda_joint1", "panda_joint2"}, {"q1", "q2"}) ==
        Names{{"panda_joint1", "q1"}, {"panda_joint2", "q2"}});
  CHECK(logged({"a_01", "a_02"}, {"a1", "a2"}) == Names{{"a_01", "a1"}, {"a_02", "a2"}});
  // Its own name goes before all likeness.
  CHECK(logged({"hip", "left_hip"}, {"hip", "left_hip"}).empty());
  CHECK_THAT(choose({"a", "b"}, angles({"A", "b"})).notes.at(0), Contains("'a' is 'A'"));
}

TEST_CASE("Where several names fit, or none, a line of a map file is proposed") {
  const JointChoice two = choose({"left_hip", "right_hip"}, angles({"hip"}));
  CHECK(two.logged.empty());
  CHECK_THAT(two.map_lines, Contains("angle_left_hip_rad = { column = \"angle_hip_rad\" }"));
  CHECK(choose({"hip"}, angles({"left_hip", "right_hip"})).logged.empty());
  const JointChoice none = choose({"a", "b"}, angles({"x", "y"}), {"a", "b"});
  CHECK(none.logged.empty());
  CHECK_THAT(none.map_lines, Contains("angle_a_rad = { column = \"angle_x_rad\" }") &&
                                 Contains("angle_b_rad = { column = \"angle_y_rad\" }"));
  const trees::TreeModel m = model_of({"left_hip", "right_hip"}, {{}, angles({"hip"}), false});
  log::Log log{"r.csv", "tree", {}, {}};
  for (const std::string& column : angles({"hip"}))
    for (int k = 0; k < 60; ++k) log.columns[column].push_back(0.01 * k);
  CHECK_THAT(test::error_message([&] { trees::recording_of(m, log); }),
             Contains("r.csv: joint 'left_hip' has no column 'angle_left_hip_rad'") &&
                 Contains("in a --map file: angle_left_hip_rad = { column = \"angle_hip_rad\" }"));
}

TEST_CASE("A log that counts joints from 0 is not taken for one that counts from 1") {
  const trees::TreeModel m =
      model_of({"joint_1", "joint_2", "joint_3"}, {{}, angles({"joint_0", "joint_1", "joint_2"}), false});
  CHECK(m.joints() == 3);
  CHECK_THAT(m.map_lines, Contains("angle_joint_1_rad = { column = \"angle_joint_0_rad\" }") &&
                              Contains("angle_joint_3_rad = { column = \"angle_joint_2_rad\" }"));
  // Both have them all, or the log has more: no counting is needed.
  CHECK(choose({"joint_1", "joint_2"}, angles({"joint_0", "joint_1", "joint_2"})).map_lines.empty());
}

TEST_CASE("All columns of a joint have the name that the log calls it by") {
  const trees::TreeModel m =
      model_of({"l_hip", "l_reach|"}, {{}, {"angle_left_hip_rad", "position_left_reach_m"}, false});
  CHECK(trees::column_of(m, 0, "angle") == "angle_left_hip_rad");
  CHECK(trees::column_of(m, 0, "torque_cmd") == "torque_cmd_left_hip_nm");
  CHECK(trees::column_of(m, 1, "velocity") == "velocity_left_reach_mps");
  CHECK(trees::column_of(m, 1, "torque") == "force_left_reach_n");
}

TEST_CASE("Two joints that would share a column are refused with both names") {
  CHECK_THAT(test::error_message([] {
               model_of({"elbow", "cmd_elbow"}, {});
             }),
             Contains("the joints 'elbow' and 'cmd_elbow'") && Contains("'torque_cmd_elbow_nm'") &&
                 Contains("joints = [\"elbow\"]"));
  CHECK(model_of({"elbow", "cmd_elbow"}, {}, "joints = [\"cmd_elbow\"]\n").joints() == 1);
  // A force is no torque.
  CHECK(model_of({"elbow", "cmd_elbow|"}, {}).joints() == 2);
}
