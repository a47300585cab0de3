// Robots after the patterns of published URDFs (published/*.urdf): each says in its first comment what should happen to it.
//
//   tags:         patterns that it has
//   expect:       read | read, silent | read, note "WORDS", note "WORDS" | refused "WORDS" or "WORDS" | named "WORDS"
//                 (named: read with a note, or refused; the words are in what is said)
//   joints:       that move where the recording has columns for all that can, or for those of `columns`
//   key:          `joints` of the model file; none: no such key
//   moving mass:  of the links that these joints move, as the file has them
//
// The mass, and the mass matrix that the dynamics are compared with, are computed here from the file's links one by one: a body that is
// lost, added or moved when fixed links are merged shows.
#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>
#include <random>
#include <regex>
#include <set>
#include <sstream>

#include "furcula/dynamics/tree/forward_dynamics.hpp"
#include "host/core/strict_toml.hpp"
#include "host/model/xml_check.hpp"
#include "host/trees/model.hpp"
#include "host/trees/run.hpp"
#include "tests/host/cli/run_program.hpp"
#include "tests/host/model/mujoco_peer.hpp"
#include "tests/paths.hpp"
#include "tests/skip.hpp"

using namespace furcula;

namespace {

using Words = std::vector<std::string>;

Words split(const std::string& text) {
  std::istringstream in(text);
  Words out;
  for (std::string word; in >> word;) out.push_back(word);
  return out;
}

struct Published {
  std::string name, path, text;
  Words tags, joints, key, columns;
  enum class Fate { read, refused, named } fate = Fate::read;
  Words words;  ///< that are in what is said: of a refusal one of them, else all
  bool silent = false;
  bool compared = true;  ///< its accelerations are those of its links as they stand in the file
  double moving_mass_kg = 0.0;

  bool has(const std::string& tag) const { return std::find(tags.begin(), tags.end(), tag) != tags.end(); }
};

/// The value after "  key: " in the file's first comment, or nothing.
std::string said_of(const std::string& comment, const std::string& key) {
  const std::size_t at = comment.find("\n  " + key + ": ");
  if (at == std::string::npos) return "";
  const std::size_t from = at + key.size() + 5;
  return comment.substr(from, comment.find('\n', from) - from);
}

Published published(const std::filesystem::path& path) {
  Published p;
  p.name = path.stem().string();
  p.path = path.string();
  p.text = core::read_small_file(p.path, "a robot");
  const std::string comment = p.text.substr(0, p.text.find("-->"));
  p.tags = split(said_of(comment, "tags"));
  p.joints = split(said_of(comment, "joints"));
  p.key = split(said_of(comment, "key"));
  p.columns = split(said_of(comment, "columns"));
  p.compared = said_of(comment, "dynamics") != "not compared";
  const std::string expect = said_of(comment, "expect");
  if (expect.starts_with("refused")) p.fate = Published::Fate::refused;
  if (expect.starts_with("named")) p.fate = Published::Fate::named;
  p.silent = expect == "read, silent";
  for (std::size_t from = expect.find('"'); from != std::string::npos;) {
    const std::size_t to = expect.find('"', from + 1);
    p.words.push_back(expect.substr(from + 1, to - from - 1));
    from = expect.find('"', to + 1);
  }
  if (p.fate != Published::Fate::refused) p.moving_mass_kg = std::stod(said_of(comment, "moving mass"));
  return p;
}

std::vector<Published> all_published() {
  std::vector<std::filesystem::path> paths;
  for (const auto& entry : std::filesystem::directory_iterator(test::source("tests/host/trees/published")))
    if (entry.path().extension() == ".urdf") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  std::vector<Published> out;
  for (const auto& path : paths) out.push_back(published(path));
  return out;
}

/// The file's links and joints as numbers, read without the project's reader.
struct Raw {
  struct Link {
    double mass_kg = 0.0;
    Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();  ///< of the inertia, in the link
    Eigen::Matrix3d about_centre_kgm2 = Eigen::Matrix3d::Zero();
  };
  struct Joint {
    std::string name, type, parent, child;
    Eigen::Isometry3d placement = Eigen::Isometry3d::Identity();
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
    bool mimics = false;

