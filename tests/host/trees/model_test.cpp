// Model files of robots of several joints: what they say, what is refused, what is written.
#include "host/trees/model.hpp"

#include "host/trees/run.hpp"
#include "tests/host/error_message.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using Catch::Contains;
using trees::ControlMode;
using trees::Effect;
using trees::LocationType;

namespace {

std::string refused(const std::string& settings, const std::string& urdf = "model/robots/branched.urdf") {
  return test::error_message([&] { test::robot(urdf, settings); });
}
std::string refused_text(const std::string& text) {
  return test::error_message(
      [&] { trees::parse_tree_model(text, test::source("tests/host/model/robots/robot.toml")); });
}

const char* const kAll = R"(base = "fixed"
joints = ["left_shoulder", "left_elbow", "left_reach"]
gravity_mps2 = [0.0, 1.5, -9.7]
[drive]
damping_nmspr = 0.2
[drive.left_elbow]
control_mode = "position"
kp_nmprad = 30.0
kd_nmsprad = 1.25
rotor_inertia_kgm2 = 0.01
[free]
"damping_nmspr.left_reach" = [0.0, 5.0]
"kp_nmprad.left_elbow" = [20, 50]
[effect.coulomb_friction.left_reach]
force_n = 4.0
[effect.payload.left_hand]
mass_kg = 0.3
x_m = 0.01
y_m = -0.02
z_m = 0.1
[effect.base_tilt.base]
roll_rad = 0.02
pitch_rad = -0.03
)";

/// A name that is a link of the branched robot and moves with the left arm.
std::string moving_link(const trees::TreeModel& m) {
  const auto links = trees::sites(m, LocationType::link);
  return m.robot.links[links.back()].name;
}
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

trees::TreeModel everything() {
  const trees::TreeModel plain = test::robot(
      "model/robots/branched.urdf", "joints = [\"left_shoulder\", \"left_elbow\", \"left_reach\"]\n");
  return test::robot("model/robots/branched.urdf", replaced(kAll, "left_hand", moving_link(plain)));
}

}  // namespace

TEST_CASE("A tree's model file says joints, gravity, drives, free parameters and causes") {
  const trees::TreeModel m = everything();
  REQUIRE(m.joints() == 3);
  const std::size_t shoulder = test::joint(m, "left_shoulder"), elbow = test::joint(m, "left_elbow"),
                    reach = test::joint(m, "left_reach");
  CHECK(m.gravity_mps2.y == 1.5);
  CHECK(m.robot.model.gravity_mps2.z == -9.7);
  CHECK(m.drives[shoulder].law == ControlMode::torque);
  CHECK(m.drives[shoulder].damping_nmspr == 0.2);
  CHECK(m.drives[elbow].law == ControlMode::position);
  CHECK(m.drives[elbow].kp_nmprad == 30.0);
  CHECK(m.drives[elbow].kd_nmsprad == 1.25);
  CHECK(m.drives[elbow].rotor_inertia_kgm2 == 0.01);
  CHECK(m.drives[elbow].damping_nmspr == 0.2);
  CHECK_FALSE(m.prismatic(elbow));
  CHECK(m.prismatic(reach));
  REQUIRE(m.free.size() == 2);
  REQUIRE(m.causes.size() == 3);
  for (const trees::Cause& c : m.causes) {
    if (c.effect == Effect::coulomb_friction) {
      CHECK(c.sites == std::vector<std::size_t>{reach});
      CHECK(c.values[0] == 4.0);
      CHECK(trees::cause_name(m, c) == "coulomb_friction@left_reach");
    }
    if (c.effect == Effect::base_tilt) CHECK(trees::cause_name(m, c) == "base_tilt@base");
    if (c.effect == Effect::payload) CHECK(c.values == std::array<double, 4>{0.3, 0.01, -0.02, 0.1});
  }
}

TEST_CASE("Keys of an earlier version are read, and written by their present names") {
  const trees::TreeModel m =
      test::pendulum("[drive]\nlaw = \"torque\"\n[drive.hinge]\nlaw = \"position\"\nkp_nmprad = 3.0\n");
  CHECK(m.drives[0].law == ControlMode::position);
  CHECK_THAT(trees::format_tree_model(m, "pendulum.urdf"),
             Contains("control_mode = \"position\"") && !Contains("law ="));
  const trees::TreeModel held =
      test::robot("model/robots/branched.urdf", "joints = [\"left_shoulder\"]\n[hold]\nleft_elbow = 0.5\n");
  CHECK(held.hold.at("left_elbow") == 0.5);
  CHECK_THAT(trees::format_tree_model(held, "branched.urdf"), Contains("[locked_joints]\nleft_elbow = 0.5"));
  CHECK_THAT(refused("[drive]\nlaw = \"torqe\"\n"), Contains("control_mode = 'torqe'"));
}

