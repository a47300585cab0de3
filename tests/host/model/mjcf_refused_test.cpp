// MJCF files with which something is wrong: one message each, with place and what to do; and what is assumed, in one note.
#include <catch2/catch.hpp>
#include <set>

#include "host/core/error.hpp"
#include "host/core/strict_toml.hpp"
#include "host/model/mjcf_reader.hpp"
#include "host/model/robot_file.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using Catch::Contains;

namespace {

model::MjcfFiles files(std::map<std::string, std::string> texts) {
  return [texts = std::move(texts)](const std::string& path) {
    const auto found = texts.find(path);
    if (found == texts.end()) throw core::DataError(path + ": no such file");
    return found->second;
  };
}
model::Urdf read(const std::string& text, std::map<std::string, std::string> included = {}) {
  return model::parse_mjcf(text, "robot.xml", files(std::move(included)));
}
std::string refused(const std::string& text, std::map<std::string, std::string> included = {}) {
  try {
    static_cast<void>(model::tree_of(read(text, std::move(included))));
  } catch (const core::DataError& e) {
    return e.what();
  }
  return "accepted";
}
/// Two links; `body` is within the second, `rest` beside the world.
std::string arm(const std::string& body, const std::string& rest = "") {
  return "<mujoco>\n<worldbody>\n<body name=\"upper\"><joint name=\"a\" axis=\"0 1 0\"/><geom size=\".05\"/>\n"
         "<body name=\"fore\" pos=\"0 0 .3\"><joint name=\"b\" axis=\"0 1 0\"/>\n" +
         body + "</body></body></worldbody>\n" + rest + "</mujoco>";
}
std::string ball(const std::string& attributes) {
  return arm("<geom size=\".05\"/><body name=\"tip\">\n<joint name=\"c\" " + attributes +
             "/><geom size=\".02\"/></body>");
}

}  // namespace

TEST_CASE("What an MJCF may not have is refused with file, line, element and what to do") {
  CHECK(refused(arm("<geom size=\".05\"/>")) == "accepted");
  CHECK_THAT(refused(ball("type=\"ball\"")),
             Contains("robot.xml:6: <joint name=\"c\"> is a ball joint; expected hinge or slide"));
  CHECK_THAT(refused(ball("type=\"free\"")),
             Contains("robot.xml:6: <joint name=\"c\"> is free within a moving body"));
  CHECK_THAT(refused(ball("type=\"hindge\"")), Contains("has type = 'hindge'; expected one of"));
  CHECK_THAT(refused(ball("damping=\"-1\"")), Contains("has damping = '-1'; expected at least 0"));
  CHECK_THAT(refused(ball("armature=\"1,5\"")), Contains("armature: '1,5' is no finite number"));
  CHECK_THAT(refused(ball("armature=\"nan\"")), Contains("is no finite number"));
  CHECK_THAT(refused(ball("axis=\"0 1\"")), Contains("has axis = '0 1'; expected 3 numbers"));
  CHECK_THAT(refused(ball("axis=\"0 0 0\"")), Contains("expected one that is not zero"));
  CHECK_THAT(refused(ball("springdamper=\"0.1 1\"")), Contains("stiffness and damping instead"));
  CHECK_THAT(refused(ball("class=\"stif\"")),
             Contains("is of the class 'stif', which no <default> has; expected one of main"));
}

TEST_CASE("A name that MJCF does not have is refused, with the nearest that it has") {
  CHECK_THAT(
      refused(ball("dampping=\"1\"")),
      Contains(
          "robot.xml:6: <joint name=\"c\"> has the attribute 'dampping', which MJCF does not have there (did "
          "you mean 'damping'?)"));
  CHECK_THAT(refused(arm("<geom size=\".05\"/><inertia mass=\"1\"/>")),
             Contains("robot.xml:5: <inertia> is no element that MJCF has here (did you mean 'inertial'?)"));
  CHECK_THAT(refused(arm("<geom size=\".05\"/>", "<tendons/>")), Contains("did you mean 'tendon'?"));
  CHECK_THAT(refused(arm("<geom size=\".05\"/>", "<option gravty=\"0 0 0\"/>")),
             Contains("<option> has the attribute 'gravty'") && Contains("'gravity'"));
  CHECK_THAT(refused(arm("<geom size=\".05\"/>", "<default><joint><geom/></joint></default>")),
             Contains("<geom> is no element that MJCF has here; expected none"));
  // A motor has no gain; its class may have one for position actuators.
  CHECK_THAT(refused(arm("<geom size=\".05\"/>", "<actuator><motor joint=\"a\" kp=\"3\"/></actuator>")),
             Contains("has the attribute 'kp'"));
  CHECK(refused(
            arm("<geom size=\".05\"/>",
                "<default><position kp=\"3\"/><pair gap=\"0\"/></default><visual><any thing=\"1\"/></visual>"
                "<sensor><jointpos joint=\"a\"/></sensor>")) == "accepted");
  CHECK_THAT(
      refused(arm("<geom size=\".05\"/>", "<actuator><motor joint=\"a\" armature=\".1\"/></actuator>")),
      Contains("expected it at the joint"));
}