    bool can_move() const { return type == "revolute" || type == "continuous" || type == "prismatic"; }
  };
  std::map<std::string, Link> links;
  std::vector<Joint> joints;
};

Eigen::Vector3d three(std::string_view text) {
  Eigen::Vector3d out = Eigen::Vector3d::Zero();
  std::istringstream in{std::string(text)};
  for (int i = 0; i < 3; ++i) in >> out(i);
  return out;
}
Eigen::Isometry3d origin(const model::XmlElement& e) {
  const Eigen::Vector3d turn = three(e.attribute("rpy"));
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.translate(three(e.attribute("xyz")));
  out.rotate(Eigen::AngleAxisd(turn.z(), Eigen::Vector3d::UnitZ()) *
             Eigen::AngleAxisd(turn.y(), Eigen::Vector3d::UnitY()) *
             Eigen::AngleAxisd(turn.x(), Eigen::Vector3d::UnitX()));
  return out;
}

Raw raw(const Published& p) {
  Raw out;
  Raw::Link* link = nullptr;
  Raw::Joint* joint = nullptr;
  bool inertial = false;
  for (const model::XmlElement& e : model::check_xml(p.text, p.name)) {
    const auto number = [&](std::string_view key) {
      return std::strtod(std::string(e.attribute(key)).c_str(), nullptr);
    };
    if (e.depth == 1) {
      link = nullptr;
      joint = nullptr;
      if (e.tag == "link") link = &out.links[std::string(e.attribute("name"))];
      if (e.tag == "joint") {
        joint = &out.joints.emplace_back();
        joint->name = e.attribute("name");
        joint->type = e.attribute("type");
      }
    } else if (e.depth == 2) {
      inertial = e.tag == "inertial";
      if (joint != nullptr) {
        if (e.tag == "parent") joint->parent = e.attribute("link");
        if (e.tag == "child") joint->child = e.attribute("link");
        if (e.tag == "origin") joint->placement = origin(e);
        if (e.tag == "axis") joint->axis = three(e.attribute("xyz")).normalized();
        if (e.tag == "mimic") joint->mimics = true;
      }
    } else if (e.depth == 3 && link != nullptr && inertial) {
      if (e.tag == "origin") link->frame = origin(e);
      if (e.tag == "mass") link->mass_kg = number("value");
      if (e.tag == "inertia") {
        const double xy = number("ixy"), xz = number("ixz"), yz = number("iyz");
        link->about_centre_kgm2 << number("ixx"), xy, xz, xy, number("iyy"), yz, xz, yz, number("izz");
      }
    }
  }
  return out;
}

/// Of the joints that move, in a posture: the kinetic energy is v' mass v / 2, gravity asks for -gravity.
struct AtRest {
  Eigen::MatrixXd mass;
  Eigen::VectorXd gravity;  ///< what gravity does, N m or N
  double potential = 0.0;   ///< J, of what moves

