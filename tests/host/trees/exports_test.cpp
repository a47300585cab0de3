// URDF and MJCF with the causes of a diagnosis: what changes, what stays, and that it reads back as the tree that was fitted.
#include "host/trees/exports.hpp"

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "furcula/dynamics/tree/forward_dynamics.hpp"
#include "host/core/error.hpp"
#include "host/core/strict_toml.hpp"
#include "host/model/robot_file.hpp"
#include "host/model/xml_check.hpp"
#include "host/trees/run.hpp"
#include "tests/folder.hpp"
#include "tests/host/model/mujoco_peer.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace furcula;
using Catch::Contains;
using trees::Effect;

namespace {

using test::Folder;

/// A diagnosis of this robot with nothing found yet. `settings` are the model file's sections, those of [model] first.
trees::Diagnosis diagnosis_of(const Folder& folder, const std::string& urdf,
                              const std::string& settings = "") {
  folder.write("robot.urdf", urdf);
  folder.write("model.toml", "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"robot.urdf\"\n" + settings);
  trees::Diagnosis d;
  d.model = trees::read_tree_model(folder.file("model.toml"));
  d.refitted = d.extended = {d.model.drives, d.model.causes};
  return d;
}

std::string robot(const std::string& name) {
  return core::read_small_file(test::source("tests/host/model/robots/" + name + ".urdf"), "a robot");
}

std::vector<std::string> lines(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

/// Without the comment that was put in.
std::string without_comment(std::string text) {
  const std::size_t at = text.find("<!--\n  The robot with what"), end = text.find("-->\n", at);
  REQUIRE(end != std::string::npos);
  return text.erase(at, end + 4 - at);
}

std::size_t link(const trees::TreeModel& m, const std::string& name) {
  for (std::size_t i = 0; i < m.robot.links.size(); ++i)
    if (m.robot.links[i].name == name) return i;
  FAIL("no link " + name);
  return 0;
}

void check_same(const dynamics::tree::Inertia<double>& a, const dynamics::tree::Inertia<double>& b) {
  const auto near = [](double value) { return Approx(value).epsilon(1e-12).margin(1e-14); };
  CHECK(a.mass_kg == near(b.mass_kg));
  CHECK(a.moment_kgm.x == near(b.moment_kgm.x));
  CHECK(a.moment_kgm.y == near(b.moment_kgm.y));
  CHECK(a.moment_kgm.z == near(b.moment_kgm.z));
  CHECK(a.inertia_kgm2.xx == near(b.inertia_kgm2.xx));
  CHECK(a.inertia_kgm2.xy == near(b.inertia_kgm2.xy));
  CHECK(a.inertia_kgm2.xz == near(b.inertia_kgm2.xz));
  CHECK(a.inertia_kgm2.yy == near(b.inertia_kgm2.yy));
  CHECK(a.inertia_kgm2.yz == near(b.inertia_kgm2.yz));
  CHECK(a.inertia_kgm2.zz == near(b.inertia_kgm2.zz));
}

/// Whether the URDF that is written reads back as the tree that runs with these causes.
void check_reads_back(const trees::Diagnosis& d) {
  const std::string text = trees::extended_urdf(d);
  const model::RobotTree back =
      model::tree_of(model::parse_urdf(text, "extended"), d.model.moving, d.model.hold);
  const trees::Setup setup = trees::SetupMaker(d.model).make(d.extended);
  REQUIRE(back.joints.size() == d.model.joints());
  for (std::size_t i = 0; i < back.joints.size(); ++i) {
    INFO(back.joints[i].name);
    CHECK(back.joints[i].name == d.model.robot.joints[i].name);
    check_same(back.model.body(i), setup.model.body(i));
    CHECK(back.model.laws[i].damping_nmspr == setup.model.laws[i].damping_nmspr);
    CHECK(back.model.laws[i].friction_nm == setup.model.laws[i].friction_nm);
  }
}

/// Links without <origin>, joints without <dynamics>, quotes of both sorts, entities, a comment that looks like an element.
constexpr const char* kOdd = R"(<?xml version="1.0"?>
<!-- <joint name="elbow"> is not one -->
<robot name='odd'  >
  <link name="base"/>
  <link name="a&amp;b">
    <visual><geometry><box size="1 1 1"/></geometry></visual>
    <inertial>
      <mass   value = '2'/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/>
    </inertial>
  </link>
  <link name="rod"><inertial><origin rpy="0 0 0" xyz="0 0 -0.2"/><mass value="0.4"/><inertia ixx="0.003" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.0002"/></inertial></link>
  <joint name="&#60;b&gt;--&quot;" type="continuous">
    <parent link="base"/>
    <child link="a&amp;b"/><axis xyz="0 1 0"/>
  </joint>
  <joint name="elbow" type="continuous">
    <parent link="a&amp;b"/><child link="rod"/>
    <origin xyz="0.3 0 0"/> <axis xyz="0 1 0"/>
    <dynamics   friction='0.05'/>
  </joint>
  <transmission name="t"><joint name="elbow"/></transmission>
</robot>
)";

}  // namespace