TEST_CASE("An orientation that MuJoCo takes from the class is refused beside another form") {
  const auto geom = [](const std::string& of_class, const std::string& own) {
    return refused(arm("<geom type=\"box\" size=\".1 .1 .2\" " + own + "/>",
                       "<default><geom " + of_class + "/></default>"));
  };
  CHECK(geom("quat=\"1 0 0 1\"", "euler=\"0 0 10\"") == "accepted");
  CHECK(geom("euler=\"1 0 0\"", "euler=\"0 0 10\"") == "accepted");
  CHECK_THAT(geom("euler=\"1 0 0\"", "quat=\"1 0 0 1\""),
             Contains("robot.xml:5: <geom> has an orientation beside the euler of its default class") &&
                 Contains("expected one form in both: euler"));
  CHECK_THAT(geom("zaxis=\"1 0 0\"", "axisangle=\"1 0 0 1\""), Contains("beside the zaxis"));
}

TEST_CASE("Places beyond MuJoCo's largest number are refused, large ranges are not") {
  CHECK_THAT(refused(ball("pos=\"0 -1e300 0\"")),
             Contains("has pos = '0 -1e300 0'; expected numbers up to 1e10"));
  CHECK_THAT(refused(arm("<geom size=\"1e300\"/>")), Contains("expected numbers up to 1e10"));
  CHECK(refused(ball("range=\"-1e300 1e300\"")) == "accepted");
}

TEST_CASE("Constraints that join what moves are refused, and left out where nothing within them does") {
  const std::string body = "<geom size=\".05\"/><site name=\"s\"/>";
  CHECK_THAT(
      refused(arm(body, "<equality>\n<connect body1=\"fore\" anchor=\"0 0 1\"/></equality>")),
      Contains(
          "robot.xml:7: <connect> joins the links 'fore' and the world, which move against each other") &&
          Contains("hold the joints within the loop"));
  CHECK_THAT(refused(arm(body, "<equality><weld name=\"w\" body1=\"fore\" body2=\"upper\"/></equality>")),
             Contains("<weld name=\"w\"> joins the links 'fore' and 'upper'"));
  CHECK_THAT(refused(arm(body, "<equality><weld body1=\"fore\" body2=\"uper\"/></equality>")),
             Contains("has body2 = 'uper', which the file does not have"));
  CHECK_THAT(refused(arm(body, "<equality><joint joint1=\"a\"/></equality>")),
             Contains("<joint> joins the links"));
  CHECK_THAT(refused(arm(body, "<equality><joint joint1=\"a\" joint2=\"b\"/></equality>")),
             Contains("no joint that moves by itself"));
  CHECK_THAT(refused(arm(body, "<equality><flexvert flex=\"f\"/></equality>")),
             Contains("<flexvert> is an equality constraint"));
  // All of them at once, and the joints that would do for all.
  CHECK_THAT(refused(arm(body + "<body><joint name=\"c\"/><geom size=\".1\"/></body>",
                         "<equality>\n<connect body1=\"fore\" body2=\"upper\" anchor=\"0 0 1\"/></equality>"
                         "<tendon>\n<fixed name=\"t\"><joint joint=\"a\" coef=\"1\"/></fixed></tendon>")),
             Contains("joints = [\"c\"]") && Contains("so with <fixed name=\"t\"> in line 8"));
  CHECK(refused(arm(body, "<equality><weld body1=\"fore\" active=\"false\"/></equality>")) == "accepted");
  CHECK_THAT(refused(arm(body, "<tendon><fixed name=\"t\"><joint joint=\"a\" coef=\"1\"/></fixed></tendon>")),
             Contains("<fixed name=\"t\"> joins the links 'world' and 'upper'") &&
                 Contains("a tendon is not supported"));
  CHECK_THAT(refused(arm(body,
                         "<worldbody><site name=\"o\"/></worldbody><tendon><spatial><site site=\"s\"/><site "
                         "site=\"o\"/></spatial></tendon>")),
             Contains("<spatial> joins the links 'fore' and 'world', which move against each other"));
  const model::Urdf robot =
      read(arm(body, "<tendon><fixed name=\"t\"><joint joint=\"b\" coef=\"1\"/></fixed></tendon>"));
  const model::RobotTree held = model::tree_of(robot, {"a"});
  CHECK(held.joints.size() == 1);
  CHECK_THAT(held.notes.at(0), Contains("left out"));
}

