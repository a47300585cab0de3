// Robots from URDF: what is read, and what is refused, with file, element and what was expected.
#include "host/model/urdf.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "furcula/dynamics/tree/energy.hpp"
#include "furcula/dynamics/tree/forward_dynamics.hpp"
#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "tests/folder.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/model/example.hpp"

using namespace furcula;
using Catch::Contains;
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
             Contains("r.urdf:3: link 'upper': its <mass> is -2, expected at least 0") &&
                 Contains("--accept-inertias"));
  CHECK_THAT(
      refused_with("izz=\"0.015\"/></inertial></link>\n<joint", "izz=\"0.025\"/></inertial></link>\n<joint"),
      Contains(
          "r.urdf:4: link 'lower': its <inertia> has the principal moments 0.01, 0.01, 0.025 kg m^2, which no body has") &&
          Contains("--accept-inertias"));
  CHECK_THAT(
      refused_with("ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.02\"",
                   "ixx=\"0.01\" ixy=\"0.02\" ixz=\"0\" iyy=\"0.02\""),
      Contains(
          "link 'upper': its <inertia> has the principal moments -0.005616, 0.015, 0.03562 kg m^2, expected none below 0"));
  const std::size_t from = kRobot.find("<link name=\"lower\">"), to = kRobot.find("<joint");
  CHECK_THAT(refused(with(kRobot, kRobot.substr(from, to - from), "<link name=\"lower\"/>\n")),
             Contains("link 'lower' moves (joint 'elbow') and nothing gives the joint an inertia") &&
                 Contains("rotor_inertia_kgm2 in [drive.elbow]"));
}

TEST_CASE("Inertias that no body has are taken as they are where that is asked for, and said to be") {
  model::TreeOptions accept;
  accept.accept_inertias = true;
  const std::string odd =
      with(kRobot, "izz=\"0.015\"/></inertial></link>\n<joint", "izz=\"0.025\"/></inertial></link>\n<joint");
  const model::RobotTree t = model::tree_of(model::parse_urdf(odd, "r.urdf"), {}, {}, accept);
  CHECK(t.model.body(1).inertia_kgm2.zz == 0.025);
  REQUIRE(t.notes.size() == 1);
  CHECK_THAT(t.notes[0], Contains("Accepted as they are: the <inertia> of link 'lower'"));
  // About the elbow's axis, y, it is iyy: below 0 nothing makes it move as a body does.
  const std::string negative =
      with(kRobot, "iyy=\"0.01\" iyz=\"0\" izz=\"0.015\"/></inertial></link>\n<joint",
           "iyy=\"-0.01\" iyz=\"0\" izz=\"0.015\"/></inertial></link>\n<joint");
  CHECK_THAT(
      test::error_message([&] { model::tree_of(model::parse_urdf(negative, "r.urdf"), {}, {}, accept); }),
      Contains("joint 'elbow'") && Contains("inertia about the joint is below 0"));
}

TEST_CASE("A point, a rod and a sheet are bodies") {
  const auto tree = [](const std::string& inertia) {
    return model::tree_of(model::parse_urdf(
        with(
            with(kRobot, "<link name=\"lower\"><inertial>",
                 "<link name=\"lower\"><inertial><origin xyz=\"0 0 -0.3\"/>"),
            "<inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.015\"/></inertial></link>\n<joint",
            inertia + "</inertial></link>\n<joint"),
        "r.urdf"));
  };
  const auto about_elbow = [](const model::RobotTree& t) {
    return dynamics::tree::mass_matrix(t.model, {0.0, 0.0})[1][1];
  };
  // 1 kg at 0.3 m.
  const model::RobotTree point =
      tree("<inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/>");
  CHECK(about_elbow(point) == Approx(0.09).epsilon(1e-12));
  CHECK(point.notes.empty());
  const model::RobotTree rod =
      tree("<inertia ixx=\"0.03\" ixy=\"0\" ixz=\"0\" iyy=\"0.03\" iyz=\"0\" izz=\"0\"/>");
  CHECK(about_elbow(rod) == Approx(0.12).epsilon(1e-12));
  CHECK(rod.notes.empty());
  const model::RobotTree sheet =
      tree("<inertia ixx=\"0.03\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.02\"/>");
  CHECK(about_elbow(sheet) == Approx(0.10).epsilon(1e-12));
  CHECK(sheet.notes.empty());
  // A mass alone is a point, which is said.
  const model::RobotTree bare = tree("");
  CHECK(about_elbow(bare) == Approx(0.09).epsilon(1e-12));
  // On the axis a point has no inertia about it.
  const std::string on_axis = with(
      kRobot,
      "<inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.015\"/></inertial></link>\n<joint",
      "<inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link>\n<joint");
  CHECK_THAT(refused(on_axis), Contains("joint 'elbow'") && Contains("nothing gives the joint an inertia"));
}

