// Which joints move where a model file does not say so, and what a log calls them.
#include "host/trees/joint_choice.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <numeric>
#include <set>

#include "host/trees/joint_names.hpp"
#include "host/trees/model.hpp"
#include "host/trees/recording.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using Catch::Contains;
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

TEST_CASE("Of a joint that slides and is recorded as an angle, as in ROS 2, the lines of a map are given") {
  const JointChoice c = choose({"a", "b|"}, angles({"a", "b"}));
  CHECK(c.moving == std::vector<std::string>{"a"});
  REQUIRE(c.notes.size() == 1);
  CHECK_THAT(c.notes[0], Contains("Held at 0: 'b'") &&
                             Contains("A --map file may name columns of theirs: position_b_m = { column = "
                                      "\"angle_b_rad\" }, force_b_n = { column = \"torque_b_nm\" }"));
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

TEST_CASE("Abbreviated names are taken where each word begins that of one joint alone") {
  CHECK(logged({"shoulder_pitch", "elbow_pitch"}, {"sh_p", "el_p"}) ==
        Names{{"shoulder_pitch", "sh_p"}, {"elbow_pitch", "el_p"}});
  CHECK(logged({"left_shoulder_pitch", "right_shoulder_pitch"}, {"sh_p_r", "sh_p_l"}) ==
        Names{{"left_shoulder_pitch", "sh_p_l"}, {"right_shoulder_pitch", "sh_p_r"}});
  CHECK(logged({"hip", "knee"}, {"HipJoint", "kn"}) == Names{{"hip", "HipJoint"}, {"knee", "kn"}});
  // Written together, and numbers, of which one does not begin another.
  CHECK(logged({"shoulder_lift"}, {"shoulderlift"}) == Names{{"shoulder_lift", "shoulderlift"}});
  CHECK(logged({"wheel_1"}, {"w_10"}).empty());
  CHECK(logged({"a_1_1"}, {"a11"}).empty());
  // Two joints, or two columns, that it may be.
  for (const Names& none :
       {logged({"shoulder_pitch", "shoulder_pan"}, {"sh_p", "el"}), logged({"elbow"}, {"el", "elb"}),
        logged({"shoulder_pitch", "shoulder_pan"}, {"ShoulderPitch", "sh_p"})}) {
    CAPTURE(none.size());
    CHECK(none.count("shoulder_pan") == 0);
    CHECK(none.count("elbow") == 0);
  }
  // The other side's.
  CHECK(logged({"left_elbow"}, {"r_elb"}).empty());
}

TEST_CASE("A side that the shorter names leave out is one side") {
  CHECK(logged({"hip", "knee"}, {"left_hip", "left_knee"}).size() == 2);
  const JointChoice c = choose({"hip", "knee"}, angles({"left_hip", "right_knee"}));
  CHECK(c.logged.empty());
  CHECK_THAT(c.map_lines, Contains("angle_hip_rad = { column = \"angle_left_hip_rad\" }") &&
                              Contains("angle_knee_rad = { column = \"angle_right_knee_rad\" }"));
}

TEST_CASE("Pairs are proposed one to one, those that are most alike together, with all their columns") {
  // By the first letters; each joint's own best would be "upper_x" for both.
  const JointChoice c = choose({"upper_arm_roll", "upper_roll"}, angles({"upp_ar_x", "up_x"}),
                               {"upper_arm_roll", "upper_roll"});
  CHECK(c.logged.empty());
  CHECK_THAT(c.map_lines, Contains("angle_upper_arm_roll_rad = { column = \"angle_upp_ar_x_rad\" }, "
                                   "torque_upper_arm_roll_nm = { column = \"torque_upp_ar_x_nm\" }") &&
                              Contains("angle_upper_roll_rad = { column = \"angle_up_x_rad\" }"));
  // One column, two joints: it is proposed for one, and what has nothing in common for none.
  const JointChoice one = choose({"l_elbow", "r_elbow"}, angles({"elbow", "wrist"}));
  CHECK(one.logged.empty());
  const auto times = [&](const std::string& what) {
    std::size_t n = 0;
    for (auto at = one.map_lines.find(what); at != std::string::npos; at = one.map_lines.find(what, at + 1))
      ++n;
    return n;
  };
  CHECK(times("\"angle_elbow_rad\"") == 1);
  CHECK(times("\"angle_wrist_rad\"") == 0);
}

TEST_CASE("A joint whose column may be either of two is not held, it is asked for") {
  const std::vector<std::string> columns = angles({"shoulder", "left_elbow", "right_elbow"});
  const trees::TreeModel m = model_of({"shoulder", "elbow"}, {{}, columns, false});
  CHECK(m.joints() == 2);
  log::Log log{"r.csv", "tree", {}, {}};
  for (const std::string& column : columns)
    for (int k = 0; k < 60; ++k) log.columns[column].push_back(0.01 * k);
  CHECK_THAT(test::error_message([&] { trees::recording_of(m, log); }),
             Contains("joint 'elbow' has no column") &&
                 Contains("angle_elbow_rad = { column = \"angle_left_elbow_rad\" }") &&
                 Contains("(or those of 'right_elbow')"));
}

TEST_CASE("A joint whose name is perhaps shortened in the log is not held, it is asked for") {
  const JointChoice c = choose({"shoulder", "elbow", "gripper"}, angles({"shldr", "elbow"}));
  CHECK(c.logged.empty());
  CHECK(c.moving == std::vector<std::string>{"shoulder", "elbow"});
  CHECK_THAT(c.map_lines, Contains("angle_shoulder_rad = { column = \"angle_shldr_rad\" }"));
  // Where nothing is alike and the numbers differ: what a line looks like.
  CHECK_THAT(
      choose({"hip", "knee"}, angles({"u", "v", "w"})).map_lines,
      Contains("angle_hip_rad = { column = \"angle_NAME_rad\" }") && Contains("NAME one of 'u', 'v', 'w'"));
}

TEST_CASE("The best assignment has the largest sum that any one has") {
  unsigned seed = 1;
  const auto next = [&seed] {
    seed = seed * 1664525u + 1013904223u;
    return static_cast<double>(seed >> 24u) / 256.0;
  };
  for (std::size_t rows = 1; rows <= 5; ++rows)
    for (std::size_t columns = 0; columns <= 5; ++columns) {
      std::vector<std::vector<double>> w(rows, std::vector<double>(columns));
      for (auto& row : w)
        for (double& x : row) x = std::max(0.0, next() - 0.3);
      // All orders of rows and columns, those beyond the table worth nothing.
      std::vector<std::size_t> order(std::max(rows, columns));
      std::iota(order.begin(), order.end(), 0u);
      double best = 0.0;
      do {
        double sum = 0.0;
        for (std::size_t i = 0; i < rows; ++i)
          if (order[i] < columns) sum += w[i][order[i]];
        best = std::max(best, sum);
      } while (std::next_permutation(order.begin(), order.end()));
      const auto pairs = trees::best_assignment(w);
      REQUIRE(pairs.size() == rows);
      double sum = 0.0;
      std::set<std::size_t> used;
      for (std::size_t i = 0; i < rows; ++i)
        if (pairs[i]) {
          sum += w[i][*pairs[i]];
          CHECK(used.insert(*pairs[i]).second);
        }
      CHECK(sum == Approx(best));
    }
}

TEST_CASE("What a model file says of joints that the recordings leave out is not used, and said not to be") {
  const std::string more =
      "[drive]\ncontrol_mode = \"torque\"\n[drive.wheel]\ndamping_nmspr = 0.1\n[free]\n\"damping_nmspr.a\" = [0.0, 1.0]\n"
      "\"damping_nmspr.wheel\" = [0.0, 1.0]\n[effect.coulomb_friction.wheel]\ntorque_nm = 0.1\n";
  const trees::TreeModel m = model_of({"a", "wheel"}, {{}, angles({"a"}), false}, more);
  CHECK(m.joints() == 1);
  CHECK(m.free.size() == 1);
  CHECK(m.causes.empty());
  REQUIRE_FALSE(m.notes.empty());
  CHECK_THAT(
      m.notes.back(),
      Contains("Not used: [drive.wheel], [free] damping_nmspr.wheel and [effect.coulomb_friction.wheel]") &&
          Contains("'wheel' is held at 0: the recordings have no column of it") &&
          Contains("angle_wheel_rad, and torque_wheel_nm or torque_cmd_wheel_nm"));
  // With its columns, or without recordings, it moves.
  CHECK(model_of({"a", "wheel"}, {{}, angles({"a", "wheel"}), false}, more).free.size() == 2);
  CHECK(model_of({"a", "wheel"}, {}, more).causes.size() == 1);
  // Of one that follows another.
  CHECK_THAT(
      model_of({"a", "f", "g>f"}, {{}, angles({"a", "f"}), false}, "[drive.f]\ncontrol_mode = \"torque\"\n")
          .notes.back(),
      Contains("[drive.f]") && Contains("it is mimicked by 'g'"));
  CHECK_THAT(
      test::error_message([&] {
        model_of({"a", "wheel"}, {{}, angles({"a"}), false}, "[drive.whel]\ncontrol_mode = \"torque\"\n");
      }),
      Contains("no joint 'whel' that moves") && Contains("did you mean 'wheel'?"));
  // What the file itself holds is an error, which says so; and a key that is none.
  CHECK_THAT(test::error_message([&] {
               model_of({"a", "wheel"}, {}, "joints = [\"a\"]\n" + more);
             }),
             Contains("[drive.wheel]: no joint 'wheel' that moves") &&
                 Contains("joints in [model] does not name it"));
  CHECK_THAT(test::error_message([&] {
               model_of({"a", "wheel"}, {}, "[locked_joints]\nwheel = 0.1\n" + more);
             }),
             Contains("it is in [locked_joints]"));
  CHECK_THAT(test::error_message([&] {
               model_of({"a", "wheel"}, {{}, angles({"a"}), false}, "[drive.wheel]\ndamp = 0.1\n");
             }),
             Contains("unknown key 'damp' in [drive.wheel]"));
}

TEST_CASE("A link that stands still with a joint that the recordings leave out is no error in [free]") {
  const trees::TreeModel m =
      model_of({"b", "a"}, {{}, angles({"a"}), false},
               "[free]\n\"inertial.l1\" = [0.5, 2.0]\n[effect.mass_error.l1]\nmass_kg = 1.2\n");
  CHECK(m.free_bodies.empty());
  CHECK(m.causes.empty());
  CHECK_THAT(m.notes.back(),
             Contains("[free] inertial.l1 and [effect.mass_error.l1]") && Contains("'b' is held"));
}

TEST_CASE("Of a joint that is held the range is told that the recordings have it in") {
  const auto log_of = [](const std::vector<std::string>& joints) {
    log::Log log{"r.csv", "tree", {}, {}};
    for (const std::string& column : angles(joints))
      for (int k = 0; k <= 60; ++k) log.columns[column].push_back(-0.2 + 0.01 * k);
    return log;
  };
  const log::Log log = log_of({"a", "f", "g"});
  const trees::TreeModel m = model_of({"a", "f", "g>f"}, {{}, angles({"a", "f", "g"}), false});
  const auto notes = trees::notes_on_held(m, {&log});
  REQUIRE(notes.size() == 2);
  CHECK_THAT(notes[0],
             Contains("Joint 'f' is held at 0 rad, and the recordings have it from -0.2 to 0.4 rad") &&
                 Contains("'angle_f_rad' is not used") && Contains("write f = 0.1 in [locked_joints]") &&
                 Contains("take the <mimic> of 'g' out of the URDF"));
  CHECK_THAT(notes[1], Contains("its <mimic> of 'f' out of the URDF"));
  const trees::TreeModel chosen = model_of({"a", "f"}, {}, "joints = [\"a\"]\n[locked_joints]\nf = 0.25\n");
  CHECK_THAT(trees::notes_on_held(chosen, {&log}).at(0),
             Contains("held at 0.25 rad") && Contains("correct it in [locked_joints]"));
  CHECK(trees::notes_on_held(model_of({"a", "f"}, {}), {&log}).empty());
  const log::Log without = log_of({"a"});
  CHECK(trees::notes_on_held(m, {&without}).empty());
}

TEST_CASE(
    "A spring that a URDF gives a joint is named with the whole of its line, and that it acts both ways") {
  std::string urdf = chain({"a", "b"});
  urdf.insert(
      urdf.rfind("</robot>"),
      "<gazebo reference=\"b\"><springStiffness>4</springStiffness><springReference>0.3</springReference></gazebo>");
  const std::string text = "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"c.urdf\"\n";
  const trees::TreeModel m = trees::parse_tree_model(text, "c.toml", urdf);
  REQUIRE(m.notes.size() == 1);
  CHECK_THAT(m.notes[0], Contains("[spring.b] stiffness_nmprad = 4.0, rest_rad = 0.3") &&
                             Contains("pushes back above rest_rad alone, and the URDF's both ways"));
}
