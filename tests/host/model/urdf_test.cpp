// Robots from URDF: what is read, and what is refused, with file, element and what was expected.
#include "host/model/urdf.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "furcula/dynamics/tree/energy.hpp"
#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/model/example.hpp"

using namespace furcula;
using Catch::Matchers::Contains;
using test::with;

namespace {

const std::string kRobot =
    "<robot name=\"arm\">\n"
    "<link name=\"base\"/>\n"
    "<link name=\"upper\"><inertial><origin xyz=\"0 0 -0.2\" rpy=\"0 0 1.5707963267948966\"/><mass value=\"2\"/>"
    "<inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.02\" iyz=\"0\" izz=\"0.015\"/></inertial></link>\n"
    "<link name=\"lower\"><inertial><mass value=\"1\"/>"
    "<inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.015\"/></inertial></link>\n"
    "<joint name=\"shoulder\" type=\"revolute\"><parent link=\"base\"/><child link=\"upper\"/>"
    "<origin xyz=\"0.1 0 1\" rpy=\"0.3 0 0\"/><axis xyz=\"0 2 0\"/><limit lower=\"-1\" upper=\"2\" effort=\"5\" velocity=\"7\"/>"
    "<dynamics damping=\"0.1\" friction=\"0.2\"/></joint>\n"
    "<joint name=\"elbow\" type=\"continuous\"><parent link=\"upper\"/><child link=\"lower\"/>"
    "<origin xyz=\"0 0 -0.4\"/><axis xyz=\"0 1 0\"/></joint>\n"
    "</robot>\n";

std::string refused(const std::string& text, const std::vector<std::string>& moving = {},
                    const std::map<std::string, double>& hold = {}) {
  const std::string message =
      test::error_message([&] { model::tree_of(model::parse_urdf(text, "r.urdf"), moving, hold); });
  CHECK_THAT(message, Catch::StartsWith("r.urdf"));
  CHECK(message.find('\n') == std::string::npos);
  CHECK(message.find('\x1b') == std::string::npos);
  CHECK(message.size() < 700);
  return message;
}
std::string refused_with(const std::string& from, const std::string& to) {
  return refused(with(kRobot, from, to));
}

}  // namespace

TEST_CASE(
    "Names that could not stand in a line of a log are refused, spaces around the robot's are dropped") {
  CHECK_THAT(refused_with("\"arm\"", "\"a&#10;1,2,3\""), Contains("the robot's name is 'a"));
  CHECK_THAT(refused_with("\"arm\"", "\"a&#27;[2J\""), Contains("without control characters"));
  CHECK_THAT(refused_with("\"elbow\"", "\"el&#10;bow\""), Contains("a joint's name is 'el"));
  std::string link = with(kRobot, "\"lower\"", "\"lo&#13;wer\"");
  CHECK_THAT(refused(with(link, "\"lower\"", "\"lo&#13;wer\"")), Contains("a link's name is 'lo"));
  CHECK(model::parse_urdf(with(kRobot, "\"arm\"", "\" my arm \""), "r.urdf").name == "my arm");
}

TEST_CASE("A URDF gives links, joints, limits, damping and friction") {
  const model::Urdf r = model::parse_urdf(kRobot, "r.urdf");
  CHECK(r.name == "arm");
  REQUIRE(r.links.size() == 3);
  CHECK(r.links[0].name == "base");
  CHECK_FALSE(r.links[0].inertia);
  CHECK(r.links[1].inertia->mass_kg == 2.0);
  CHECK(r.links[1].inertia->frame.at.z == -0.2);
  REQUIRE(r.joints.size() == 2);
  const model::UrdfJoint& j = r.joints[0];
  CHECK(j.name == "shoulder");
  CHECK(j.kind == model::UrdfJoint::Kind::revolute);
  CHECK((j.parent == 0 && j.child == 1));
  CHECK(j.axis.y == 1.0);
  CHECK(j.limits->upper == 2.0);
  CHECK(j.limits->effort == 5.0);
  CHECK(j.damping == 0.1);
  CHECK(j.friction == 0.2);
  // Turned by 0.3 about x: the child's y axis, in the parent.
  CHECK(j.placement.turn.y.y == Approx(std::cos(0.3)));
  CHECK(j.placement.turn.y.z == Approx(std::sin(0.3)));
  CHECK(r.joints[1].kind == model::UrdfJoint::Kind::continuous);
}

