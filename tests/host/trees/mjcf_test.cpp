// From MJCF to a diagnosis: what a model file takes from the robot's own file, and what recordings that MuJoCo makes of it show.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "host/core/strict_toml.hpp"
#include "host/log/reader.hpp"
#include "host/model/robot_file.hpp"
#include "host/trees/diagnose.hpp"
#include "host/trees/exports.hpp"
#include "host/trees/run.hpp"
#include "tests/folder.hpp"
#include "tests/host/model/mujoco_peer.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace furcula;
using trees::ControlMode;
using trees::Effect;

namespace {

std::string own(const std::string& name) { return test::source("tests/host/model/mjcf/" + name + ".xml"); }
std::string model_of(const std::string& more) {
  return "[model]\nkind = \"tree\"\nschema = 1\nmjcf = \"robot.xml\"\n" + more;
}
trees::TreeModel read(const std::string& name, const std::string& more = "") {
  return trees::parse_tree_model(model_of(more), "model.toml", core::read_small_file(own(name), ""));
}

}  // namespace

TEST_CASE(
    "A model file takes armature, damping, springs, gains and gravity from an MJCF where it does not say them") {
  const trees::TreeModel m = read("branched");
  const auto drive = [](const trees::TreeModel& of, const std::string& joint) {
    for (std::size_t i = 0; i < of.joints(); ++i)
      if (of.robot.joints[i].name == joint) return of.drives[i];
    throw std::runtime_error(joint);
  };
  CHECK(m.gravity_mps2.z == -3.71);
  CHECK(m.robot.model.gravity_mps2.z == -3.71);
  CHECK(drive(m, "lift").law == ControlMode::torque);
  CHECK(drive(m, "lift").damping_nmspr == 30.0);
  CHECK(drive(m, "left_hip").law == ControlMode::position);
  CHECK(drive(m, "left_hip").kp_nmprad == 30.0);
  CHECK(drive(m, "left_hip").rotor_inertia_kgm2 == 0.01);
  CHECK(drive(m, "right_knee").law == ControlMode::none);
  const trees::TreeModel said =
      read("branched",
           "gravity_mps2 = [0.0, 0.0, -1.0]\n[drive.left_hip]\ncontrol_mode = \"torque\"\n"
           "rotor_inertia_kgm2 = 0.5\n[drive.right_knee]\ncontrol_mode = \"torque\"\n");
  CHECK(said.gravity_mps2.z == -1.0);
  CHECK(drive(said, "left_hip").law == ControlMode::torque);
  CHECK(drive(said, "left_hip").kp_nmprad == 0.0);
  CHECK(drive(said, "left_hip").rotor_inertia_kgm2 == 0.5);
  CHECK(drive(said, "right_knee").law == ControlMode::torque);
  const trees::TreeModel leg = read("leg");
  CHECK(leg.springs[0].stiffness_nmprad == 6.0);
  CHECK(leg.springs[0].rest_rad == 0.2);
  CHECK(leg.springs[0].both_ways);
  // And it is written and read back the same.
  const std::string text = trees::format_tree_model(leg, "robot.xml");
  CHECK_THAT(text, Catch::Contains("mjcf = \"robot.xml\""));
  const trees::TreeModel back =
      trees::parse_tree_model(text, "model.toml", core::read_small_file(own("leg"), ""));
  CHECK(trees::format_tree_model(back, "robot.xml") == text);
}

TEST_CASE("A robot's own file stands for a model file that says no more") {
  CHECK(trees::is_tree(core::read_small_file(own("leg"), "")));
  const trees::TreeModel m = trees::read_tree_model(own("leg"));
  CHECK(m.joints() == 2);
  CHECK(m.drives[0].rotor_inertia_kgm2 == 0.01);
}

#ifndef FURCULA_MUJOCO
TEST_CASE("A cause that is hidden in MuJoCo's simulation is found") {
  test::skip("libmujoco-dev is not installed");
}
#else