TEST_CASE("Moments that miss what a body has by less than they are rounded are moved there, and said once") {
  const auto lower = [](const std::string& xx, const std::string& yy, const std::string& zz) {
    return with(
        kRobot,
        "<inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" iyy=\"0.01\" iyz=\"0\" izz=\"0.015\"/></inertial></link>\n<joint",
        "<inertia ixx=\"" + xx + "\" ixy=\"0\" ixz=\"0\" iyy=\"" + yy + "\" iyz=\"0\" izz=\"" + zz +
            "\"/></inertial></link>\n<joint");
  };
  // A sheet of 0.000123496, 0.000213496 and 0.000336992, printed to six decimals: 123 + 213 < 337.
  const model::Urdf printed = model::parse_urdf(lower("0.000123", "0.000213", "0.000337"), "r.urdf");
  CHECK(printed.links[2].repaired);
  const auto& moments = printed.links[2].inertia->about_centre_kgm2;
  CHECK(moments.xx + moments.yy == Approx(moments.zz).epsilon(1e-9));
  // A third of the missing 1e-6 at each, below the half of a digit by which each is off.
  CHECK(moments.xx == Approx(0.000123 + 1e-6 / 3.0).epsilon(1e-9));
  const model::RobotTree t = model::tree_of(printed);
  REQUIRE(t.notes.size() == 1);
  CHECK_THAT(t.notes[0], Contains("off by less than they are rounded") && Contains("'lower'"));
  // To four digits, zeros at the end dropped: 0.00009999 + 0.0030 against 0.0031.
  CHECK(model::parse_urdf(lower("0.00009999", "0.0030", "0.0031"), "r.urdf").links[2].repaired);
  CHECK(model::parse_urdf(lower("-1.3e-10", "0.0030", "0.0030"), "r.urdf").links[2].repaired);
  // With seven decimals the same is no rounding; nor are typed numbers rounded.
  CHECK_THAT(refused(lower("0.0001230", "0.0002130", "0.0003370")), Contains("which no body has"));
  CHECK_THAT(refused(lower("1", "1", "3")), Contains("which no body has"));
  CHECK_THAT(refused(lower("0.01", "0.01", "0.03")), Contains("which no body has"));
  CHECK_THAT(refused(lower("-0.001", "0.01", "0.01")), Contains("expected none below 0"));
  // What has been right stays as it is, bit by bit.
  const model::Urdf good = model::parse_urdf(kRobot, "r.urdf");
  CHECK_FALSE(good.links[2].repaired);
  CHECK(good.links[2].inertia->about_centre_kgm2.zz == 0.015);
}

TEST_CASE("Links that are fixed to each other are judged as one body, those of the base not at all") {
  const auto fixed_to = [](const std::string& link, const std::string& inertial) {
    return with(kRobot, "</robot>",
                "<link name=\"tip\"><inertial>" + inertial +
                    "</inertial></link><joint name=\"tip_joint\" type=\"fixed\"><parent link=\"" + link +
                    "\"/><child link=\"tip\"/></joint></robot>");
  };
  const std::string none =
      "<mass value=\"0\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/>";
  const std::string small =
      "<mass value=\"0\"/><inertia ixx=\"1e-6\" ixy=\"0\" ixz=\"0\" iyy=\"1e-6\" iyz=\"0\" izz=\"1e-6\"/>";
  const std::string odd =
      "<mass value=\"1e-8\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"3e-8\"/>";
  const std::string wrong =
      "<mass value=\"-1\"/><inertia ixx=\"-1\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"x\"/>";
  CHECK(model::tree_of(model::parse_urdf(fixed_to("lower", none), "r.urdf")).notes.empty());
  const model::RobotTree kept = model::tree_of(model::parse_urdf(fixed_to("lower", small), "r.urdf"));
  CHECK(kept.model.body(1).inertia_kgm2.xx == Approx(0.010001).epsilon(1e-12));
  REQUIRE(kept.notes.size() == 1);
  CHECK_THAT(kept.notes[0], Contains("An <inertia> and no mass: link 'tip'"));
  const model::RobotTree merged = model::tree_of(model::parse_urdf(fixed_to("lower", odd), "r.urdf"));
  REQUIRE(merged.notes.size() == 1);
  CHECK_THAT(merged.notes[0], Contains("no body has alone: link 'tip'"));
  CHECK(model::tree_of(model::parse_urdf(fixed_to("base", wrong), "r.urdf")).notes.empty());
  CHECK_THAT(refused(fixed_to("lower", wrong)),
             Contains("link 'tip': its <inertia> izz 'x' is no finite number"));
}