TEST_CASE("Masses that are not known are refused") {
  const auto body = [](const std::string& inside) { return refused(arm(inside)); };
  CHECK_THAT(body("<geom name=\"m\" type=\"mesh\" mesh=\"x\"/>"),
             Contains("robot.xml:5: <geom name=\"m\"> is a mesh") &&
                 Contains("expected an <inertial>", Catch::CaseSensitive::No));
  CHECK(body("<geom type=\"mesh\" mesh=\"x\" mass=\"0\"/><geom size=\".1\"/>") == "accepted");
  CHECK(
      body(
          "<geom type=\"mesh\" mesh=\"x\"/><inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\".01 .01 .01\"/>") ==
      "accepted");
  CHECK_THAT(body("<inertial pos=\"0 0 0\" diaginertia=\"1 1 1\"/>"), Contains("<inertial> has no mass"));
  CHECK_THAT(body("<inertial mass=\"1\" diaginertia=\"1 1 1\"/>"), Contains("<inertial> has no pos"));
  CHECK_THAT(body("<inertial pos=\"0 0 0\" mass=\"1\" diaginertia=\".01 .01 .03\"/>"),
             Contains("which no body has") && Contains("balanceinertia"));
  CHECK_THAT(body("<inertial pos=\"0 0 0\" mass=\"1\" fullinertia=\"1 1 1 0 0 0\" quat=\"1 1 0 0\"/>"),
             Contains("fullinertia alone"));
  CHECK_THAT(body("<geom type=\"box\" size=\"1 1\"/>"), Contains("a box needs 3"));
  CHECK_THAT(body("<geom type=\"capsule\" fromto=\"0 0 0 0 0 0\" size=\".1\"/>"),
             Contains("two points that are apart"));
  CHECK_THAT(body("<geom size=\"0\"/>"), Contains("expected numbers above 0"));
  CHECK_THAT(body("<geom size=\".1\" quat=\"1 0 0 0\" euler=\"0 0 1\"/>"),
             Contains("more than one orientation"));
  CHECK_THAT(body("<geom size=\".1\" shellinertia=\"true\"/>"), Contains("is a shell"));
}

TEST_CASE("What makes bodies or forces that are not in the file is refused") {
  for (const std::string tag : {"composite", "flexcomp", "replicate", "attach"})
    CHECK_THAT(refused(arm("<geom size=\".05\"/><" + tag + "/>")), Contains("mj_saveLastXML"));
  CHECK_THAT(refused(arm("<geom size=\".05\"/><plugin plugin=\"x\"/>")), Contains("take it out of the file"));
  CHECK_THAT(refused(arm("<geom size=\".05\"/>", "<actuator>\n<motor site=\"s\"/></actuator>")),
             Contains("robot.xml:7: <motor> acts on a site"));
  CHECK_THAT(refused(arm("<geom size=\".05\"/>", "<actuator><motor joint=\"aa\"/></actuator>")),
             Contains("acts on the joint 'aa'; expected one of a, b") && Contains("did you mean"));
  CHECK_THAT(refused(arm("<geom size=\".05\"/>",
                         "<actuator><position joint=\"a\" kp=\"1\" dampratio=\"1\"/></actuator>")),
             Contains("kv instead"));
  CHECK_THAT(refused("<mujoco/>"), Contains("has no <worldbody>"));
  CHECK_THAT(refused("<mujoco><worldbody/></mujoco>"), Contains("no joint that moves"));
  CHECK_THAT(refused("<mujoco><compiler eulerseq=\"xyw\"/><worldbody/></mujoco>"),
             Contains("three letters of xyzXYZ"));
}