  Eigen::VectorXd accelerations() const { return mass.ldlt().solve(gravity); }
};

/// Sum over links of m J' J and J' I J, each link by itself.
AtRest at_rest(const Raw& robot, const Words& moving, const Eigen::VectorXd& q) {
  constexpr double kGravity_mps2 = 9.81;
  const auto n = static_cast<Eigen::Index>(moving.size());
  AtRest out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  struct Column {
    Eigen::Index joint;
    bool slides;
    Eigen::Vector3d axis, at;
  };
  const auto add = [&](const auto& self, const std::string& name, const Eigen::Isometry3d& frame,
                       const std::vector<Column>& before) -> void {
    if (const auto found = robot.links.find(name); found != robot.links.end() && !before.empty()) {
      const Raw::Link& link = found->second;
      const Eigen::Isometry3d body = frame * link.frame;
      const Eigen::Vector3d centre = body.translation();
      Eigen::Matrix3Xd slide = Eigen::Matrix3Xd::Zero(3, n), turn = slide;
      for (const Column& c : before) {
        slide.col(c.joint) = c.slides ? c.axis : Eigen::Vector3d(c.axis.cross(centre - c.at));
        if (!c.slides) turn.col(c.joint) = c.axis;
      }
      const Eigen::Matrix3d inertia = body.linear() * link.about_centre_kgm2 * body.linear().transpose();
      out.mass += link.mass_kg * slide.transpose() * slide + turn.transpose() * inertia * turn;
      out.gravity -= link.mass_kg * kGravity_mps2 * slide.row(2).transpose();
      out.potential += link.mass_kg * kGravity_mps2 * centre.z();
    }
    for (const Raw::Joint& j : robot.joints) {
      if (j.parent != name) continue;
      Eigen::Isometry3d child = frame * j.placement;
      std::vector<Column> columns = before;
      if (const auto which = std::find(moving.begin(), moving.end(), j.name); which != moving.end()) {
        const Eigen::Index i = which - moving.begin();
        columns.push_back({i, j.type == "prismatic", child.linear() * j.axis, child.translation()});
        if (j.type == "prismatic")
          child.translate(q(i) * j.axis);
        else
          child.rotate(Eigen::AngleAxisd(q(i), j.axis));
      }
      self(self, j.child, child, columns);
    }
  };
  std::set<std::string> roots;
  for (const auto& [name, link] : robot.links) roots.insert(name);
  for (const Raw::Joint& j : robot.joints) roots.insert(j.parent);
  for (const Raw::Joint& j : robot.joints) roots.erase(j.child);
  for (const std::string& root : roots) add(add, root, Eigen::Isometry3d::Identity(), {});
  return out;
}

std::string model_text(const Words& joints) {
  std::string text = "[model]\nkind = \"tree\"\nschema = 1\nurdf = \"robot.urdf\"\n";
  for (std::size_t i = 0; i < joints.size(); ++i)
    text += (i == 0 ? "joints = [\"" : ", \"") + joints[i] + "\"" + (i + 1 == joints.size() ? "]\n" : "");
  return text + "[drive]\ncontrol_mode = \"torque\"\n";
}

/// With these joints named.
trees::TreeModel tree_with(const Published& p, const Words& joints) {
  return trees::parse_tree_model(model_text(joints), p.path + ".toml", p.text);
}

/// A short recording of these joints, or of all that can move.
std::string recording(const Raw& robot, Words columns) {
  if (columns.empty())
    for (const Raw::Joint& j : robot.joints)
      if (j.can_move()) columns.push_back(j.name);
  std::ostringstream out;
  out << "# machine_type: tree\ntime_s";
  for (const std::string& name : columns) {
    const auto joint = std::find_if(robot.joints.begin(), robot.joints.end(),
                                    [&](const Raw::Joint& j) { return j.name == name; });
    const bool slides = joint != robot.joints.end() && joint->type == "prismatic";
    out << (slides ? ",position_" + name + "_m,force_" + name + "_n"
                   : ",angle_" + name + "_rad,torque_" + name + "_nm");
  }
  for (int row = 0; row < 80; ++row) {
    out << '\n' << 0.004 * row;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      const double phase = 0.2 * row + static_cast<double>(i);
      out << ',' << 0.02 + 0.015 * std::sin(phase) << ',' << 0.3 * std::cos(phase);
    }
  }
  return out.str() + "\n";
}

/// The names of the columns of that recording.
Words columns_of(const Published& p) {
  std::istringstream in(recording(raw(p), p.columns));
  std::string line;
  std::getline(in, line);
  std::getline(in, line);
  std::replace(line.begin(), line.end(), ',', ' ');
  return split(line);
}

/// What `furcula check` says of the robot and such a recording.
test::Ran checked(const Published& p) {
  const test::TemporaryFolder folder;
  folder.file("robot.urdf", p.text);
  const std::string file = folder.file("model.toml", model_text(p.key));
  const std::string log = folder.file("run1.csv", recording(raw(p), p.columns.empty() ? p.key : p.columns));
  return test::run_furcula({"check", "--model", file, log});
}

Words sorted(Words words) {
  std::sort(words.begin(), words.end());
  return words;
}
Words joints_of(const trees::TreeModel& m) {
  Words out;
  for (const auto& j : m.robot.joints) out.push_back(j.name);
  return out;
}

bool says(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

using Joints = model::RobotModel::Joints;

/// By how much the repair of a rounded inertia may change it: one in the third digit that is printed.
constexpr double kRepaired = 1e-2;
/// Else: links whose inertia is nothing beside that of what they are fixed to are left out or kept.
constexpr double kSame = 1e-6;
double tolerance(const Published& p) {
  return p.has("triangle_rounding") || p.has("negative_moment") ? kRepaired : kSame;
}

}  // namespace