TEST_CASE("A drive's damping is the URDF's where the model file does not say another") {
  CHECK(test::pendulum().drives[0].damping_nmspr == 0.02);
  CHECK(test::pendulum("[drive]\nrotor_inertia_kgm2 = 0.1\n").drives[0].damping_nmspr == 0.02);
  CHECK(test::pendulum("[drive.hinge]\ndamping_nmspr = 0.0\n").drives[0].damping_nmspr == 0.0);
}

TEST_CASE("A tree's model file is written so that it reads back the same") {
  const trees::TreeModel m = everything();
  const std::string text = trees::format_tree_model(m, "branched.urdf");
  const trees::TreeModel back = trees::parse_tree_model(text, m.file);
  CHECK(trees::format_tree_model(back, "branched.urdf") == text);
  CHECK(back.moving == m.moving);
  CHECK(back.gravity_mps2.y == m.gravity_mps2.y);
  CHECK(std::is_permutation(back.causes.begin(), back.causes.end(), m.causes.begin(), m.causes.end()));
  REQUIRE(back.free.size() == m.free.size());
  for (std::size_t j = 0; j < m.joints(); ++j)
    for (const auto member : trees::kDriveMembers) CHECK(back.drives[j].*member == m.drives[j].*member);
  CHECK(back.drives[test::joint(m, "left_elbow")].law == ControlMode::position);
}

TEST_CASE("How often a drive calculates its law is written with its model") {
  const trees::TreeModel m =
      test::pendulum("[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 20.0\nloop_rate_hz = 500.0\n");
  CHECK(
      trees::parse_tree_model(trees::format_tree_model(m, "pendulum.urdf"), m.file).drives[0].loop_rate_hz ==
      500.0);
}

TEST_CASE("A cause at several sites is written as one a site") {
  trees::TreeModel m = test::double_pendulum();
  m.causes = {{Effect::coulomb_friction, {0, 1}, {0.25, 0, 0, 0}}};
  const trees::TreeModel back =
      trees::parse_tree_model(trees::format_tree_model(m, "double_pendulum.urdf"), m.file);
  REQUIRE(back.causes.size() == 2);
  for (const trees::Cause& c : back.causes) CHECK(c.values[0] == 0.25);
  CHECK(back.causes[0].sites != back.causes[1].sites);
}

TEST_CASE("Joints that do not move are held where [locked_joints] says") {
  // The elbow at 0.3 rad puts the lower rod and its weight elsewhere in the upper rod's frame.
  const trees::TreeModel straight = test::double_pendulum("joints = [\"shoulder\"]\n"),
                         bent =
                             test::double_pendulum("joints = [\"shoulder\"]\n[locked_joints]\nelbow = 0.3\n");
  REQUIRE(bent.joints() == 1);
  CHECK(bent.hold.at("elbow") == 0.3);
  CHECK(bent.robot.model.body(0).mass_kg == Approx(0.56 + 0.4 + 0.25));
  // The axis is -y: a turn by 0.3 takes -z to -x sin + ...: x = 0.2 m sin 0.3 for the rod's centre of 0.4 kg.
  const double before = straight.robot.model.body(0).moment_kgm.x,
               after = bent.robot.model.body(0).moment_kgm.x;
  CHECK(std::abs(after - before) > 0.4 * 0.2 * std::sin(0.3));
  const trees::TreeModel back =
      trees::parse_tree_model(trees::format_tree_model(bent, "double_pendulum.urdf"), bent.file);
  CHECK(back.robot.model.body(0).moment_kgm.x == after);
  CHECK_FALSE(refused("joints = [\"left_elbow\"]\n[locked_joints]\nleft_elbow = 0.1\n").empty());
  CHECK_THAT(refused("[locked_joints]\nno_such = 0.1\n"), Contains("no_such"));
  CHECK_THAT(refused("[locked_joints]\nleft_elbow = \"up\"\n"), Contains("[locked_joints] left_elbow"));
}