TEST_CASE("The URDF with causes differs from the given one in their numbers alone") {
  const Folder folder;
  trees::Diagnosis d = diagnosis_of(folder, kOdd);
  // A point of 0.1 kg at -0.4 m on a rod of 0.4 kg at -0.2 m: together 0.5 kg at -0.24 m, and about it
  // 0.003 + 0.4 * 0.04^2 + 0.1 * 0.16^2 = 0.0062 kg m^2.
  d.extended.causes = {{Effect::coulomb_friction, {0, 1}, {0.25}},
                       {Effect::damping_error, {1}, {0.125}},
                       {Effect::com_error, {link(d.model, "a&b")}, {0.5, 0.0, -0.25}},
                       {Effect::payload, {link(d.model, "rod")}, {0.1, 0.0, 0.0, -0.4}}};
  const std::string text = trees::extended_urdf(d);
  const std::vector<std::string> before = lines(kOdd), after = lines(without_comment(text));
  std::vector<std::string> gone, added;
  for (const std::string& line : before)
    if (std::find(after.begin(), after.end(), line) == after.end()) gone.push_back(line);
  for (const std::string& line : after)
    if (std::find(before.begin(), before.end(), line) == before.end()) added.push_back(line);
  REQUIRE(gone.size() == 2);
  CHECK_THAT(gone[0], Contains("\"rod\""));
  CHECK_THAT(gone[1], Contains("<dynamics   friction='0.05'/>"));
  REQUIRE(added.size() == 4);
  CHECK(added[0] == "      <origin xyz=\"0.5 0 -0.25\"/>");
  CHECK_THAT(added[2], Contains("    <dynamics damping=\"0\" friction=\"0.25\"/>"));
  CHECK(added[3] == "    <dynamics damping=\"0.125\"   friction='0.3'/>");

  const model::Urdf back = model::parse_urdf(text, "back");
  const auto& rod = *back.links[link(d.model, "rod")].inertia;
  CHECK(rod.mass_kg == Approx(0.5));
  CHECK(rod.frame.at.z == Approx(-0.24));
  CHECK(rod.about_centre_kgm2.xx == Approx(0.0062));
  CHECK(rod.about_centre_kgm2.zz == Approx(0.0002));
  check_reads_back(d);
}

TEST_CASE("Without a cause the URDF is the given one with a comment") {
  const Folder folder;
  for (const std::string& text : {std::string(kOdd), robot("branched"), "\xef\xbb\xbf" + robot("arm")}) {
    const trees::Diagnosis d = diagnosis_of(folder, text);
    const std::string written = trees::extended_urdf(d);
    CHECK(without_comment(written) == text);
    CHECK_THAT(written, Contains("Nothing is changed."));
    CHECK_NOTHROW(model::parse_urdf(written, "back"));
  }
}

