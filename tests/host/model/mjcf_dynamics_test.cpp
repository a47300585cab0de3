// Robots read from MJCF against MuJoCo, which reads the same files: masses, mass matrix, bias forces, springs and dampers.
#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/model/mjcf.hpp"
#include "host/model/robot_file.hpp"
#include "tests/host/model/mujoco_peer.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace furcula;

#ifndef FURCULA_MUJOCO
TEST_CASE("An MJCF has the dynamics that MuJoCo gives it") { test::skip("libmujoco-dev is not installed"); }
#else

namespace {

using Joints = model::RobotModel::Joints;

/// Relative to the largest of the state; `bodies`: of the inertias, kg m^2.
struct Differences {
  double mass = 0.0, matrix = 0.0, bias = 0.0, passive = 0.0, bodies = 0.0;
};

/// MuJoCo's body, where it is compiled: principal moments and their axes.
std::optional<model::UrdfInertia> as_compiled(const test::MujocoPeer& peer, const std::string& link) {
  const mjModel& m = peer.model();
  const int id = mj_name2id(&m, mjOBJ_BODY, link.c_str());
  if (id <= 0) return std::nullopt;
  mjtNum turn[9];
  mju_quat2Mat(turn, m.body_iquat + 4 * id);
  const mjtNum *at = m.body_ipos + 3 * id, *moments = m.body_inertia + 3 * id;
  const dynamics::tree::Mat3<double> r{
      {turn[0], turn[1], turn[2]}, {turn[3], turn[4], turn[5]}, {turn[6], turn[7], turn[8]}};
  return model::UrdfInertia{m.body_mass[id],
                            {transposed(r), {at[0], at[1], at[2]}},
                            {moments[0], 0.0, 0.0, moments[1], 0.0, moments[2]}};
}

double apart(const model::UrdfInertia& a, const model::UrdfInertia& b) {
  const auto s = turned_back(a.frame.turn, a.about_centre_kgm2),
             t = turned_back(b.frame.turn, b.about_centre_kgm2);
  double out = 0.0;
  for (const double d : {s.xx - t.xx, s.xy - t.xy, s.xz - t.xz, s.yy - t.yy, s.yz - t.yz, s.zz - t.zz})
    out = std::max(out, std::abs(d));
  const auto c = a.frame.at - b.frame.at;
  return std::max(out, std::sqrt(dot(c, c)) * a.mass_kg);
}

/// Joints without a name have one of their body's here, and none in MuJoCo: of each file at most one.
int joint_of(const test::MujocoPeer& peer, const std::string& name) {
  const mjModel& m = peer.model();
  if (const int id = mj_name2id(&m, mjOBJ_JOINT, name.c_str()); id >= 0) return id;
  for (int id = 0; id < m.njnt; ++id)
    if (m.names[m.name_jntadr[id]] == '\0') return id;
  throw std::runtime_error("MuJoCo has no joint " + name);
}

void compare(const model::RobotTree& tree, const test::MujocoPeer& peer, Differences& out) {
  const std::size_t n = tree.joints.size(), nv = static_cast<std::size_t>(peer.model().nv);
  std::vector<std::size_t> in_qpos(n), in_qvel(n);
  for (std::size_t i = 0; i < n; ++i) {
    const int id = joint_of(peer, tree.joints[i].name);
    in_qpos[i] = static_cast<std::size_t>(peer.model().jnt_qposadr[id]);
    in_qvel[i] = static_cast<std::size_t>(peer.model().jnt_dofadr[id]);
  }
  std::vector<double> full(nv * nv);
  std::mt19937 random(11);
  const auto within = [&](double most) {
    return std::uniform_real_distribution<double>(-most, most)(random);
  };
  for (int state = 0; state < 100; ++state) {
    Joints q{}, w{};
    mj_resetData(&peer.model(), &peer.data());
    for (std::size_t i = 0; i < n; ++i) {
      q[i] = within(3.0);
      w[i] = within(5.0);
      peer.data().qpos[in_qpos[i]] = q[i];
      peer.data().qvel[in_qvel[i]] = w[i];
    }
    peer.forward();
    mj_fullM(&peer.model(), full.data(), peer.data().qM);
    const auto h = dynamics::tree::mass_matrix(tree.model, q);
    const Joints bias = dynamics::tree::body_torques(tree.model, q, w, {}),
                 all = dynamics::tree::inverse_dynamics(tree.model, q, w, {});
    double d[3] = {}, most[3] = {1e-12, 1e-12, 1e-12};
    const auto see = [&](int k, double ours, double theirs) {
      d[k] = std::max(d[k], std::abs(ours - theirs));
      most[k] = std::max(most[k], std::abs(theirs));
    };
    for (std::size_t i = 0; i < n; ++i) {
      const std::size_t a = in_qvel[i];
      see(1, bias[i], peer.data().qfrc_bias[a]);
      see(2, all[i], peer.data().qfrc_bias[a] - peer.data().qfrc_passive[a]);
      for (std::size_t k = 0; k < n; ++k) see(0, h[i][k], full[a * nv + in_qvel[k]]);
    }
    out.matrix = std::max(out.matrix, d[0] / most[0]);
    // Where there is no gravity and nothing turns, both are zero but for rounding.
    out.bias = std::max(out.bias, d[1] / std::max(most[1], 1e-3));
    out.passive = std::max(out.passive, d[2] / std::max(most[2], 1e-3));
  }
}

/// As the file is read, and with MuJoCo's own compiled bodies in its place: what MuJoCo's search for principal axes leaves is not ours.
void compare(const std::string& path) {
  CAPTURE(path);
  model::Urdf robot = model::read_robot(path);
  test::MujocoPeer peer = test::MujocoPeer::of_file(path);
  Differences d;
  double ours = 0.0, theirs = 0.0;
  for (const model::UrdfLink& l : robot.links) ours += l.inertia ? l.inertia->mass_kg : 0.0;
  for (int b = 1; b < peer.model().nbody; ++b) theirs += peer.model().body_mass[b];
  d.mass = std::abs(ours - theirs) / theirs;
  const model::RobotTree as_read = model::tree_of(robot);
  compare(as_read, peer, d);
  for (model::UrdfLink& l : robot.links) {
    const auto there = as_compiled(peer, l.name);
    if (!l.inertia || !there) continue;
    d.bodies = std::max(d.bodies, apart(*l.inertia, *there));
    l.inertia = there;
  }
  Differences same;
  compare(model::tree_of(robot), peer, same);
  std::printf(
      "MuJoCo, %s: %zu joints; relative, mass %.0e, matrix %.0e, bias %.0e, with springs and dampers %.0e; bodies %.0e kg m^2 "
      "apart, and with MuJoCo's own %.0e, %.0e, %.0e\n",
      std::filesystem::path(path).filename().c_str(), as_read.joints.size(), d.mass, d.matrix, d.bias,
      d.passive, d.bodies, same.matrix, same.bias, same.passive);
  CHECK(d.mass < 1e-12);
  CHECK(d.bodies < 1e-7);
  CHECK(d.matrix < 1e-6);
  CHECK(d.bias < 1e-6);
  CHECK(same.matrix < 1e-9);
  CHECK(same.bias < 1e-9);
  CHECK(same.passive < 1e-9);
}

std::string own(const std::string& name) { return test::source("tests/host/model/mjcf/" + name + ".xml"); }

}  // namespace