TEST_CASE("Included files are named in messages, and each is read once") {
  const std::string main =
      "<mujoco>\n<include file=\"parts/arm.xml\"/><worldbody><body name=\"x\"><joint/><geom size=\".1\"/></body></worldbody></mujoco>";
  CHECK(refused(main, {{"parts/arm.xml", "<a><option gravity=\"0 0 -1\"/></a>"}}) == "accepted");
  CHECK_THAT(refused(main),
             Contains("robot.xml:2: <include> names a file that cannot be read: parts/arm.xml"));
  CHECK_THAT(refused(main, {{"parts/arm.xml", "<a>\n\n<option gravity=\"0 0\"/></a>"}}),
             Contains("parts/arm.xml:3: <option> has gravity"));
  CHECK_THAT(refused(main, {{"parts/arm.xml", "<a><include file=\"parts/arm.xml\"/></a>"}}),
             Contains("included already"));
  CHECK_THAT(refused("<mujoco><include/></mujoco>"), Contains("names no file"));
}

TEST_CASE("What was assumed of an MJCF is one note") {
  const model::Urdf robot = model::read_robot(test::source("tests/host/model/mjcf/arm.xml"));
  REQUIRE(robot.notes.size() == 1);
  CHECK(
      robot.notes[0] ==
      "Read as MJCF: contacts and joint ranges exert no force; torques in recordings are at the joint: 'joint2' (101 "
      "ctrl); position and velocity actuators are one drive, its target velocity zero: joint 'joint1'; a velocity "
      "actuator counts as a torque, which recordings have at the joint: joint 'joint3'; an actuator with a law of its "
      "own counts as a torque, which recordings have at the joint: a5; no actuator moves joint 'joint6'.");
}

TEST_CASE("Actuators of an MJCF are drives at the joint") {
  using Actuator = model::UrdfJoint::Actuator;
  const model::Urdf robot = model::read_robot(test::source("tests/host/model/mjcf/branched.xml"));
  const auto joint = [&](const std::string& name) {
    for (const model::UrdfJoint& j : robot.joints)
      if (j.name == name) return j;
    throw std::runtime_error(name);
  };
  CHECK(joint("lift").actuator == Actuator::torque);
  CHECK(joint("left_hip").actuator == Actuator::position);
  CHECK(joint("left_hip").kp_nmprad == 30.0);
  CHECK(joint("left_hip").kd_nmsprad == 2.0);
  // A gear of 3: force 5 (u - 3 q), torque 3 times that.
  CHECK(joint("right_hip").kp_nmprad == 45.0);
  CHECK(joint("right_hip").kd_nmsprad == 0.0);
  CHECK(joint("right_knee").actuator == Actuator::none);
  CHECK(joint("lift").limits == std::nullopt);
}

TEST_CASE("A torn MJCF, and one with other words in it, is read or refused, and nothing else") {
  for (const char* name : {"planar_root", "inertials", "branched", "arm", "floating"}) {
    const std::string whole =
        core::read_small_file(test::source("tests/host/model/mjcf/" + std::string(name) + ".xml"), "");
    std::size_t refusals = 0;
    const auto attempt = [&](const std::string& text) {
      const std::string what = refused(text);
      if (what == "accepted") return;
      ++refusals;
      CHECK(what.find_first_of("\n\x1b") == std::string::npos);
    };
    for (std::size_t n = 0; n < whole.size(); n += 7) attempt(whole.substr(0, n));
    CHECK(refusals > whole.size() / 8);
    for (const char* word : {"joint", "body", "geom", "pos", "0", "\"", ">", "/", "axis"})
      for (const char* by : {"", "x", "1e999", "-", "<", "default", "freejoint", "\x01"})
        for (std::size_t at = whole.find(word); at != std::string::npos; at = whole.find(word, at + 61)) {
          std::string text = whole;
          attempt(text.replace(at, std::string(word).size(), by));
        }
  }
}