TEST_CASE("Lines that end in CR LF keep their ends, and new ones have them too") {
  const Folder folder;
  std::string text;
  for (const char* c = kOdd; *c != '\0'; ++c) text += *c == '\n' ? std::string("\r\n") : std::string(1, *c);
  trees::Diagnosis d = diagnosis_of(folder, text);
  d.extended.causes = {{Effect::com_error, {link(d.model, "a&b")}, {0.5, 0.0, 0.0}}};
  const std::string written = without_comment(trees::extended_urdf(d));
  CHECK_THAT(written, Contains("\r\n      <origin xyz=\"0.5 0 0\"/>\r\n      <mass"));
}

TEST_CASE("The URDF says what was changed and why, and what it cannot hold") {
  const Folder folder;
  trees::Diagnosis d = diagnosis_of(folder, kOdd,
                                    "[drive.elbow]\nrotor_inertia_kgm2 = 0.0125\ndamping_nmspr = 0.5\n"
                                    "[effect.mass_error.rod]\nmass_kg = 0.5\n");
  d.extended.causes.push_back({Effect::coulomb_friction, {1}, {0.25}});
  d.extended.causes.push_back({Effect::actuator_delay, {0}, {0.012}});
  d.extended.causes.push_back({Effect::stribeck_friction, {0}, {0.1, 0.2, 0.05}});
  trees::Finding f;
  f.cause = d.extended.causes[1];
  f.confidence = 0.98;
  d.findings.push_back(f);
  const std::string text = trees::extended_urdf(d);
  CHECK_THAT(
      text,
      Contains(
          "joint elbow, friction: 0.05 -> 0.3 N m: coulomb_friction@elbow, a finding of confidence 0.98"));
  CHECK_THAT(text, Contains("joint elbow, damping: 0 -> 0.5 N m s/rad: [drive] of the model file"));
  CHECK_THAT(text, Contains("link rod, mass: 0.4 -> 0.5 kg: mass_error@rod, an effect of the model file"));
  CHECK_THAT(text, Contains("joint <b>- -\", friction: 0 -> 0.1 N m: stribeck_friction"));
  CHECK_THAT(text, Contains("actuator_delay@<b>- -\" (delay_s 0.012 s): not in the file"));
  CHECK_THAT(text, Contains("static_torque_nm 0.2 N m") && Contains("its rise towards rest is not"));
  CHECK_THAT(text, Contains("[drive] of elbow: rotor inertia 0.0125 kg m^2"));
  CHECK(text.starts_with("<?xml version=\"1.0\"?>\n<!--\n"));
  CHECK_NOTHROW(model::check_xml(text, "urdf"));
  CHECK_NOTHROW(model::parse_urdf(text, "urdf"));
}

TEST_CASE("A mass that is fitted to nothing stays as it was, since no URDF reads with it") {
  const Folder folder;
  trees::Diagnosis d = diagnosis_of(folder, kOdd);
  d.extended.causes = {{Effect::mass_error, {link(d.model, "rod")}, {0.0}}};
  const std::string text = trees::extended_urdf(d);
  CHECK_THAT(text, Contains("mass_error@rod (mass_kg 0 kg): a link that moves has both above 0"));
  CHECK(model::parse_urdf(text, "urdf").links[link(d.model, "rod")].inertia->mass_kg == 0.4);
}

TEST_CASE("A robot whose file has changed since is refused by name") {
  const Folder folder;
  trees::Diagnosis d = diagnosis_of(folder, kOdd);
  d.extended.causes = {{Effect::coulomb_friction, {1}, {0.25}}};
  std::string other = kOdd;
  other.replace(other.find("name=\"elbow\" type"), 12, "name=\"wrist\"");
  folder.write("robot.urdf", other);
  CHECK_THROWS_WITH(trees::extended_urdf(d), Contains("robot.urdf: no joint 'elbow'"));
}