TEST_CASE("Each pattern of published robots is in four files or more") {
  std::map<std::string, int> count;
  std::size_t files = 0;
  for (const Published& p : all_published()) {
    ++files;
    for (const std::string& tag : p.tags) ++count[tag];
  }
  CHECK(files >= 60);
  for (const char* tag : {"massless_frame",
                          "massless_frame_with_inertia",
                          "point_mass",
                          "thin_rod",
                          "thin_sheet",
                          "negative_moment",
                          "triangle_rounding",
                          "massless_between",
                          "shape_unknown",
                          "visual_without_geometry",
                          "mesh_scale_four",
                          "material_twice",
                          "material_undefined",
                          "limit_infinite",
                          "limit_missing",
                          "limit_reversed",
                          "version",
                          "mimic_of_nothing",
                          "free_root",
                          "mimic_gripper",
                          "wheels",
                          "default_by_recording",
                          "many_joints",
                          "xacro",
                          "loop_joint",
                          "transmission",
                          "gazebo_mechanics",
                          "unknown_mechanics"}) {
    CAPTURE(tag);
    CHECK(count[tag] >= 4);
  }
}

TEST_CASE("Published robots are read or refused as they should be, and what is odd about them is said") {
  for (const Published& p : all_published()) {
    const test::Ran ran = checked(p);
    const std::string said = ran.out + ran.err;
    INFO(p.name << ": " << said);
    if (p.fate == Published::Fate::refused) {
      CHECK(ran.status == 3);
      CHECK(std::any_of(p.words.begin(), p.words.end(), [&](const std::string& w) { return says(said, w); }));
      CHECK(says(ran.err, "robot.urdf"));
      continue;
    }
    if (p.fate == Published::Fate::named)
      CHECK((ran.status == 0 || ran.status == 3));
    else
      CHECK(ran.status == 0);
    for (const std::string& w : p.words) {
      INFO("expected to be said: " << w);
      CHECK(says(said, w));
    }
  }
}

TEST_CASE("Without a key joints, those move that the recording has columns of") {
  for (const Published& p : all_published()) {
    if (p.fate != Published::Fate::read || !p.key.empty()) continue;
    INFO(p.name);
    std::optional<trees::TreeModel> m;
    CHECK_NOTHROW(m = trees::parse_tree_model(model_text({}), p.path + ".toml",
                                              trees::TreeContext{.urdf = p.text, .columns = columns_of(p)}));
    if (!m) continue;
    CHECK(sorted(joints_of(*m)) == sorted(p.joints));
    if (p.silent) CHECK(m->notes.empty());
  }
}

TEST_CASE("The joints that are named move all the mass that the file puts behind them, and no more") {
  for (const Published& p : all_published()) {
    if (p.fate != Published::Fate::read) continue;
    INFO(p.name);
    std::optional<trees::TreeModel> m;
    CHECK_NOTHROW(m = tree_with(p, p.joints));
    if (!m) continue;
    CHECK(sorted(joints_of(*m)) == sorted(p.joints));
    double mass_kg = 0.0;
    for (std::size_t i = 0; i < m->joints(); ++i) mass_kg += m->robot.model.body(i).mass_kg;
    CHECK(mass_kg == Approx(p.moving_mass_kg).epsilon(1e-9));
  }
}