TEST_CASE("A tree's model file is refused with file, line and what was expected") {
  const std::string head = "[model]\nkind = \"tree\"\nschema = 1\n";
  CHECK_THAT(refused_text("x = 1\n"), Contains("robot.toml:1: unknown key 'x'"));
  CHECK_THAT(refused_text("[drive]\n"), Contains("no section [model]"));
  CHECK_THAT(refused_text("[model]\nkind = \"tree\"\n"),
             Contains("no key 'schema'") && Contains("schema = 1"));
  CHECK_THAT(refused_text("[model]\nkind = \"tree\"\nschema = 2\n"),
             Contains("robot.toml:3: schema = 2; expected 1"));
  CHECK_THAT(refused_text(head), Contains("no key 'urdf'"));
  CHECK_THAT(refused_text(head + "urdf = 3\n"), Contains("robot.toml:4") && Contains("urdf"));
  CHECK_THAT(refused_text(head + "urdf = \"none.urdf\"\n"), Contains("none.urdf"));
  CHECK_THAT(refused_text(head + "urdf = \"pendulum.urdf\"\n[drives]\n"),
             Contains("robot.toml:5: unknown key 'drives'") && Contains("did you mean 'drive'?"));
  CHECK_THAT(refused("base = \"floating\"\n"),
             Contains("robot.toml:5: base = 'floating'; expected \"fixed\""));
  CHECK_THAT(refused("gravity = [0.0, 0.0, -9.81]\n"),
             Contains("unknown key 'gravity'") && Contains("did you mean 'gravity_mps2'?"));
  CHECK_THAT(refused("gravity_mps2 = [0.0, -9.81]\n"), Contains("expected three numbers, x y z"));
  CHECK_THAT(refused("gravity_mps2 = [0.0, 0.0, -981.0]\n"), Contains("gravity_mps2") && Contains("-100"));
  CHECK_THAT(refused("joints = []\n"),
             Contains("robot.toml:5: joints =") && Contains("expected names of joints"));
  CHECK_THAT(refused("joints = \"left_elbow\"\n"), Contains("expected names of joints"));
  CHECK_THAT(refused("joints = [\"left_elbo\"]\n"), Contains("left_elbo"));
  CHECK_THAT(refused("joints = [3]\n"), Contains("joints"));
}

TEST_CASE("Wrong drives are refused") {
  CHECK_THAT(refused("[drive]\ncontrol_mode = \"speed\"\n"),
             Contains("robot.toml:6: control_mode = 'speed'; expected one of torque, position, none"));
  CHECK_THAT(refused("[drive]\ncontrol_mode = \"position\"\n"),
             Contains("has control_mode \"position\" and no kp_nmprad; expected one above 0"));
  CHECK_THAT(refused("[drive.left_elbow]\ncontrol_mode = \"position\"\n"),
             Contains("joint 'left_elbow'") && Contains("no kp_nmprad"));
  CHECK_THAT(refused("[drive]\ndampng_nmspr = 1\n"),
             Contains("robot.toml:6: unknown key 'dampng_nmspr' in [drive]") &&
                 Contains("did you mean 'damping_nmspr'?"));
  CHECK_THAT(refused("[drive.left_elbo]\ndamping_nmspr = 1\n"),
             Contains("[drive.left_elbo]: no joint 'left_elbo' that moves") &&
                 Contains("did you mean 'left_elbow'?"));
  CHECK_THAT(refused("joints = [\"left_elbow\"]\n[drive.left_shoulder]\ndamping_nmspr = 1\n"),
             Contains("no joint 'left_shoulder' that moves; expected one of left_elbow"));
  CHECK_THAT(refused("[drive.left_elbow]\ndamping = 1\n"),
             Contains("unknown key 'damping' in [drive.left_elbow]"));
  CHECK_THAT(refused("[drive]\ndamping_nmspr = -1\n"), Contains("[drive] damping_nmspr"));
  CHECK_THAT(refused("[drive]\ndamping_nmspr = nan\n"), Contains("[drive] damping_nmspr"));
  CHECK_THAT(refused("[drive]\ndamping_nmspr = \"much\"\n"), Contains("[drive] damping_nmspr"));
}

