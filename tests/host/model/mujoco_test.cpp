// The dynamics of trees against MuJoCo's: from the URDF as MuJoCo reads it, and from the MJCF written here.
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <regex>

#include "furcula/dynamics/tree/forward_dynamics.hpp"
#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "furcula/dynamics/tree/plant.hpp"
#include "host/core/strict_toml.hpp"
#include "host/model/mjcf.hpp"
#include "tests/host/model/mujoco_peer.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace furcula;

#ifndef FURCULA_MUJOCO
TEST_CASE("A tree accelerates as MuJoCo's does") { test::skip("libmujoco-dev is not installed"); }
#else

namespace {

using Joints = model::RobotModel::Joints;

std::string own(const std::string& name) {
  return core::read_small_file(test::source("tests/host/model/robots/" + name + ".urdf"), "a robot");
}
/// Of a robot of the folder of recordings, which is not part of the project; empty where it is not there.
std::string recorded(const std::string& path) {
  const char* named = std::getenv("FURCULA_DATA");
  const std::string folder = named != nullptr ? named : test::source("../shared/data");
  return std::filesystem::exists(folder + "/" + path) ? core::read_small_file(folder + "/" + path, "a robot")
                                                      : "";
}

/// A URDF as MuJoCo may read it: without shapes, whose mesh files it would look for, with its joints' numbers
/// in radians, and no link merged.
std::string for_mujoco(const std::string& urdf) {
  static const std::regex shapes("<(visual|collision)[\\s>][\\s\\S]*?</\\1>");
  std::string text = std::regex_replace(urdf, shapes, "");
  const std::size_t at = text.find('>', text.find("<robot"));
  return text.insert(at + 1, "<mujoco><compiler fusestatic=\"false\" discardvisual=\"true\"/></mujoco>");
}

struct Difference {
  double largest = 0.0;   ///< of the accelerations, rad/s^2 or m/s^2
  double relative = 0.0;  ///< to the largest acceleration of the state
};

/// MuJoCo keeps a body's principal moments and axes. What these give back is up to 2e-8 kg m^2 from what was
/// written (measured below), and the accelerations are as far apart.
constexpr double kAsRead = 1e-6;
/// A body as MuJoCo has it then.
dynamics::tree::Inertia<double> as_there(const test::MujocoPeer& peer, const std::string& link) {
  using namespace dynamics::tree;
  const mjModel& m = peer.model();
  const int id = mj_name2id(&m, mjOBJ_BODY, link.c_str());
  mjtNum turn[9];
  mju_quat2Mat(turn, m.body_iquat + 4 * id);  // from the inertia's frame to the body's
  const mjtNum *at = m.body_ipos + 3 * id, *moments = m.body_inertia + 3 * id;
  const Mat3<double> r{{turn[0], turn[1], turn[2]}, {turn[3], turn[4], turn[5]}, {turn[6], turn[7], turn[8]}};
  return inertia_back(Frame<double>{transposed(r), {at[0], at[1], at[2]}},
                      inertia_of(m.body_mass[id], Vec3<double>{0.0, 0.0, 0.0},
                                 {moments[0], 0.0, 0.0, moments[1], 0.0, moments[2]}));
}

/// Over 1000 random states: angles within a turn, 0.2 m; speeds 5 rad/s; torques that the bodies notice.
Difference compare(const model::RobotTree& tree, const test::MujocoPeer& peer) {
  REQUIRE(peer.model().nv == static_cast<int>(tree.joints.size()));
  std::mt19937 random(7);
  const auto within = [&](double most) {
    return std::uniform_real_distribution<double>(-most, most)(random);
  };
  Difference out;
  for (int n = 0; n < 1000; ++n) {
    Joints q{}, w{}, tau{};
    for (std::size_t i = 0; i < tree.joints.size(); ++i) {
      const bool slides = tree.joints[i].kind == model::UrdfJoint::Kind::prismatic;
      q[i] = within(slides ? 0.2 : 3.1);
      w[i] = within(slides ? 1.0 : 5.0);
      tau[i] = within(10.0);
      const std::size_t k = peer.place(tree.joints[i].name);
      peer.data().qpos[k] = q[i];
      peer.data().qvel[k] = w[i];
      peer.data().qfrc_applied[k] = tau[i];
    }
    peer.forward();
    const Joints a = dynamics::tree::accelerations(tree.model, q, w, tau);
    double most = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < tree.joints.size(); ++i) {
      const double theirs = peer.data().qacc[peer.place(tree.joints[i].name)];
      most = std::max(most, std::abs(theirs));
      largest = std::max(largest, std::abs(a[i] - theirs));
    }
    out.largest = std::max(out.largest, largest);
    out.relative = std::max(out.relative, largest / most);
  }
  return out;
}