TEST_CASE("The URDF with causes at random reads back as the tree that runs with them") {
  const Folder folder;
  std::mt19937 random(11);
  const auto within = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  for (const char* name : {"double_pendulum", "arm", "branched"})
    for (int n = 0; n < 30; ++n) {
      const bool holds = n % 3 == 0 && std::string(name) == "branched";
      trees::Diagnosis d = diagnosis_of(
          folder, robot(name),
          holds ? "joints = [\"waist\", \"left_elbow\"]\n[locked_joints]\nleft_shoulder = 0.4\n" : "");
      for (trees::Drive& drive : d.extended.drives) drive.damping_nmspr = within(0.0, 1.0);
      const auto joint = [&] {
        return static_cast<std::size_t>(within(0.0, static_cast<double>(d.model.joints()) - 1e-9));
      };
      const std::vector<std::size_t> links = trees::sites(d.model, trees::LocationType::link);
      const auto body = [&] {
        return links[static_cast<std::size_t>(within(0.0, static_cast<double>(links.size()) - 1e-9))];
      };
      d.extended.causes = {
          {Effect::payload,
           {body()},
           {within(0.0, 1.0), within(-0.3, 0.3), within(-0.3, 0.3), within(-0.3, 0.3)}},
          {Effect::coulomb_friction, {joint()}, {within(0.0, 1.0)}},
          {Effect::damping_error, {joint()}, {within(0.0, 1.0)}},
          {Effect::mass_error, {body()}, {within(0.1, 3.0)}},
          {Effect::com_error, {body()}, {within(-0.1, 0.1), within(-0.1, 0.1), within(-0.1, 0.1)}},
          {Effect::inertia_error, {body()}, {within(0.5, 2.0)}},
          {Effect::payload,
           {body()},
           {within(0.0, 1.0), within(-0.3, 0.3), within(-0.3, 0.3), within(-0.3, 0.3)}}};
      INFO(name << ", " << n);
      check_reads_back(d);
    }
}

TEST_CASE("The MJCF has the drives' gains as actuators, and a comment for what it does not hold") {
  const Folder folder;
  trees::Diagnosis d =
      diagnosis_of(folder, kOdd,
                   "[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 40.0\nkd_nmsprad = 2.0\n"
                   "rotor_inertia_kgm2 = 0.0125\ndamping_nmspr = 0.5\n");
  d.extended.causes = {{Effect::torque_gain_error, {1}, {0.5}},
                       {Effect::asymmetric_friction, {1}, {0.2, 0.4}},
                       {Effect::actuator_delay, {0}, {0.012}}};
  const std::string text = trees::extended_mjcf(d);
  CHECK_NOTHROW(model::check_xml(text, "mjcf"));
  // Half of the torque: half of both gains. Friction 0.05 in the file, and the mean of 0.2 and 0.4.
  CHECK_THAT(text, Contains("gainprm=\"20\" biasprm=\"0 -20 -1\""));
  CHECK_THAT(text, Contains("gainprm=\"40\" biasprm=\"0 -40 -2\""));
  CHECK_THAT(text, Contains("armature=\"0.0125\" damping=\"0.5\" frictionloss=\"0.35\"") ||
                       Contains("armature=\"0.0125\" damping=\"0.5\" frictionloss=\"0.35000000000000003\""));
  CHECK_THAT(text, !Contains("stiffness="));
  CHECK_THAT(text, Contains("actuator_delay@<b>- -\" (delay_s 0.012 s): not in the file"));
  CHECK_THAT(text, Contains("the mean of both directions is in the file"));
  CHECK_THAT(text, !Contains("torque_gain_error@elbow (gain 0.5): not"));
}