TEST_CASE("A link without mass between two joints takes its inertia from the links beyond it") {
  // A cardan joint: two axes at a right angle in one place, the body beyond them.
  const std::string cardan = with(
      with(kRobot, "<parent link=\"upper\"/>", "<parent link=\"cross\"/>"), "</robot>",
      "<link name=\"cross\"/><joint name=\"roll\" type=\"continuous\"><parent link=\"upper\"/><child link=\"cross\"/>"
      "<axis xyz=\"1 0 0\"/></joint></robot>");
  const model::RobotTree t = model::tree_of(model::parse_urdf(cardan, "r.urdf"));
  REQUIRE(t.joints.size() == 3);
  REQUIRE(t.notes.size() == 1);
  CHECK_THAT(t.notes[0], Contains("moves without mass: link 'cross'"));
  // The torques of an acceleration give that acceleration back.
  const model::RobotModel::Joints q{0.3, 0.5, -0.7}, qd{0.1, -0.4, 0.2}, qdd{1.0, -2.0, 3.0};
  const auto tau = dynamics::tree::inverse_dynamics(t.model, q, qd, qdd);
  const auto back = dynamics::tree::accelerations(t.model, q, qd, tau);
  for (std::size_t i = 0; i < 3; ++i) CHECK(back[i] == Approx(qdd[i]).epsilon(1e-9));
  // Turned to one axis, nothing tells one joint's angle from the other's.
  const std::string aligned =
      with(with(cardan, "<axis xyz=\"1 0 0\"/>", "<axis xyz=\"0 1 0\"/>"), "<origin xyz=\"0 0 -0.4\"/>", "");
  CHECK_THAT(refused(aligned), Contains("nothing gives the joint an inertia"));
}

TEST_CASE(
    "Numbers in another unit are named when they are read, with the unit that makes all bodies plausible") {
  const auto inertias = [](double by) {
    const auto n = [&](double x) { return "\"" + std::to_string(x * by) + "\""; };
    return "<robot name=\"arm\"><link name=\"base\"/><link name=\"upper\"><inertial><origin xyz=\"0.12 0 0\"/><mass value=\"1.2\"/>"
           "<inertia ixx=" +
           n(0.0012) + " ixy=\"0\" ixz=\"0\" iyy=" + n(0.0075) + " iyz=\"0\" izz=" + n(0.0073) +
           "/></inertial></link>"
           "<link name=\"fore\"><inertial><origin xyz=\"0.1 0 0\"/><mass value=\"0.7\"/>"
           "<inertia ixx=" +
           n(0.0005) + " ixy=\"0\" ixz=\"0\" iyy=" + n(0.0031) + " iyz=\"0\" izz=" + n(0.0030) +
           "/></inertial></link>"
           "<joint name=\"a\" type=\"continuous\"><parent link=\"base\"/><child link=\"upper\"/><axis xyz=\"0 1 0\"/></joint>"
           "<joint name=\"b\" type=\"continuous\"><parent link=\"upper\"/><child link=\"fore\"/><origin xyz=\"0.25 0 0\"/><axis xyz=\"0 1 0\"/></joint></robot>";
  };
  CHECK(model::tree_of(model::parse_urdf(inertias(1.0), "r.urdf")).notes.empty());
  CHECK_THAT(refused(inertias(1e9)), Contains("link 'upper'") && Contains("a radius of 2.5 km") &&
                                         Contains("g mm^2: x 1e-9") && Contains("--accept-inertias"));
  CHECK_THAT(refused(inertias(1e6)), Contains("kg mm^2: x 1e-6"));
  CHECK_THAT(refused(inertias(1e7)), Contains("g cm^2: x 1e-7"));
  model::TreeOptions accept;
  accept.accept_inertias = true;
  CHECK(model::tree_of(model::parse_urdf(inertias(1e9), "r.urdf"), {}, {}, accept).notes.size() == 1);
  // Masses in grams: 1.2 t in a hand.
  const std::string grams =
      with(with(inertias(1.0), "value=\"1.2\"", "value=\"1200\""), "value=\"0.7\"", "value=\"700\"");
  CHECK_THAT(refused(grams), Contains("denser than any matter") && Contains("the masses are in g, x 1e-3"));
  const auto lengths = [&](const std::string& a, const std::string& b, const std::string& c) {
    return with(
        with(with(inertias(1.0), "\"0.12 0 0\"", "\"" + a + " 0 0\""), "\"0.1 0 0\"", "\"" + b + " 0 0\""),
        "\"0.25 0 0\"", "\"" + c + " 0 0\"");
  };
  CHECK_THAT(refused(lengths("120", "100", "250")), Contains("mm: x 0.001") && Contains("expected metres"));
  CHECK_THAT(refused(lengths("12", "10", "25")), Contains("cm: x 0.01"));
  // Of one link alone, and where it is hardly certain it is said and taken.
  CHECK_THAT(refused(with(inertias(1.0),
                          "ixx=\"0.000500\" ixy=\"0\" ixz=\"0\" iyy=\"0.003100\" iyz=\"0\" izz=\"0.003000\"",
                          "ixx=\"500000\" ixy=\"0\" ixz=\"0\" iyy=\"3100000\" iyz=\"0\" izz=\"3000000\"")),
             Contains("link 'fore'") && Contains("g mm^2: x 1e-9"));
  const auto odd = model::tree_of(model::parse_urdf(inertias(1e4), "r.urdf"));
  REQUIRE(odd.notes.size() == 1);
  CHECK_THAT(odd.notes[0], Contains("kg cm^2: x 1e-4"));
  // A wheel on a bench of a large hall is none of that: where the base's joint is does not matter.
  CHECK(model::tree_of(model::parse_urdf(with(inertias(1.0), "<child link=\"upper\"/>",
                                              "<child link=\"upper\"/><origin xyz=\"150 0 0\"/>"),
                                         "r.urdf"))
            .notes.empty());
}