TEST_CASE("Wrong free parameters are refused") {
  CHECK_THAT(refused("[free]\ndamping_nmspr = [0, 1]\n"),
             Contains("unknown key 'damping_nmspr' in [free]; expected \"NAME.JOINT\""));
  CHECK_THAT(refused("[free]\n\"mass_kg.left_elbow\" = [0, 1]\n"),
             Contains("unknown key 'mass_kg.left_elbow'"));
  CHECK_THAT(refused("[free]\n\"damping_nmspr.left_elbo\" = [0, 1]\n"),
             Contains("no joint 'left_elbo'") && Contains("did you mean 'left_elbow'?"));
  CHECK_THAT(refused("[free]\n\"damping_nmspr.left_elbow\" = 1\n"),
             Contains("expected two numbers, [lower, upper]"));
  CHECK_THAT(refused("[free]\n\"damping_nmspr.left_elbow\" = [0, 1, 2]\n"), Contains("expected two numbers"));
  CHECK_THAT(refused("[drive]\ndamping_nmspr = 2\n[free]\n\"damping_nmspr.left_elbow\" = [0, 1]\n"),
             Contains("= [0, 1]; expected lower < upper around the model's value 2"));
  CHECK_THAT(refused("[drive]\ndamping_nmspr = 1\n[free]\n\"damping_nmspr.left_elbow\" = [1, 1]\n"),
             Contains("expected lower < upper"));
  CHECK_THAT(refused("[free]\n\"damping_nmspr.left_elbow\" = [-1, 1]\n"), Contains("lower bound"));
}

TEST_CASE("Wrong causes are refused") {
  CHECK_THAT(
      refused("[effect.coulom_friction.left_elbow]\ntorque_nm = 1\n"),
      Contains("unknown effect 'coulom_friction' of a tree") && Contains("did you mean 'coulomb_friction'?"));
  CHECK_THAT(refused("[effect.coulomb_friction.left_elbo]\ntorque_nm = 1\n"),
             Contains("no joint 'left_elbo'; expected one of") && Contains("did you mean 'left_elbow'?"));
  CHECK_THAT(refused("[effect.mass_error.left_elbow]\nmass_kg = 1\n"),
             Contains("no link 'left_elbow'; expected one of"));
  CHECK_THAT(refused("[effect.base_tilt.left_elbow]\nroll_rad = 0\npitch_rad = 0\n"),
             Contains("no base 'left_elbow'; expected one of base"));
  CHECK_THAT(refused("[effect.actuator_delay.left_hand]\ndelay_s = 0.01\n"),
             Contains("no drive 'left_hand'"));
  CHECK_THAT(refused("[effect.encoder_offset.nowhere]\noffset_rad = 0.01\n"),
             Contains("no encoder 'nowhere'"));
  CHECK_THAT(refused("[effect.coulomb_friction.left_elbow]\ntorque_n = 1\n"),
             Contains("unknown key 'torque_n'") && Contains("did you mean 'torque_nm'?"));
  CHECK_THAT(refused("[effect.coulomb_friction.left_elbow]\n"),
             Contains("no key 'torque_nm'") && Contains("expected a number from 0 to 10000 N m"));
  CHECK_THAT(refused("[effect.coulomb_friction.left_elbow]\ntorque_nm = -1\n"), Contains("torque_nm = -1"));
  // A prismatic joint has newtons.
  CHECK_THAT(refused("[effect.coulomb_friction.left_reach]\ntorque_n = 1\n"),
             Contains("unknown key 'torque_n'") && Contains("force_n"));
  CHECK_THAT(refused("[effect.position_gain_error.left_elbow]\nkp_nmprad = 1\nkd_nmsprad = 1\n"),
             Contains("its drive has control_mode \"torque\"; expected \"position\""));
  CHECK_THAT(refused("[effect]\ncoulomb_friction = 3\n"), Contains("[effect.coulomb_friction]"));
  CHECK_THAT(refused("[effect.coulomb_friction]\nleft_elbow = 3\n"),
             Contains("[effect.coulomb_friction.left_elbow]"));
}

TEST_CASE("A file is a tree's only by its kind") {
  CHECK(trees::is_tree("[model]\nkind = \"tree\"\n"));
  CHECK_FALSE(trees::is_tree("[model]\nkind = \"hopper\"\n"));
  CHECK_FALSE(trees::is_tree("[model]\nkind = 3\n"));
  CHECK_FALSE(trees::is_tree("model = 3\n"));
  CHECK_FALSE(trees::is_tree("[model\n"));
  CHECK_FALSE(trees::is_tree(""));
}