namespace {

struct Hidden {
  std::string joint;
  double more_damping_nmspr;
};

/// `seconds` at 200 Hz: torques of three sines a joint, held between rows; angles with a noise of 0.1 mrad. `file` as it is, with the hidden cause.
log::Log recorded(const std::string& file, const std::vector<std::string>& joints,
                  const std::vector<double>& most_nm, const Hidden& hidden, double seconds, unsigned seed) {
  test::MujocoPeer peer = test::MujocoPeer::of_file(file);
  mjModel& m = peer.model();
  mjData& d = peer.data();
  m.opt.disableflags &= ~mjDSBL_CONSTRAINT;
  m.opt.disableflags |= mjDSBL_CONTACT | mjDSBL_LIMIT;
  m.opt.timestep = 2.5e-4;
  m.opt.integrator = mjINT_RK4;
  m.dof_damping[peer.place(hidden.joint)] += hidden.more_damping_nmspr;
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::normal_distribution<double> noise(0.0, 1e-4);
  std::vector<std::array<double, 6> > sines(joints.size());
  for (auto& s : sines)
    for (std::size_t k = 0; k < 3; ++k) {
      s[2 * k] = 2.0 * 3.14159 * (0.3 + 0.5 * static_cast<double>(k) + 0.4 * share(random));
      s[2 * k + 1] = 6.28 * share(random);
    }
  std::ostringstream text;
  text.precision(12);
  text << "# format: furcula-log/1\n# machine_type: tree\n# robot: r\ntime_s";
  for (const std::string& j : joints) text << ",angle_" << j << "_rad,torque_cmd_" << j << "_nm";
  text << "\n";
  std::vector<std::size_t> in_qpos, in_qvel;
  for (const std::string& j : joints) {
    const int id = mj_name2id(&m, mjOBJ_JOINT, j.c_str());
    in_qpos.push_back(static_cast<std::size_t>(m.jnt_qposadr[id]));
    in_qvel.push_back(static_cast<std::size_t>(m.jnt_dofadr[id]));
  }
  // All others stand still, and a free root with them, as on a stand: nothing here moves so much armature.
  for (int k = 0; k < m.nv; ++k)
    if (std::find(in_qvel.begin(), in_qvel.end(), static_cast<std::size_t>(k)) == in_qvel.end())
      m.dof_armature[k] = 1e9;
  const auto rows = static_cast<int>(seconds * 200.0);
  for (int row = 0; row < rows; ++row) {
    const double t = 0.005 * row;
    text << t;
    mju_zero(d.qfrc_applied, m.nv);
    for (std::size_t i = 0; i < joints.size(); ++i) {
      double torque = 0.0;
      for (std::size_t k = 0; k < 3; ++k)
        torque += most_nm[i] / 3.0 * std::sin(sines[i][2 * k] * t + sines[i][2 * k + 1]);
      text << "," << d.qpos[in_qpos[i]] + noise(random) << "," << torque;
      d.qfrc_applied[in_qvel[i]] = torque;
    }
    text << "\n";
    for (int k = 0; k < 20; ++k) mj_step(&m, &d);
  }
  return log::parse_log(text.str(), "mujoco_" + std::to_string(seed) + ".csv", "tree");
}

bool found(const trees::Diagnosis& d, Effect effect, const std::string& joint, double value) {
  for (const trees::Finding& f : d.findings)
    if (trees::cause_name(d.model, f.cause) == std::string(trees::info(effect).name) + "@" + joint)
      return std::abs(f.cause.values[0] - value) < 0.1 * value;
  return false;
}

void diagnose(const std::string& file, const std::string& settings, const std::vector<std::string>& joints,
              const std::vector<double>& most_nm, const Hidden& hidden, double damping_nmspr) {
  const std::string path = std::filesystem::path(file).parent_path().string() + "/model.toml";
  const trees::TreeModel model =
      trees::parse_tree_model("[model]\nkind = \"tree\"\nschema = 1\nmjcf = \"" +
                                  std::filesystem::path(file).filename().string() + "\"\n" + settings,
                              path);
  std::vector<log::Log> training, held_out;
  for (const unsigned seed : {1U, 2U, 3U})
    training.push_back(recorded(file, joints, most_nm, hidden, 5.0, seed));
  held_out.push_back(recorded(file, joints, most_nm, hidden, 5.0, 4));
  const trees::Diagnosis d = trees::diagnose(model, training, held_out);
  std::printf("MuJoCo's recordings of %s: %s;", std::filesystem::path(file).filename().c_str(),
              std::string(name(d.verdict)).c_str());
  for (const trees::Finding& f : d.findings)
    std::printf(" %s %.4f", trees::cause_name(d.model, f.cause).c_str(), f.cause.values[0]);
  std::printf("\n");
  CHECK(d.findings.size() == 1);
  CHECK(found(d, Effect::damping_error, hidden.joint, damping_nmspr));
  // The robot for other programs has it; a URDF is made of the MJCF.
  const trees::TreeModel urdf = trees::parse_tree_model(trees::format_tree_model(d.model, "robot.urdf"),
                                                        "model.toml", trees::extended_urdf(d));
  CHECK(urdf.joints() == d.model.joints());
  const model::RobotTree again =
      model::tree_of(model::parse_robot(trees::extended_mjcf(d), "extended.mjcf.xml"));
  // It is the user's file with what is changed: all joints, held ones too.
  const auto there = std::find_if(again.joints.begin(), again.joints.end(),
                                  [&](const auto& j) { return j.name == hidden.joint; }) -
                     again.joints.begin();
  CHECK(again.model.laws[static_cast<std::size_t>(there)].damping_nmspr ==
        Approx(damping_nmspr).epsilon(0.1));
}

}  // namespace

TEST_CASE("A cause that is hidden in MuJoCo's simulation is found") {
  diagnose(own("leg"), "", {"hip", "knee"}, {6.0, 1.2}, {"knee", 0.08}, 0.18);
}

TEST_CASE("A cause that is hidden in one of MuJoCo's own samples is found") {
  const char* named = std::getenv("FURCULA_MUJOCO_MODELS");
  const std::string folder = named != nullptr ? named : "/usr/share/mujoco/model";
  const std::string file = folder + "/humanoid/humanoid.xml";
  if (!std::filesystem::exists(file))
    return test::skip("libmujoco-samples is not installed (FURCULA_MUJOCO_MODELS names another place)");
  diagnose(file, "joints = [\"right_hip_y\", \"right_knee\"]\n", {"right_hip_y", "right_knee"}, {20.0, 3.0},
           {"right_knee", 0.5}, 0.7);
}

#endif