TEST_CASE("The tree has the inertias in the links' axes, and the laws of the joints") {
  const model::RobotTree t = model::tree_of(model::parse_urdf(kRobot, "r.urdf"));
  REQUIRE(t.joints.size() == 2);
  CHECK(t.joints[1].name == "elbow");
  CHECK(t.joints[1].link == "lower");
  CHECK(t.model.shape().parent(1) == 0);
  CHECK(t.model.laws[0].damping_nmspr == 0.1);
  CHECK(t.model.laws[0].friction_nm == 0.2);
  // Turned by a right angle about z: xx and yy change places; then Steiner with 2 kg at 0.2 m.
  const auto body = t.model.body(0);
  CHECK(body.mass_kg == Approx(2.0));
  CHECK(body.moment_kgm.z == Approx(-0.4));
  CHECK(body.inertia_kgm2.xx == Approx(0.02 + 2 * 0.04));
  CHECK(body.inertia_kgm2.yy == Approx(0.01 + 2 * 0.04));
  CHECK(body.inertia_kgm2.zz == Approx(0.015));
  const auto frames = dynamics::tree::link_frames(t.model, {});
  CHECK(frames[1].at.x == Approx(0.1));
  CHECK(frames[1].at.z == Approx(1.0 - 0.4 * std::cos(0.3)));
}

TEST_CASE("A joint that is held is a part of the body before it, at the given position") {
  const model::Urdf r = model::parse_urdf(kRobot, "r.urdf");
  const model::RobotTree whole = model::tree_of(r), held = model::tree_of(r, {"shoulder"}, {{"elbow", 0.7}});
  REQUIRE(held.joints.size() == 1);
  CHECK(held.links[2].joint == 0);
  const auto a = dynamics::tree::mass_matrix(whole.model, {0.4, 0.7});
  const auto b = dynamics::tree::mass_matrix(held.model, {0.4});
  CHECK(b[0][0] == Approx(a[0][0]).epsilon(1e-12));
  CHECK(dynamics::tree::potential_energy_j(held.model, {0.4}) ==
        Approx(dynamics::tree::potential_energy_j(whole.model, {0.4, 0.7})).epsilon(1e-12));
  // The one before those that move: then it is the base that holds the rest.
  const model::RobotTree lower = model::tree_of(r, {"elbow"}, {{"shoulder", 0.2}});
  CHECK(lower.links[1].joint == -1);
  CHECK(dynamics::tree::bias_forces(lower.model, {0.3}, {})[0] == Approx(0.0).margin(1e-12));
}

TEST_CASE("A joint of which the list has no such name is refused, with the name that was perhaps meant") {
  CHECK_THAT(refused(kRobot, {"shoulde"}),
             Contains("no joint 'shoulde' (did you mean 'shoulder'?); expected one of shoulder, elbow"));
  CHECK_THAT(refused(kRobot, {"elbow", "elbow"}), Contains("joint 'elbow' is named twice"));
  CHECK_THAT(refused(kRobot, {"elbow"}, {{"knee", 1.0}}), Contains("no joint 'knee'"));
  CHECK_THAT(refused(kRobot, {"elbow"}, {{"elbow", 1.0}}), Contains("joint 'elbow' moves"));
  CHECK_THAT(refused(kRobot, {"elbow"}, {{"shoulder", NAN}}), Contains("held at nan"));
}