void compare(const std::string& name, const std::string& urdf, const std::vector<std::string>& moving = {}) {
  if (urdf.empty()) return;
  CAPTURE(name);
  const model::Urdf robot = model::parse_urdf(urdf, name);
  model::RobotTree tree = model::tree_of(robot, moving);
  if (moving.empty()) {
    const Difference d = compare(tree, test::MujocoPeer(for_mujoco(urdf)));
    std::printf("MuJoCo, %s, its own reading of the URDF: %zu joints, %.1e rad/s^2 at most, %.1e relative\n",
                name.c_str(), tree.joints.size(), d.largest, d.relative);
    CHECK(d.relative < kAsRead);
  }
  for (std::size_t i = 0; i < tree.joints.size(); ++i) {
    tree.model.laws[i].armature_kgm2 = 0.01 + 0.002 * static_cast<double>(i);
    tree.model.laws[i].damping_nmspr += 0.1;
    tree.model.laws[i].stiffness_nmprad = 0.5;
    tree.model.laws[i].rest_rad = 0.1;
  }
  const test::MujocoPeer peer(model::format_mjcf(tree));
  const Difference d = compare(tree, peer);
  double bodies_apart = 0.0;  // kg m^2
  for (std::size_t i = 0; i < tree.joints.size(); ++i) {
    const dynamics::tree::Inertia<double> there = as_there(peer, tree.joints[i].link);
    const dynamics::tree::Sym3<double> a = there.inertia_kgm2, b = tree.model.body(i).inertia_kgm2;
    for (const double apart : {a.xx - b.xx, a.xy - b.xy, a.xz - b.xz, a.yy - b.yy, a.yz - b.yz, a.zz - b.zz})
      bodies_apart = std::max(bodies_apart, std::abs(apart));
    tree.model.set_body(i, there);
  }
  const Difference same_bodies = compare(tree, peer);
  std::printf(
      "MuJoCo, %s, MJCF written here, with armature, damping and springs: %.1e rad/s^2 at most, %.1e relative; its "
      "inertias are %.1e kg m^2 apart, and with them it is %.1e\n",
      name.c_str(), d.largest, d.relative, bodies_apart, same_bodies.relative);
  CHECK(d.relative < kAsRead);
  CHECK(bodies_apart < 1e-7);
  CHECK(same_bodies.relative < 1e-11);
}

}  // namespace

TEST_CASE("A tree accelerates as MuJoCo's does") {
  for (const char* name : {"pendulum", "double_pendulum", "cart_pole", "arm", "branched"})
    compare(name, own(name));
}

TEST_CASE("A tree of which some joints are held accelerates as MuJoCo's does") {
  compare("branched, the left arm", own("branched"), {"left_shoulder", "left_elbow", "left_reach"});
}

TEST_CASE("Published robots accelerate as MuJoCo's do") {
  if (recorded("go2/go2.urdf").empty())
    return test::skip("no robots at ../shared/data (FURCULA_DATA names another place)");
  for (const char* path : {"double_pendulum/A0.urdf", "double_pendulum/C1.urdf", "go2/go2.urdf"})
    compare(path, recorded(path));
  compare("go2, front left", recorded("go2/go2.urdf"), {"FL_hip", "FL_thigh", "FL_calf"});
}

TEST_CASE("A tree with a link without mass, a point, a rod and a sheet is one that MuJoCo reads") {
  const auto link = [](const std::string& name, const std::string& inertial) {
    return "<link name=\"" + name + "\"><inertial><origin xyz=\"0.02 0.01 -0.2\"/>" + inertial +
           "</inertial></link>";
  };
  const auto inertia = [](const std::string& xx, const std::string& yy, const std::string& zz) {
    return "<inertia ixx=\"" + xx + "\" ixy=\"0\" ixz=\"0\" iyy=\"" + yy + "\" iyz=\"0\" izz=\"" + zz +
           "\"/>";
  };
  const auto joint = [](const std::string& name, const std::string& parent, const std::string& child,
                        const std::string& axis) {
    return "<joint name=\"" + name + "\" type=\"continuous\"><parent link=\"" + parent +
           "\"/><child link=\"" + child + "\"/><origin xyz=\"0 0 -0.3\"/><axis xyz=\"" + axis +
           "\"/></joint>";
  };
  const std::string urdf =
      "<robot name=\"odd\"><link name=\"base\"/>" +
      link("rod", "<mass value=\"1\"/>" + inertia("0.01", "0.01", "0")) + "<link name=\"cross\"/>" +
      link("sheet", "<mass value=\"0.5\"/>" + inertia("0.003", "0.001", "0.002")) +
      link("point", "<mass value=\"0.3\"/>" + inertia("0", "0", "0")) + joint("a", "base", "rod", "0 1 0") +
      joint("b", "rod", "cross", "1 0 0") + joint("c", "cross", "sheet", "0 1 0") +
      joint("d", "sheet", "point", "0 1 0") + "</robot>";
  const model::RobotTree tree = model::tree_of(model::parse_urdf(urdf, "odd.urdf"));
  const Difference d = compare(tree, test::MujocoPeer(model::format_mjcf(tree)));
  CHECK(d.relative < kAsRead);
}

TEST_CASE("The trajectory of an arm is MuJoCo's, and gains in the MJCF are the drive's law") {
  model::RobotTree tree = model::tree_of(model::parse_urdf(own("arm"), "arm.urdf"));
  const std::vector<model::PositionGains> gains{{"joint_2", 40.0, 3.0}};
  for (std::size_t i = 0; i < 6; ++i) tree.model.laws[i].armature_kgm2 = 0.02;
  test::MujocoPeer peer(model::format_mjcf(tree, gains));
  mjModel& m = peer.model();
  m.opt.integrator = mjINT_RK4;
  m.opt.timestep = 1e-3;
  // The same law in continuous time: a spring to the set point, and damping.
  tree.model.laws[1].stiffness_nmprad = 40.0;
  tree.model.laws[1].rest_rad = 0.6;
  tree.model.laws[1].damping_nmspr += 3.0;
  dynamics::tree::Plant<double, model::RobotShape> plant(tree.model);
  plant.reset({}, {});
  peer.data().ctrl[1] = 0.6;
  double worst = 0.0;
  for (int n = 0; n < 1000; ++n) {
    plant.advance({}, 1e-3);
    mj_step(&m, &peer.data());
    for (std::size_t i = 0; i < 6; ++i)
      worst =
          std::max(worst, std::abs(plant.positions()[i] - peer.data().qpos[peer.place(tree.joints[i].name)]));
  }
  std::printf("MuJoCo, arm, 1 s of a trajectory under a position drive: %.1e rad apart at most\n", worst);
  CHECK(worst < 1e-6);
}

#endif