TEST_CASE("An MJCF has the dynamics that MuJoCo gives it") {
  for (const char* name :
       {"pendulum", "planar_root", "inertials", "classes", "bounds", "shapes", "global", "branched",
        "no_gravity", "passive_off", "arm", "floating", "no_shapes", "global_no_pos", "partial"})
    compare(own(name));
}

TEST_CASE("MuJoCo's own samples have the dynamics that MuJoCo gives them") {
  const char* named = std::getenv("FURCULA_MUJOCO_MODELS");
  const std::string folder = named != nullptr ? named : "/usr/share/mujoco/model";
  if (!std::filesystem::exists(folder + "/humanoid/humanoid.xml"))
    return test::skip("libmujoco-samples is not installed (FURCULA_MUJOCO_MODELS names another place)");
  compare(folder + "/humanoid/humanoid.xml");
}

TEST_CASE("An MJCF that was written here reads back as the same tree") {
  for (const char* name : {"planar_root", "arm", "branched"}) {
    CAPTURE(name);
    const model::RobotTree tree = model::tree_of(model::read_robot(own(name)));
    const model::RobotTree back = model::tree_of(model::parse_robot(model::format_mjcf(tree), "written.xml"));
    REQUIRE(back.joints.size() == tree.joints.size());
    const Joints q{0.3, -0.2, 0.4, 0.6, -0.5, 0.1}, w{1.0, 2.0, -1.0, 0.5, -2.0, 1.5},
        a{2.0, -1.0, 3.0, 1.0, 0.5, -2.0};
    const Joints ours = dynamics::tree::inverse_dynamics(tree.model, q, w, a),
                 again = dynamics::tree::inverse_dynamics(back.model, q, w, a);
    for (std::size_t i = 0; i < tree.joints.size(); ++i) {
      CHECK(back.joints[i].name == tree.joints[i].name);
      CHECK(again[i] == Approx(ours[i]).epsilon(1e-9));
    }
  }
}

#endif