TEST_CASE("A link with two parents, and loops, are refused") {
  const std::string extra =
      "<joint name=\"rod\" type=\"continuous\"><parent link=\"base\"/><child link=\"lower\"/><axis xyz=\"0 1 0\"/></joint>\n</robot>";
  CHECK_THAT(refused_with("</robot>", extra),
             Contains("link 'lower' is the child of joint 'elbow' and of joint 'rod', expected one parent"));
  CHECK_THAT(
      refused_with("<parent link=\"base\"/><child link=\"upper\"/>",
                   "<parent link=\"lower\"/><child link=\"upper\"/>"),
      Contains("link 'lower' is in a loop of joints") || Contains("link 'upper' is in a loop of joints"));
  CHECK_THAT(refused_with("<link name=\"base\"/>", "<link name=\"base\"/><link name=\"other\"/>"),
             Contains("root"));
  CHECK_THAT(refused_with("<child link=\"lower\"/>", "<child link=\"lowr\"/>"), Contains("lowr"));
}

TEST_CASE("Inertias that no body can have are refused, with link and principal moments") {
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"-2\"/>"),
             Contains("link 'upper': its <mass> is -2, expected at least 0"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"0\"/>"),
             Contains("link 'upper': its <mass> is 0, expected more than 0"));
  CHECK_THAT(
      refused_with("izz=\"0.015\"/></inertial></link>\n<joint", "izz=\"0.021\"/></inertial></link>\n<joint"),
      Contains(
          "link 'lower': its <inertia> has the principal moments 0.01, 0.01, 0.021 kg m^2, which no body has"));
  CHECK_THAT(
      refused_with("ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.02\"",
                   "ixx=\"0.01\" ixy=\"0.02\" ixz=\"0\" iyy=\"0.02\""),
      Contains(
          "link 'upper': its <inertia> has the principal moments -0.005616, 0.015, 0.03562 kg m^2, expected all above 0"));
  const std::size_t from = kRobot.find("<link name=\"lower\">"), to = kRobot.find("<joint");
  CHECK_THAT(
      refused(with(kRobot, kRobot.substr(from, to - from), "<link name=\"lower\"/>\n")),
      Contains("link 'lower' moves (joint 'elbow') and neither it nor a link fixed to it has an <inertial>"));
}