#ifndef FURCULA_MUJOCO
TEST_CASE("MuJoCo reads the MJCF with causes, and moves as the tree") {
  test::skip("libmujoco-dev is not installed");
}
#else
TEST_CASE("MuJoCo reads the MJCF with causes, and moves as the tree") {
  const Folder folder;
  for (const char* law : {"torque", "position"}) {
    trees::Diagnosis d =
        diagnosis_of(folder, robot("branched"),
                     std::string("[drive]\ncontrol_mode = \"") + law +
                         "\"\nkp_nmprad = 30.0\nkd_nmsprad = 2.0\nrotor_inertia_kgm2 = 0.02\n");
    d.extended.causes = {{Effect::base_tilt, {0}, {0.1, -0.2}},
                         {Effect::payload, {link(d.model, "left_hand")}, {0.5, 0.1, 0.0, 0.05}},
                         {Effect::com_error, {link(d.model, "trunk")}, {0.02, 0.0, 0.05}},
                         {Effect::inertia_error, {link(d.model, "right_lower")}, {1.5}},
                         {Effect::rotor_inertia_error, {2}, {0.05}},
                         {Effect::damping_error, {1}, {0.7}},
                         {Effect::coulomb_friction, {4}, {0.3}}};
    if (law == std::string("position"))
      d.extended.causes.push_back({Effect::position_gain_error, {5}, {50.0, 1.0}});
    const trees::Setup setup = trees::SetupMaker(d.model).make(d.extended);
    const test::MujocoPeer peer(trees::extended_mjcf(d));
    REQUIRE(peer.model().nv == static_cast<int>(d.model.joints()));
    std::mt19937 random(7);
    const auto within = [&](double most) {
      return std::uniform_real_distribution<double>(-most, most)(random);
    };
    double worst = 0.0, most = 0.0;
    for (int n = 0; n < 100; ++n) {
      model::RobotModel tree = setup.model;
      model::RobotModel::Joints q{}, v{}, tau{};
      for (std::size_t i = 0; i < d.model.joints(); ++i) {
        const std::size_t k = peer.place(d.model.robot.joints[i].name);
        q[i] = peer.data().qpos[k] = within(1.0);
        v[i] = peer.data().qvel[k] = within(3.0);
        const double input = within(1.0);
        peer.data().ctrl[mj_name2id(&peer.model(), mjOBJ_ACTUATOR, d.model.robot.joints[i].name.c_str())] =
            input;
        // The law of a position drive is a spring to the set point in the tree that runs.
        if (setup.joints[i].law == trees::ControlMode::position)
          tree.laws[i].rest_rad = input;
        else
          tau[i] = input;
        CHECK(peer.model().dof_frictionloss[k] == Approx(i == 4 ? 0.3 : 0.0).margin(1e-15));
      }
      peer.forward();
      const auto a = dynamics::tree::accelerations(tree, q, v, tau);
      for (std::size_t i = 0; i < d.model.joints(); ++i) {
        const double theirs = peer.data().qacc[peer.place(d.model.robot.joints[i].name)];
        worst = std::max(worst, std::abs(theirs - a[i]));
        most = std::max(most, std::abs(theirs));
      }
    }
    INFO(law);
    // What MuJoCo's principal axes give back of a matrix (docs/results.md) allows 1e-6.
    CHECK(worst < 1e-6 * most);
    CHECK(most > 1.0);
  }
}
#endif

namespace {

constexpr const char* kShapes = R"(<mujoco model="shapes">
  <compiler angle="degree"/>
  <!-- what a person wrote -->
  <default><joint damping="0.1"/><geom rgba="1 0 0 1"/></default>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 .1"/>
    <body name="upper" pos="0 0 1">
      <joint name="hip" axis="0 1 0" armature="0.02" limited="true" range="-90 90"/>
      <geom name="thigh" type="capsule" fromto="0 0 0 0 0 -.3" size=".04"/>
      <body name="lower" pos="0 0 -.3">
        <joint name="knee" axis="0 1 0"/>
        <geom name="shank" type="box" size=".03 .03 .15" pos="0 0 -.15"/>
        <inertial pos="0 0 -.12" mass="0.8" diaginertia=".01 .01 .001"/>
      </body>
    </body>
  </worldbody>
  <actuator><motor name="m1" joint="hip"/><motor name="m2" joint="knee"/></actuator>
</mujoco>
)";