TEST_CASE("Axes, limits and numbers that make no sense are refused") {
  CHECK_THAT(refused_with("<axis xyz=\"0 2 0\"/>", "<axis xyz=\"0 0 0\"/>"),
             Contains("joint 'shoulder': its <axis> is 0 0 0, expected a direction"));
  CHECK_THAT(refused_with("damping=\"0.1\"", "damping=\"-0.1\""),
             Contains("joint 'shoulder': its <dynamics> damping is -0.1"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"nan\"/>"),
             Contains("r.urdf:3: link 'upper': its <mass> 'nan' is no finite number"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"1e999\"/>"), Contains("r.urdf:3: "));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"two\"/>"), Contains("upper"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"2,5\"/>"),
             Contains("'2,5'") && Contains("with a decimal point"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"0x10\"/>"), Contains("decimal"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"2kg\"/>"), Contains("without unit"));
  CHECK_THAT(refused_with("xyz=\"0.1 0 1\"", "xyz=\"0.1 inf 1\""),
             Contains("r.urdf:5: joint 'shoulder': <origin> xyz is '0.1 inf 1'"));
  CHECK_THAT(refused_with("xyz=\"0.1 0 1\"", "xyz=\"0.1 1\""),
             Contains("r.urdf:5: joint 'shoulder': <origin> xyz is '0.1 1', expected three numbers"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", ""), Contains("link 'upper': its <inertial> has no mass"));
  // Blanks of all kinds, a plus and exponents are numbers as any.
  const model::Urdf r = model::parse_urdf(with(with(kRobot, "\"0.1 0 1\"", "\" +1e-1\t0\n1.0 \""),
                                               "<mass value=\"2\"/>", "<mass value=\" 20E-1 \"/>"),
                                          "r.urdf");
  CHECK(r.joints[0].placement.at.x == 0.1);
  CHECK(r.links[1].inertia->mass_kg == 2.0);
}

TEST_CASE("A limit is never refused: what is of no use is not used, and said") {
  const auto limit = [](const std::string& text) {
    return model::tree_of(model::parse_urdf(
        with(kRobot, "<limit lower=\"-1\" upper=\"2\" effort=\"5\" velocity=\"7\"/>", text), "r.urdf"));
  };
  for (const char* text :
       {"", "<limit/>", "<limit lower=\"-inf\" upper=\"inf\" effort=\"5\" velocity=\"7\"/>",
        "<limit lower=\"-1\" upper=\"inf\" effort=\"5\" velocity=\"7\"/>",
        "<limit lower=\"nan\" upper=\"2\" effort=\"5\" velocity=\"7\"/>",
        "<limit lower=\"3\" upper=\"2\" effort=\"5\" velocity=\"7\"/>",
        "<limit effort=\"5\" velocity=\"7\"/>"}) {
    INFO(text);
    const model::RobotTree t = limit(text);
    REQUIRE(t.notes.size() == 1);
    CHECK_THAT(t.notes[0], Contains("its <limit> is not used: joint 'shoulder'"));
    CHECK_FALSE((t.joints[0].limits && t.joints[0].limits->lower < t.joints[0].limits->upper));
  }
  // Those of force and speed are not needed.
  const model::RobotTree t = limit("<limit lower=\"-1\" upper=\"2\"/>");
  CHECK(t.notes.empty());
  CHECK(t.joints[0].limits->upper == 2.0);
}

TEST_CASE("What dynamics do not use is not judged, and does not move the lines of messages") {
  const std::string dressed = with(
      with(
          kRobot, "<link name=\"base\"/>\n",
          "<material name=\"red\"><color rgba=\"1 0 0 1\"/></material><material name=\"red\"><color rgba=\"red\"/></material>\n"
          "<link name=\"base\"><visual/><collision><geometry><capsule radius=\"x\"/><mesh scale=\"1 1 1 1\"/></geometry></collision></link>\n"),
      "<robot name=\"arm\">",
      "<robot version=\"7.3\" xmlns:xacro=\"http://www.ros.org/wiki/xacro\"><gazebo><plugin name=\"p\"><![CDATA[<x>]]></plugin></gazebo>"
      "<ros2_control name=\"c\"><joint name=\"none\"/></ros2_control>");
  const model::RobotTree t = model::tree_of(model::parse_urdf(dressed, "r.urdf")),
                         plain = model::tree_of(model::parse_urdf(kRobot, "r.urdf"));
  CHECK(t.notes.empty());
  CHECK(t.model.body(0).inertia_kgm2.xx == plain.model.body(0).inertia_kgm2.xx);
  CHECK_THAT(refused(with(dressed, "<mass value=\"1\"/>", "<mass value=\"one\"/>")),
             Contains("r.urdf:5: link 'lower'"));
}

TEST_CASE(
    "Joints that this tree does not have are held where nobody asks for them, and refused where somebody does") {
  for (const std::string type : {"floating", "planar", "spherical"}) {
    const std::string text = with(kRobot, "type=\"continuous\"", "type=\"" + type + "\"");
    const model::RobotTree t = model::tree_of(model::parse_urdf(text, "r.urdf"));
    REQUIRE(t.joints.size() == 1);
    CHECK(t.links[2].joint == 0);
    REQUIRE(t.notes.size() == 1);
    CHECK_THAT(t.notes[0], Contains("Held at 0: joint 'elbow' (" + type + ")"));
    CHECK_THAT(refused(text, {"shoulder", "elbow"}),
               Contains("joint 'elbow' is " + type + ", expected one that moves") &&
                   Contains("write joints = [\"shoulder\"]"));
  }
  CHECK_THAT(refused_with("type=\"continuous\"", "type=\"hinge\""),
             Contains("joint 'elbow' has the type 'hinge'"));
  CHECK_THAT(refused_with("type=\"continuous\"", "type=\"Continuous\""),
             Contains("did you mean 'continuous'"));
  CHECK_THAT(refused("<robot name=\"stone\"><link name=\"base\"/></robot>"), Contains("no joint that moves"));
}

TEST_CASE("Joints that follow each other are held, and the message says which line to write") {
  const std::string finger =
      "<link name=\"f1\"/><link name=\"f2\"/><joint name=\"finger\" type=\"prismatic\"><parent link=\"lower\"/><child link=\"f1\"/></joint>"
      "<joint name=\"finger2\" type=\"prismatic\"><parent link=\"lower\"/><child link=\"f2\"/><mimic joint=\"finger\"/></joint></robot>";
  const std::string text = with(kRobot, "</robot>", finger);
  CHECK(model::tree_of(model::parse_urdf(text, "r.urdf")).joints.size() == 2);
  for (const char* name : {"finger", "finger2"})
    CHECK_THAT(refused(text, {"shoulder", "elbow", name}),
               Contains("joint 'finger2' mimics 'finger'") &&
                   Contains("write joints = [\"shoulder\", \"elbow\"] in [model]"));
  const std::string unknown = with(text, "mimic joint=\"finger\"", "mimic joint=\"nowhere\"");
  const model::RobotTree t = model::tree_of(model::parse_urdf(unknown, "r.urdf"), {"shoulder", "elbow"});
  REQUIRE(t.notes.size() == 1);
  CHECK_THAT(t.notes[0], Contains("'finger2' ('nowhere')"));
  CHECK_THAT(refused(unknown, {"shoulder", "finger2"}),
             Contains("joint 'finger2' mimics 'nowhere', which is no joint of the robot"));
}

TEST_CASE("A xacro file is refused with what to do") {
  for (const std::string piece :
       {"<link name=\"tool\"><xacro:box m=\"1\"/></link>", "<xacro:include filename=\"a.xacro\"/>",
        "<link name=\"${prefix}tool\"/>",
        "<link name=\"tool\"><inertial><mass value=\"$(arg m)\"/></inertial></link>",
        "<include filename=\"a.xacro\"/>"})
    CHECK_THAT(refused_with("</robot>", piece + "</robot>"),
               Contains("r.urdf:7: ") && Contains("this is a xacro file") &&
                   Contains("expand it: xacro r.urdf > robot.urdf"));
  // The name space alone is left in files that were expanded.
  CHECK_NOTHROW(model::parse_urdf(
      with(kRobot, "<robot ", "<robot xmlns:xacro=\"http://ros.org/wiki/xacro\" "), "r.urdf"));
}

TEST_CASE("A closed loop is refused where it moves, and left out where it does not") {
  for (
      const std::string loop :
      {"<loop_joint name=\"l\" type=\"revolute\"><link1 link=\"lower\"/><link2 link=\"base\"/></loop_joint>",
       "<gazebo><joint name=\"l\" type=\"revolute\"><parent>base</parent><child>lower</child></joint></gazebo>",
       "<frame name=\"tip\" link=\"lower\"/><drake:linear_bushing_rpy><drake:bushing_frameA name=\"tip\"/><drake:bushing_frameC name=\"base\"/></drake:linear_bushing_rpy>"}) {
    const std::string text = with(kRobot, "</robot>", loop + "</robot>");
    CHECK_THAT(refused(text), Contains("r.urdf:7: ") && Contains("a closed loop is not supported"));
    // The shoulder alone moves the lower link against the base.
    CHECK_THAT(refused(text, {"shoulder"}), Contains("a closed loop is not supported"));
  }
  const std::string inner =
      "<loop_joint name=\"l\" type=\"revolute\"><link1 link=\"upper\"/><link2 link=\"lower\"/></loop_joint></robot>";
  CHECK_THAT(refused_with("</robot>", inner), Contains("(joints = [\"shoulder\"] in [model])"));
  const model::RobotTree t =
      model::tree_of(model::parse_urdf(with(kRobot, "</robot>", inner), "r.urdf"), {"shoulder"});
  REQUIRE(t.notes.size() == 1);
  CHECK_THAT(t.notes[0], Contains("<loop_joint> in line 7"));
}

TEST_CASE("Reductions, rotors and elements that nothing reads are named") {
  const std::string text = with(
      kRobot, "</robot>",
      "<transmission name=\"t\"><joint name=\"elbow\"/><actuator name=\"m\"><mechanicalReduction>-100</mechanicalReduction></actuator></transmission>\n"
      "<transmission name=\"u\"><joint name=\"shoulder\"/><actuator name=\"n\"><drake:rotor_inertia value=\"2e-5\"/><drake:gear_ratio value=\"50\"/></actuator></transmission>\n"
      "<spring_between link1=\"base\"/></robot>");
  const model::Urdf r = model::parse_urdf(text, "r.urdf");
  CHECK(r.joints[1].reduction == -100.0);
  CHECK(r.joints[0].reduction == 50.0);
  CHECK(r.joints[0].rotor_inertia_kgm2 == Approx(2e-5 * 2500.0));
  REQUIRE(r.notes.size() == 1);
  CHECK_THAT(r.notes[0], Contains("<spring_between> in line 9"));
  const model::RobotTree t = model::tree_of(r);
  REQUIRE(t.notes.size() == 1);
  CHECK_THAT(t.notes[0], Contains("'shoulder' (50) and 'elbow' (-100)"));
}

TEST_CASE(
    "An actuator's rotor is reflected by its reduction, and transmissions that are more than one are named") {
  const auto read = [](const std::string& what) {
    return model::parse_urdf(with(kRobot, "</robot>", what + "</robot>"), "r.urdf");
  };
  const model::Urdf r = read(
      "<transmission name=\"t\"><type>transmission_interface/FourBarLinkageTransmission</type><joint name=\"elbow\">"
      "<mechanicalReduction>60</mechanicalReduction></joint><actuator name=\"m\"><rotorInertia>2e-5</rotorInertia></actuator></transmission>");
  CHECK(r.joints[1].reduction == 60.0);
  CHECK(r.joints[1].rotor_inertia_kgm2 == Approx(2e-5 * 3600.0));
  REQUIRE(r.notes.size() == 1);
  CHECK_THAT(
      r.notes[0],
      Contains(
          "<transmission> of the type 'FourBarLinkageTransmission' (it does more than reduce) in line 7"));
  for (const std::string type : {"pr2_mechanism_model/SimpleTransmission",
                                 "transmission_interface/SimpleTransmission", "SimpleTransmission"}) {
    CAPTURE(type);
    CHECK(read("<transmission type=\"" + type + "\" name=\"t\"><joint name=\"elbow\"/></transmission>")
              .notes.empty());
    CHECK(read("<ros2_control name=\"c\"><transmission name=\"t\"><plugin>" + type +
               "</plugin><joint name=\"elbow\"/></transmission></ros2_control>")
              .notes.empty());
  }
  CHECK_THAT(read("<transmission type=\"pr2_mechanism_model/WristTransmission\" name=\"t\"/>").notes.at(0),
             Contains("'WristTransmission'"));
}

TEST_CASE("A reduction in a ros2_control block is that of its joint") {
  for (
      const std::string block :
      {"<transmission name=\"t\"><joint name=\"elbow\"><mechanical_reduction>30</mechanical_reduction></joint></transmission>",
       "<joint name=\"shoulder\"/><transmission name=\"t\"><joint name=\"elbow\"/><mechanicalReduction>30</mechanicalReduction></transmission>",
       "<joint name=\"elbow\"><param name=\"mechanical_reduction\">30</param></joint><joint name=\"none\"/>"}) {
    CAPTURE(block);
    const model::Urdf r = model::parse_urdf(
        with(kRobot, "</robot>", "<ros2_control name=\"c\">" + block + "</ros2_control></robot>"), "r.urdf");
    CHECK(r.joints[0].reduction == 0.0);
    CHECK(r.joints[1].reduction == 30.0);
    CHECK(r.notes.empty());
  }
}

TEST_CASE("A transmission that gives no joint of the robot a reduction is named") {
  const auto note = [](const std::string& what) {
    const model::Urdf r = model::parse_urdf(with(kRobot, "</robot>", what + "</robot>"), "r.urdf");
    CHECK(r.joints[0].reduction == 0.0);
    return r.notes.empty() ? std::string() : r.notes[0];
  };
  const auto transmission = [](const std::string& inner) {
    return "<transmission name=\"t\">" + inner + "</transmission>";
  };
  const std::string wheel = transmission("<joint name=\"wheel\"/>");
  CHECK_THAT(note(wheel), Contains("<transmission> of unknown joint 'wheel'"));
  CHECK_THAT(note("<ros2_control>" + wheel + "</ros2_control>"),
             Contains("<transmission> of unknown joint 'wheel'"));
  for (const std::string none : {"0", "0.0", "fifty", ""})
    CHECK_THAT(note(transmission("<joint name=\"shoulder\"><mechanicalReduction>" + none +
                                 "</mechanicalReduction></joint>")),
               Contains("<mechanicalReduction> '" + none + "' (no ratio) of joint 'shoulder'"));
  CHECK_THAT(note(transmission("<joint name=\"shoulder\"/><mechanicalReduction>0</mechanicalReduction>")),
             Contains("<mechanicalReduction> '0' (no ratio) in line 7"));
  CHECK_THAT(note(transmission("<joint name=\"shoulder\"/><drake:gear_ratio value=\"0\"/>")),
             Contains("<drake:gear_ratio> '0' (no ratio) in line 7"));
  CHECK_THAT(note(transmission("<joint/><mechanicalReduction>50</mechanicalReduction>")),
             Contains("a <transmission> of no joint in line 7"));
  CHECK_THAT(note(transmission("<mechanicalReduction>50</mechanicalReduction>")),
             Contains("a <transmission> of no joint in line 7"));
  CHECK_THAT(
      note(transmission(
          "<motor mechanicalReduction=\"60\"/><flexJoint mechanicalReduction=\"-1\" name=\"shoulder\"/>")),
      Contains("a <transmission> that couples joints in line 7"));
}

TEST_CASE("What a simulator's block says of a joint, or a spring between links, is named once") {
  const auto read = [](const std::string& what) {
    return model::parse_urdf(with(kRobot, "</robot>", what + "</robot>"), "r.urdf");
  };
  const model::Urdf ode = read(
      "<gazebo reference=\"elbow\"><physics><ode><friction>0.4</friction><spring_stiffness>8</spring_stiffness></ode></physics></gazebo>");
  CHECK(ode.joints[1].spring_nmprad == 8.0);
  const model::Urdf spring_at = read(
      "<gazebo reference=\"elbow\"><springReference>-0.4</springReference><springStiffness>8</springStiffness></gazebo>");
  CHECK(spring_at.joints[1].spring_nmprad == 8.0);
  CHECK(spring_at.joints[1].spring_rest_rad == -0.4);
  CHECK(spring_at.notes.empty());
  REQUIRE(ode.notes.size() == 1);
  CHECK_THAT(ode.notes[0], Contains("<friction> in <gazebo> of joint 'elbow'"));
  CHECK(read("<gazebo reference=\"elbow\"><physics><ode><friction>0</friction></ode></physics></gazebo>"
             "<gazebo reference=\"upper\"><friction>0.9</friction></gazebo>"
             "<gazebo><plugin name=\"p\"><friction>0.4</friction></plugin></gazebo>")
            .notes.empty());
  for (const std::string spring : {"linear_spring_damper", "drake:linear_spring_damper", "force_element"}) {
    const model::Urdf r =
        read("<" + spring + "><body name=\"base\"/><body name=\"lower\"/></" + spring + ">");
    CHECK(r.closures.empty());
    REQUIRE(r.notes.size() == 1);
    CHECK_THAT(r.notes[0], Contains("<" + spring + "> in line 7"));
  }
  std::string weightless;
  for (int i = 0; i < 42; ++i)
    weightless += "<gazebo reference=\"upper\"><turnGravityOff>true</turnGravityOff></gazebo>\n";
  const model::Urdf r = read(weightless + "<tendon/>");
  REQUIRE(r.notes.size() == 1);
  CHECK(
      r.notes[0] ==
      "The dynamics do not use <turnGravityOff> (no gravity) (42 times, first in line 7) and <tendon> in line 49 of the URDF.");
}

TEST_CASE("A floating or planar joint in [locked_joints] is told to be held without an entry") {
  for (const std::string type : {"floating", "planar"}) {
    const std::string text = with(kRobot, "type=\"continuous\"", "type=\"" + type + "\"");
    CHECK_THAT(refused(text, {}, {{"elbow", 0.0}}), Contains("joint 'elbow' is " + type) &&
                                                        Contains("held at 0 without an entry") &&
                                                        Contains("take it out of [locked_joints]"));
    CHECK_THAT(refused(text, {}, {{"elbow", 0.5}}), Contains("into its <origin>"));
  }
}

TEST_CASE("Inertias larger than the robot that are equal in all directions are named in one sentence") {
  // sqrt(1 kg m^2 / 1 kg) is 1 m, sqrt(1 / 2) is 0.71 m; the robot is 0.4 m long, from shoulder to elbow.
  std::string text = kRobot;
  std::size_t at = 0;
  while ((at = text.find("<inertia ", at)) != text.npos) {
    text.replace(at, text.find("/>", at) - at,
                 "<inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"");
    ++at;
  }
  const model::RobotTree t = model::tree_of(model::parse_urdf(text, "r.urdf"));
  REQUIRE(t.notes.size() == 1);
  CHECK_THAT(t.notes[0], Contains("'upper' (1 kg m^2 with") && Contains("'lower' (1 kg m^2 with") &&
                             Contains("0.71 m") && Contains("placeholders"));
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

TEST_CASE("A file that came in the place of a URDF is named with what to do") {
  for (const std::string page :
       {"\n\n<!DOCTYPE html>\n<html><head><meta charset=\"utf-8\"><title>r.urdf</title></head></html>",
        "<?xml version=\"1.0\"?><!-- a page --><HTML lang=\"en\"></HTML>", "<html>"}) {
    CAPTURE(page);
    CHECK_THAT(refused(page), Contains("a web page (HTML), expected a URDF") && Contains("\"Raw\""));
  }
  CHECK_THAT(refused("\n\n<!doctype HTML><p>"), Contains("r.urdf:3: a web page"));
  CHECK_THAT(refused("version https://git-lfs.github.com/spec/v1\noid sha256:00\nsize 12345\n"),
             Contains("git lfs pull"));
  CHECK_THAT(refused("404: Not Found"), Contains("the answer of a server that has no such file"));
  CHECK_THAT(refused("../urdf/arm.urdf\n"), Contains("nothing but a path, '../urdf/arm.urdf'"));
  CHECK_THAT(refused(" \n \n"), Contains("nothing but blanks") && Contains("copy the robot's file"));
  CHECK_THAT(refused(""), Contains("nothing but blanks"));
  CHECK_THAT(refused("<!--"), Contains("a comment has no end"));
  CHECK_THAT(refused("<COLLADA/>"), Contains("a mesh (COLLADA)"));
  CHECK_THAT(refused("<package><name>arm</name></package>"), Contains("a package's description"));
  CHECK_THAT(refused("<robot name=\"a\"><group name=\"arm\"/></robot>"), Contains("this is SRDF"));
  // A document type may stand before a robot.
  CHECK(model::parse_urdf("<!DOCTYPE robot>\n" + kRobot, "r.urdf").joints.size() == 2);
}

TEST_CASE("Names come out printable, whatever they hold") {
  const std::string name = "el\x1b[31mbow";
  CHECK_THAT(refused_with("name=\"elbow\" type=\"continuous\"", "name=\"" + name + "\" type=\"planar\""),
             Contains("a joint's name is 'el\\x1b[31mbow'"));
  CHECK_THAT(refused_with("<mass value=\"2\"/>", "<mass value=\"\x1b]0;x\"/>"), Contains("r.urdf"));
}

TEST_CASE("Files that are empty, too large or not there are refused") {
  const test::Folder folder;
  const std::string path = folder.file("robot.urdf");
  std::ofstream(path) << "";
  CHECK_THAT(
      test::error_message([&] { model::read_urdf(path); }),
      Contains("the file is empty; expected a robot (URDF)") && Contains("copy the robot's file here again"));
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