TEST_CASE("Axes, limits and numbers that make no sense are refused") {
  CHECK_THAT(refused_with("<axis xyz=\"0 2 0\"/>", "<axis xyz=\"0 0 0\"/>"),
             Contains("joint 'shoulder': its <axis> is 0 0 0, expected a direction"));
  CHECK_THAT(refused_with("lower=\"-1\" upper=\"2\"", "lower=\"3\" upper=\"2\""),
             Contains("joint 'shoulder': its <limit> has lower 3 above upper 2"));
  CHECK_THAT(refused_with("damping=\"0.1\"", "damping=\"-0.1\""),
             Contains("joint 'shoulder': its <dynamics> damping is -0.1"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"nan\"/>"), Contains("not a robot (URDF)"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"1e999\"/>"), Contains("r.urdf"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"two\"/>"), Contains("upper"));
  CHECK_THAT(refused_with("xyz=\"0.1 0 1\"", "xyz=\"0.1 inf 1\""), Contains("r.urdf"));
  CHECK_THAT(refused_with("xyz=\"0.1 0 1\"", "xyz=\"0.1 1\""), Contains("r.urdf"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", ""), Contains("upper"));
  CHECK_THAT(refused_with("<limit lower=\"-1\" upper=\"2\" effort=\"5\" velocity=\"7\"/>", ""),
             Contains("limit"));
}

TEST_CASE("Joints that this tree does not have are refused") {
  CHECK_THAT(refused_with("type=\"continuous\"", "type=\"floating\""),
             Contains("joint 'elbow' is floating, expected revolute, continuous, prismatic or fixed"));
  CHECK_THAT(refused_with("type=\"continuous\"", "type=\"planar\""), Contains("joint 'elbow' is planar"));
  CHECK_THAT(refused_with("type=\"continuous\"", "type=\"hinge\""), Contains("elbow"));
  const std::string mimic = "<axis xyz=\"0 1 0\"/><mimic joint=\"shoulder\" multiplier=\"2\"/></joint>";
  CHECK_THAT(refused_with("<axis xyz=\"0 1 0\"/></joint>", mimic),
             Contains("joint 'elbow' mimics 'shoulder', expected joints that move by themselves"));
  CHECK_THAT(refused_with("<axis xyz=\"0 1 0\"/></joint>", with(mimic, "shoulder", "wrist")),
             Contains("joint 'elbow' mimics 'wrist', which is no joint of the robot"));
  CHECK_THAT(refused("<robot name=\"stone\"><link name=\"base\"/></robot>"), Contains("no joint that moves"));
}

TEST_CASE("What is not XML, not a robot, or too deep is refused with its line") {
  CHECK_THAT(refused("time_s,angle\n0,1\n"), Contains("r.urdf:1: not XML"));
  CHECK_THAT(refused("<robot name=\"a\">\n<link name=\"b\">\n</robot>"),
             Contains("r.urdf:3: </robot>, expected </link>"));
  CHECK_THAT(refused("<robot name=\"a\">\n"), Contains("r.urdf:2: <robot> is not closed"));
  CHECK_THAT(refused("<robot name=a/>"), Contains("attribute 'name' has no quotes"));
  CHECK_THAT(refused("<!DOCTYPE robot [<!ENTITY a \"b\">]><robot/>"), Contains("a document type"));
  CHECK_THAT(refused("<mujoco/>"), Contains("not a robot (URDF)"));
  CHECK_THAT(refused("<robot/>"), Contains("not a robot (URDF)"));
  CHECK_THAT(refused("<robot name=\"a\"/>"), Contains("not a robot (URDF)"));
  CHECK_THAT(refused("<robot name=\"a\"/><robot name=\"b\"/>"), Contains("a second root element <robot>"));
  std::string deep, close;
  for (int i = 0; i < 100000; ++i) deep += "<a>";
  CHECK_THAT(refused(deep), Contains("nest deeper than 32"));
}

TEST_CASE("Names come out printable, whatever they hold") {
  const std::string name = "el\x1b[31mbow";
  CHECK_THAT(refused_with("name=\"elbow\" type=\"continuous\"", "name=\"" + name + "\" type=\"planar\""),
             Contains("a joint's name is 'el\\x1b[31mbow'"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"\x1b]0;x\"/>"), Contains("r.urdf"));
}

TEST_CASE("Files that are empty, too large or not there are refused") {
  const auto folder = std::filesystem::temp_directory_path();
  const std::string path = folder / "furcula_urdf_test.urdf";
  std::ofstream(path) << "";
  CHECK_THAT(test::error_message([&] { model::read_urdf(path); }),
             Contains("the file is empty; expected a robot (URDF)"));
  std::ofstream(path) << std::string(50u << 20, ' ');
  CHECK_THAT(test::error_message([&] { model::read_urdf(path); }), Contains("larger than 1 MiB"));
  std::filesystem::remove(path);
  CHECK_THAT(test::error_message([&] { model::read_urdf(path); }), Contains(path));
}

TEST_CASE("urdfdom prints nothing") {
  // A parser that speaks to the terminal would be seen on standard error.
  std::fflush(stderr);
  const int kept = dup(2);
  FILE* file = std::tmpfile();
  REQUIRE(file != nullptr);
  dup2(fileno(file), 2);
  refused("<robot name=\"a\"/>");
  refused_with("<mass value=\"2\"/>", "<mass value=\"two\"/>");
  std::fflush(stderr);
  dup2(kept, 2);
  close(kept);
  CHECK(std::ftell(file) == 0);
  std::fseek(file, 0, SEEK_END);
  CHECK(std::ftell(file) == 0);
  std::fclose(file);
}