TEST_CASE("Published robots fall as the sum of their links does") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> about(-0.7, 0.7);
  for (const Published& p : all_published()) {
    if (p.fate != Published::Fate::read || !p.compared) continue;
    INFO(p.name);
    std::optional<trees::TreeModel> m;
    CHECK_NOTHROW(m = tree_with(p, p.joints));
    if (!m) continue;
    const Words moving = joints_of(*m);
    const Raw robot = raw(p);
    for (auto& law : m->robot.model.laws) law.friction_nm = law.damping_nmspr = 0.0;
    for (trees::Drive& drive : m->drives) drive.damping_nmspr = 0.0;
    const auto n = static_cast<Eigen::Index>(moving.size());
    Eigen::VectorXd angle(n), rate(n);
    Joints q{}, v{}, tau{};
    for (Eigen::Index i = 0; i < n; ++i) {
      q[static_cast<std::size_t>(i)] = angle(i) = about(random);
      rate(i) = about(random);
    }
    const AtRest before = at_rest(robot, moving, angle);
    const Eigen::VectorXd expected = before.accelerations();
    const Joints a = dynamics::tree::accelerations(m->robot.model, q, v, tau);
    // A machine whose axes are upright does not fall: rounding is all that is left.
    const double scale = std::max(1e-6, expected.cwiseAbs().maxCoeff());
    for (Eigen::Index i = 0; i < n; ++i) {
      INFO(moving[static_cast<std::size_t>(i)] << " " << a[static_cast<std::size_t>(i)] << " "
                                               << expected(i));
      CHECK(std::abs(a[static_cast<std::size_t>(i)] - expected(i)) < tolerance(p) * scale);
    }

    // 20 ms in motion without torque: the energy of the links stays. The speeds are such that it moves a tenth of it about.
    const double kinetic = 0.5 * rate.dot(before.mass * rate);
    const trees::Setup setup = trees::SetupMaker(*m).make({m->drives, {}});
    trees::Runner runner(setup);
    std::vector<double> start(angle.data(), angle.data() + n), speed(rate.data(), rate.data() + n);
    runner.reset(start, speed);
    const std::vector<double> none(moving.size(), 0.0);
    for (int k = 0; k < 20; ++k) runner.advance(none, 1e-3);
    for (Eigen::Index i = 0; i < n; ++i) {
      angle(i) = runner.measured(static_cast<std::size_t>(i));
      rate(i) = runner.velocity(static_cast<std::size_t>(i));
    }
    const AtRest after = at_rest(robot, moving, angle);
    const double drift = 0.5 * rate.dot(after.mass * rate) + after.potential - kinetic - before.potential;
    CHECK(std::abs(drift) <
          std::max(1e-4, tolerance(p)) * (kinetic + std::abs(after.potential - before.potential)));
  }
}

#ifndef FURCULA_MUJOCO
TEST_CASE("Published robots accelerate as in MuJoCo") { test::skip("libmujoco-dev is not installed"); }
#else
TEST_CASE("Published robots accelerate as in MuJoCo") {
  // It does not read bodies without mass that move, nor inertias that no body has: such files are not compared.
  static const std::regex shapes(
      "<(visual|collision|gazebo|transmission|ros2_control)[\\s>][\\s\\S]*?</\\1>");
  std::mt19937 random(5);
  std::uniform_real_distribution<double> about(-1.0, 1.0);
  int compared = 0;
  for (const Published& p : all_published()) {
    if (p.fate != Published::Fate::read || !p.compared) continue;
    const Raw robot = raw(p);
    const auto can = std::count_if(robot.joints.begin(), robot.joints.end(),
                                   [](const Raw::Joint& j) { return j.can_move(); });
    if (static_cast<std::size_t>(can) != p.joints.size()) continue;
    std::string text = std::regex_replace(p.text, shapes, "");
    text.insert(text.find('>', text.find("<robot")) + 1,
                "<mujoco><compiler fusestatic=\"true\" discardvisual=\"true\"/></mujoco>");
    std::optional<test::MujocoPeer> peer;
    try {
      peer.emplace(text);
    } catch (const std::runtime_error&) {
      continue;
    }
    if (peer->model().nv != static_cast<int>(p.joints.size())) continue;
    INFO(p.name);
    std::optional<trees::TreeModel> m;
    CHECK_NOTHROW(m = tree_with(p, p.joints));
    if (!m) continue;
    for (auto& law : m->robot.model.laws) law.friction_nm = 0.0;
    Joints q{}, v{}, tau{};
    for (std::size_t i = 0; i < m->joints(); ++i) {
      const std::size_t k = peer->place(m->robot.joints[i].name);
      peer->data().qpos[k] = q[i] = about(random);
      peer->data().qvel[k] = v[i] = about(random);
    }
    peer->forward();
    const Joints a = dynamics::tree::accelerations(m->robot.model, q, v, tau);
    double most = 1e-6, apart = 0.0;
    for (std::size_t i = 0; i < m->joints(); ++i) {
      const double theirs = peer->data().qacc[peer->place(m->robot.joints[i].name)];
      most = std::max(most, std::abs(theirs));
      apart = std::max(apart, std::abs(a[i] - theirs));
    }
    std::printf("MuJoCo, %s: %zu joints, %.1e relative\n", p.name.c_str(), m->joints(), apart / most);
    // It keeps principal moments that are up to 2e-8 kg m^2 from what was written (tests/host/model/mujoco_test.cpp).
    CHECK(apart / most < std::max(1e-4, tolerance(p)));
    ++compared;
  }
  CHECK(compared >= 10);
}
#endif