TEST_CASE("Each effect of the catalogue reads back from a model file") {
  const trees::TreeModel plain = test::arm3(
      "[drive]\ncontrol_mode = \"position\"\nkp_nmprad = 20.0\n"
      "[spring.elbow]\nstiffness_nmprad = 30.0\nrest = \"touch_down\"\n"
      "[foot.tip]\nlink = \"fore\"\npoint_m = [0.3, 0.0, 0.0]\n");
  for (const trees::EffectInfo& e : trees::catalogue()) {
    INFO(e.name);
    CHECK(trees::effect_named(e.name) == e.effect);
    trees::TreeModel m = plain;
    REQUIRE_FALSE(trees::sites(m, e.location_type).empty());
    trees::Cause c{e.effect, {trees::sites(m, e.location_type).front()}, {}};
    for (std::size_t k = 0; k < e.parameter_count; ++k)
      c.values[k] = e.parameters()[k].lower +
                    0.375 * (std::min(e.parameters()[k].upper, 10.0) - e.parameters()[k].lower);
    m.causes = {c};
    const trees::TreeModel back = trees::parse_tree_model(trees::format_tree_model(m, "arm3.urdf"), m.file);
    REQUIRE(back.causes.size() == 1);
    CHECK(back.causes[0] == c);
  }
}

TEST_CASE("A URDF's name with control characters is refused, not printed") {
  CHECK_THAT(
      refused_text("[model]\nkind = \"tree\"\nschema = 1\nurdf = \"br\\nanched\\u001b.urdf\"\n"),
      Contains("br\\x0aanched\\x1b.urdf") && Contains("printable") && !Contains("\n") && !Contains("\x1b"));
}

TEST_CASE("A point on its axis moves where a rotor gives the joint an inertia") {
  const std::string urdf =
      "<robot name=\"p\"><link name=\"base\"/><link name=\"disc\"><inertial><mass value=\"1\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" "
      "iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link><joint name=\"axle\" type=\"continuous\"><parent link=\"base\"/><child "
      "link=\"disc\"/></joint></robot>";
  const auto read = [&](const std::string& more) {
    return trees::parse_tree_model("[model]\nkind = \"tree\"\nschema = 1\nurdf = \"p.urdf\"\n" + more,
                                   "p.toml", urdf);
  };
  CHECK_THAT(test::error_message([&] { read(""); }), Contains("rotor_inertia_kgm2 in [drive.axle]"));
  CHECK(read("[drive]\nrotor_inertia_kgm2 = 0.01\n").joints() == 1);
  CHECK_THAT(test::error_message([&] {
               read("[drive]\nrotor_inertia_kgm2 = 0.01\n[free]\n\"rotor_inertia_kgm2.axle\" = [0.0, 1.0]\n");
             }),
             Contains("expected a lower bound above 0"));
  CHECK(read("[drive]\nrotor_inertia_kgm2 = 0.01\n[free]\n\"rotor_inertia_kgm2.axle\" = [1e-4, 1.0]\n")
            .free.size() == 1);
}

TEST_CASE("Inertias that were accepted are accepted again in the file that is written") {
  const std::string urdf =
      "<robot name=\"p\"><link name=\"base\"/><link name=\"rod\"><inertial><mass value=\"1\"/><inertia ixx=\"0.01\" ixy=\"0\" ixz=\"0\" "
      "iyy=\"0.02\" iyz=\"0\" izz=\"0.08\"/></inertial></link><joint name=\"axle\" type=\"continuous\"><parent link=\"base\"/><child "
      "link=\"rod\"/></joint></robot>";
  const std::string text = "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"p.urdf\"\n";
  CHECK_THAT(test::error_message([&] { trees::parse_tree_model(text, "p.toml", urdf); }),
             Contains("accept_inertias = true in [model]"));
  const trees::TreeModel m = trees::parse_tree_model(text, "p.toml", trees::TreeContext{urdf, {}, true});
  REQUIRE(m.notes.size() == 1);
  const std::string written = trees::format_tree_model(m, "p.urdf");
  CHECK_THAT(written, Contains("accept_inertias = true"));
  CHECK(trees::parse_tree_model(written, "p.toml", urdf).accept_inertias);
  CHECK_THAT(refused("accept_inertias = 1\n"), Contains("accept_inertias = 1; expected true or false"));
}