trees::Diagnosis diagnosis_of_mjcf(const Folder& folder, const std::string& text) {
  folder.write("robot.xml", text);
  folder.write("model.toml", "[model]\nkind = \"tree\"\nschema = 1\nmjcf = \"robot.xml\"\n");
  trees::Diagnosis d;
  d.model = trees::read_tree_model(folder.file("model.toml"));
  d.refitted = d.extended = {d.model.drives, d.model.causes};
  d.extended.causes = {{Effect::coulomb_friction, {1}, {0.25}},
                       {Effect::damping_error, {0}, {0.5}},
                       {Effect::rotor_inertia_error, {1}, {0.03}},
                       {Effect::payload, {link(d.model, "lower")}, {0.2, 0.0, 0.0, -0.3}}};
  return d;
}

}  // namespace

TEST_CASE("The extended MJCF is the user's with changed attributes: its shapes and comments stay") {
  const Folder folder;
  const trees::Diagnosis d = diagnosis_of_mjcf(folder, kShapes);
  const std::string text = trees::extended_mjcf(d);
  INFO(text);
  CHECK_THAT(text, Contains("<!-- what a person wrote -->") && Contains("name=\"thigh\"") &&
                       Contains("name=\"floor\"") && Contains("range=\"-90 90\"") &&
                       Contains("<motor name=\"m2\" joint=\"knee\"/>") && Contains("armature=\"0.02\""));
  const std::vector<std::string> before = lines(kShapes), after = lines(without_comment(text));
  std::size_t changed = 0;
  REQUIRE(before.size() == after.size());
  for (std::size_t i = 0; i < before.size(); ++i) changed += before[i] == after[i] ? 0 : 1;
  CHECK(changed == 3);  // two joints and an <inertial>
  const model::Urdf back = model::parse_robot(text, "extended.mjcf.xml");
  // 0.8 kg at -0.12 m and 0.2 kg at -0.3 m are 1 kg at -0.156 m; about it 0.01 + 0.8 * 0.036^2 + 0.2 * 0.144^2.
  const auto& lower = *back.links[link(d.model, "lower")].inertia;
  CHECK(lower.mass_kg == Approx(1.0));
  CHECK(lower.frame.at.z == Approx(-0.156));
  CHECK(lower.about_centre_kgm2.xx == Approx(0.01 + 0.8 * 0.036 * 0.036 + 0.2 * 0.144 * 0.144));
#ifdef FURCULA_MUJOCO
  const test::MujocoPeer peer(text);
  CHECK(peer.model().ngeom == 3);
  CHECK(peer.model().dof_damping[0] == 0.5);
  CHECK(peer.model().dof_frictionloss[1] == 0.25);
  CHECK(peer.model().dof_armature[1] == 0.03);
  CHECK(peer.model().body_mass[2] == Approx(1.0));
#endif
}

TEST_CASE("An MJCF that cannot be changed in place is written anew") {
  const Folder folder;
  std::string masses_from_shapes = kShapes;
  masses_from_shapes.replace(masses_from_shapes.find("angle="), 0, "inertiafromgeom=\"true\" ");
  std::string nameless = kShapes;
  nameless.erase(nameless.find("name=\"knee\" "), 12);
  nameless.erase(nameless.find("<motor name=\"m2\" joint=\"knee\"/>"), 31);
  for (const std::string& text : {masses_from_shapes, nameless}) {
    const std::string out = trees::extended_mjcf(diagnosis_of_mjcf(folder, text));
    INFO(out);
    CHECK(out.find("floor") == std::string::npos);
    CHECK(model::tree_of(model::parse_robot(out, "extended.mjcf.xml")).joints.size() == 2);
  }
}

TEST_CASE("A URDF made of an MJCF has the armatures, and reads back with them") {
  const Folder folder;
  const trees::Diagnosis d = diagnosis_of_mjcf(folder, kShapes);
  const model::Urdf back = model::parse_urdf(trees::extended_urdf(d), "extended.urdf");
  CHECK(back.joints[0].rotor_inertia_kgm2 == 0.02);
  CHECK(back.joints[1].rotor_inertia_kgm2 == 0.03);
}
