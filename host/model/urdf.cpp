// Reading by urdfdom, which is seen in this file alone; what it lets pass is checked here.
#include "host/model/urdf.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <set>

#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/model/xml_check.hpp"

namespace furcula::model {
namespace {

using core::quoted;
using core::shortest;
using dynamics::tree::identity;
using dynamics::tree::Inertia;
using dynamics::tree::JointKind;
using dynamics::tree::Mat3;

/// What urdfdom says of a file, kept instead of printed.
class Said final : public console_bridge::OutputHandler {
 public:
  Said() : lock_(one_at_a_time()) { console_bridge::useOutputHandler(this); }
  ~Said() override { console_bridge::restorePreviousOutputHandler(); }
  Said(const Said&) = delete;
  Said& operator=(const Said&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && errors_ < 2)
      text_ += (errors_++ == 0 ? "" : "; ") + core::printable(text.substr(0, 300));
  }
  const std::string& text() const { return text_; }

 private:
  static std::mutex& one_at_a_time() {
    static std::mutex mutex;  // the handler is the process's
    return mutex;
  }
  std::lock_guard<std::mutex> lock_;
  std::string text_;
  int errors_ = 0;
};

[[noreturn]] void fail(const std::string& file, const std::string& message) {
  throw core::DataError(file + ": " + message);
}

urdf::ModelInterfaceSharedPtr parsed(std::string_view text, const std::string& name) {
  const Said said;
  urdf::ModelInterfaceSharedPtr robot;
  std::string thrown;
  try {
    robot = urdf::parseURDF(std::string(text));
  } catch (const std::exception& e) {
    thrown = core::printable(e.what());
  }
  // It takes some numbers that it could not read as zero, and says so.
  if (!robot || !said.text().empty()) {
    const std::string why = said.text().empty() ? thrown : said.text();
    fail(name, "not a robot (URDF): " + (why.empty() ? "expected <robot> with links and joints" : why));
  }
  return robot;
}

/// Before urdfdom sees them: of two parents it keeps one, and what hangs in a loop it never frees.
void refuse_loops(const std::vector<XmlElement>& elements, const std::string& name) {
  struct Joint {
    std::size_t line = 0;
    std::string_view name, parent, child;
  };
  std::vector<Joint> joints;
  bool in_joint = false;
  for (const XmlElement& e : elements) {
    if (e.depth == 1) {
      in_joint = e.tag == "joint";
      if (in_joint) joints.push_back({e.line, e.attribute("name"), {}, {}});
    } else if (e.depth == 2 && in_joint) {
      if (e.tag == "parent") joints.back().parent = e.attribute("link");
      if (e.tag == "child") joints.back().child = e.attribute("link");
    }
  }
  const auto refuse = [&](const Joint& j, const std::string& message) {
    throw core::DataError(name + ":" + std::to_string(j.line) + ": " + message);
  };
  std::map<std::string_view, const Joint*> above;  // of links
  for (const Joint& j : joints) {
    if (j.child.empty()) continue;  // urdfdom says what it lacks
    const auto [other, is_first] = above.emplace(j.child, &j);
    if (!is_first)
      refuse(j, "link " + quoted(j.child) + " is the child of joint " + quoted(other->second->name) +
                    " and of joint " + quoted(j.name) + ", expected one parent (a tree)");
  }
  std::set<std::string_view> rooted;
  for (const Joint& j : joints) {
    std::set<std::string_view> way;
    for (auto up = above.find(j.child); up != above.end() && !rooted.contains(up->first);
         up = above.find(up->second->parent))
      if (!way.insert(up->first).second)
        refuse(*up->second, "link " + quoted(up->first) + " is in a loop of joints, expected a tree");
    rooted.merge(way);
  }
}

class Reader {
 public:
  Reader(std::string_view text, const std::string& name) : robot_(parsed(text, name)) { out_.file = name; }

  Urdf read() {
    out_.name = word(robot_->getName(), "the robot's name");
    if (!robot_->getRoot()) fail(out_.file, "no root link, expected a tree of links");
    add(*robot_->getRoot());
    while (!ahead_.empty()) {
      const auto joint = std::move(ahead_.back());
      ahead_.pop_back();
      add(*joint);
    }
    if (out_.links.size() != robot_->links_.size())
      for (const auto& [name, link] : robot_->links_)
        if (!index_.contains(name))
          fail(out_.file, "link " + quoted(name) + " is in a loop of joints, expected a tree");
    check_mimics();
    return std::move(out_);
  }

 private:
  double finite(double x, const std::string& what) const {
    if (!std::isfinite(x)) fail(out_.file, what + " is " + shortest(x) + ", expected a finite number");
    return x;
  }
  Vec3<double> finite(const urdf::Vector3& v, const std::string& what) const {
    return {finite(v.x, what), finite(v.y, what), finite(v.z, what)};
  }
  double not_negative(double x, const std::string& what) const {
    if (finite(x, what) < 0.0) fail(out_.file, what + " is " + shortest(x) + ", expected at least 0");
    return x;
  }
  Frame<double> frame(const urdf::Pose& pose, const std::string& what) const {
    double x, y, z, w;
    pose.rotation.getQuaternion(x, y, z, w);
    for (const double part : {x, y, z, w}) finite(part, what + "'s <origin>");
    const Mat3<double> turn{{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)},
                            {2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)},
                            {2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)}};
    return {turn, finite(pose.position, what + "'s <origin>")};
  }

  /// A name goes into logs, a line or a column of them: without the spaces around it, and without control characters.
  std::string word(const std::string& name, const std::string& what) const {
    for (const char c : name)
      if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
        fail(out_.file, what + " is " + quoted(name) + ", expected a name without control characters");
    const std::size_t first = name.find_first_not_of(' ');
    return first == std::string::npos ? "" : name.substr(first, name.find_last_not_of(' ') + 1 - first);
  }
  /// The link; its joints are to come, the first by name next.
  void add(const urdf::Link& link) {
    static_cast<void>(word(link.name, "a link's name"));
    if (!index_.emplace(link.name, out_.links.size()).second)
      fail(out_.file, "link " + quoted(link.name) + " is the child of two joints, expected a tree");
    out_.links.push_back({link.name, inertia(link)});
    ahead_.insert(ahead_.end(), link.child_joints.rbegin(), link.child_joints.rend());
  }
  std::optional<UrdfInertia> inertia(const urdf::Link& link) const {
    if (!link.inertial) return std::nullopt;
    const urdf::Inertial& i = *link.inertial;
    const std::string what = "link " + quoted(link.name);
    const std::string moment = what + ": its <inertia>";
    return UrdfInertia{not_negative(i.mass, what + ": its <mass>"),
                       frame(i.origin, what + ": its <inertial>"),
                       {finite(i.ixx, moment), finite(i.ixy, moment), finite(i.ixz, moment),
                        finite(i.iyy, moment), finite(i.iyz, moment), finite(i.izz, moment)}};
  }
  void add(const urdf::Joint& joint) {
    const std::string what = "joint " + quoted(joint.name);
    static_cast<void>(word(joint.name, "a joint's name"));
    UrdfJoint out;
    out.name = joint.name;
    switch (joint.type) {
      case urdf::Joint::FIXED:
        out.kind = UrdfJoint::Kind::fixed;
        break;
      case urdf::Joint::REVOLUTE:
        out.kind = UrdfJoint::Kind::revolute;
        break;
      case urdf::Joint::CONTINUOUS:
        out.kind = UrdfJoint::Kind::continuous;
        break;
      case urdf::Joint::PRISMATIC:
        out.kind = UrdfJoint::Kind::prismatic;
        break;
      default:
        fail(out_.file, what + " is " + (joint.type == urdf::Joint::PLANAR ? "planar" : "floating") +
                            ", expected revolute, continuous, prismatic or fixed");
    }
    out.parent = index_.at(joint.parent_link_name);
    out.placement = frame(joint.parent_to_joint_origin_transform, what);
    out.axis = {0.0, 0.0, 1.0};
    if (out.kind != UrdfJoint::Kind::fixed) {
      const Vec3<double> axis = finite(joint.axis, what + ": its <axis>");
      const double length = std::sqrt(dot(axis, axis));
      if (!(length > 1e-9) || !std::isfinite(length))
        fail(out_.file, what + ": its <axis> is " + shortest(axis.x) + " " + shortest(axis.y) + " " +
                            shortest(axis.z) + ", expected a direction");
      out.axis = axis * (1.0 / length);
    }
    if (joint.limits && out.kind != UrdfJoint::Kind::fixed) {
      const std::string limit = what + ": its <limit>";
      const urdf::JointLimits& l = *joint.limits;
      out.limits = UrdfLimits{finite(l.lower, limit), finite(l.upper, limit), finite(l.effort, limit),
                              finite(l.velocity, limit)};
      if (l.lower > l.upper)
        fail(out_.file, limit + " has lower " + shortest(l.lower) + " above upper " + shortest(l.upper));
    }
    if (joint.dynamics) {
      out.damping = not_negative(joint.dynamics->damping, what + ": its <dynamics> damping");
      out.friction = not_negative(joint.dynamics->friction, what + ": its <dynamics> friction");
    }
    if (joint.mimic) out.mimics = joint.mimic->joint_name;
    out.child = out_.links.size();
    add(*robot_->links_.at(joint.child_link_name));
    out_.joints.push_back(std::move(out));
  }
  void check_mimics() const {
    for (const UrdfJoint& j : out_.joints)
      if (!j.mimics.empty() && !robot_->joints_.contains(j.mimics))
        fail(out_.file,
             "joint " + quoted(j.name) + " mimics " + quoted(j.mimics) + ", which is no joint of the robot");
  }

  urdf::ModelInterfaceSharedPtr robot_;
  Urdf out_;
  std::map<std::string, std::size_t> index_;  ///< of links
  std::vector<urdf::JointSharedPtr> ahead_;
};

/// Ascending.
std::array<double, 3> principal_moments(const Sym3<double>& s) {
  Eigen::Matrix3d m;
  m << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m, Eigen::EigenvaluesOnly);
  return {solver.eigenvalues()(0), solver.eigenvalues()(1), solver.eigenvalues()(2)};
}

/// Of a link that moves: about its own frame.
Inertia<double> checked_inertia(const Urdf& robot, const UrdfLink& link) {
  const UrdfInertia& i = *link.inertia;
  const std::string what = "link " + quoted(link.name);
  if (!(i.mass_kg > 0.0))
    fail(robot.file, what + ": its <mass> is " + shortest(i.mass_kg) + ", expected more than 0");
  const auto moments = principal_moments(i.about_centre_kgm2);
  const std::string values =
      core::rounded(moments[0]) + ", " + core::rounded(moments[1]) + ", " + core::rounded(moments[2]);
  if (!(moments[0] > 0.0))
    fail(robot.file,
         what + ": its <inertia> has the principal moments " + values + " kg m^2, expected all above 0");
  // What the printed digits of a thin sheet may be off by.
  constexpr double kRounding = 1e-6;
  if (moments[0] + moments[1] < moments[2] * (1.0 - kRounding))
    fail(robot.file,
         what + ": its <inertia> has the principal moments " + values +
             " kg m^2, which no body has; expected that none is more than the sum of the other two");
  return inertia_back(
      i.frame, dynamics::tree::inertia_of(i.mass_kg, Vec3<double>{0.0, 0.0, 0.0}, i.about_centre_kgm2));
}

/// The link's frame after the joint has moved to `position`, in the parent.
Frame<double> held_at(const UrdfJoint& joint, double position) {
  const Vec3<double>& a = joint.axis;
  if (joint.kind == UrdfJoint::Kind::prismatic)
    return within(joint.placement, Frame<double>{identity<double>(), a * position});
  const double s = std::sin(position), c = std::cos(position), k = 1.0 - c;
  // Of the turned frame's axes as rows: the transposed of Rodrigues' formula.
  const Mat3<double> turn{{c + a.x * a.x * k, a.x * a.y * k + a.z * s, a.x * a.z * k - a.y * s},
                          {a.x * a.y * k - a.z * s, c + a.y * a.y * k, a.y * a.z * k + a.x * s},
                          {a.x * a.z * k + a.y * s, a.y * a.z * k - a.x * s, c + a.z * a.z * k}};
  return within(joint.placement, Frame<double>{turn, {0.0, 0.0, 0.0}});
}

class TreeBuilder {
 public:
  TreeBuilder(const Urdf& robot, const std::map<std::string, double>& hold) : robot_(robot), hold_(hold) {}

  RobotTree build(const std::vector<std::string>& wanted) {
    choose(wanted);
    check_holds();
    out_.name = robot_.name;
    std::vector<const UrdfJoint*> over(robot_.links.size(), nullptr);  // the joint of each link
    for (const UrdfJoint& j : robot_.joints) over[j.child] = &j;
    place_links(over);
    std::vector<Inertia<double>> bodies(out_.joints.size());
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      const RobotTree::Link& at = out_.links[i];
      if (at.joint < 0 || !robot_.links[i].inertia) continue;
      auto& body = bodies[static_cast<std::size_t>(at.joint)];
      body = body + inertia_back(at.frame, checked_inertia(robot_, robot_.links[i]));
    }
    for (std::size_t i = 0; i < out_.joints.size(); ++i) add(i, bodies[i]);
    return std::move(out_);
  }

 private:
  const UrdfJoint& joint(const std::string& name) const {
    constexpr std::size_t kMostNamed = 24;
    std::vector<std::string_view> names;
    for (const UrdfJoint& j : robot_.joints) {
      if (j.name == name) return j;
      names.emplace_back(j.name);
    }
    std::string message = "no joint " + quoted(name) + core::did_you_mean(name, names);
    if (names.size() <= kMostNamed) message += "; expected one of " + core::listed(names);
    fail(robot_.file, core::printable(message));
  }
  void choose(const std::vector<std::string>& wanted) {
    for (const std::string& name : wanted) {
      const UrdfJoint& j = joint(name);
      if (j.kind == UrdfJoint::Kind::fixed)
        fail(robot_.file, "joint " + quoted(name) + " is fixed, expected one that moves");
      if (!moving_.insert(name).second) fail(robot_.file, "joint " + quoted(name) + " is named twice");
    }
    if (wanted.empty())
      for (const UrdfJoint& j : robot_.joints)
        if (j.kind != UrdfJoint::Kind::fixed) moving_.insert(j.name);
    for (const UrdfJoint& j : robot_.joints)
      if (!j.mimics.empty() && (moving_.contains(j.name) || moving_.contains(j.mimics)))
        fail(robot_.file, "joint " + quoted(j.name) + " mimics " + quoted(j.mimics) +
                              ", expected joints that move by themselves (or both held)");
    if (moving_.empty()) fail(robot_.file, "no joint that moves, expected at least one");
    if (moving_.size() > kMostJoints)
      fail(robot_.file, std::to_string(moving_.size()) + " joints that move, expected at most " +
                            std::to_string(kMostJoints) + " (name those that do)");
  }
  void check_holds() const {
    for (const auto& [name, position] : hold_) {
      const UrdfJoint& j = joint(name);
      if (moving_.contains(name) || j.kind == UrdfJoint::Kind::fixed)
        fail(robot_.file, "joint " + quoted(name) + (moving_.contains(name) ? " moves" : " is fixed") +
                              ", expected to be held one that else could move");
      if (!std::isfinite(position))
        fail(robot_.file,
             "joint " + quoted(name) + " is held at " + shortest(position) + ", expected a finite number");
    }
  }
  void place_links(const std::vector<const UrdfJoint*>& over) {
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      RobotTree::Link link{robot_.links[i].name, -1, {identity<double>(), {0.0, 0.0, 0.0}}};
      if (const UrdfJoint* j = over[i]) {
        const RobotTree::Link& parent = out_.links[j->parent];
        link.joint = parent.joint;
        if (moving_.contains(j->name)) {
          link.joint = static_cast<int>(out_.joints.size());
          out_.joints.push_back(
              {j->name, link.name, j->kind, within(parent.frame, j->placement), j->axis, j->limits});
          from_.push_back(j);
          parents_.push_back(parent.joint);
        } else {
          const auto held = hold_.find(j->name);
          link.frame = within(parent.frame, held_at(*j, held == hold_.end() ? 0.0 : held->second));
        }
      }
      out_.links.push_back(std::move(link));
    }
  }
  void add(std::size_t i, const Inertia<double>& body) {
    const RobotTree::Joint& j = out_.joints[i];
    if (!(body.mass_kg > 0.0))
      fail(robot_.file, "link " + quoted(j.link) + " moves (joint " + quoted(j.name) +
                            ") and neither it nor a link fixed to it has an <inertial>, expected one");
    const JointKind kind = j.kind == UrdfJoint::Kind::prismatic ? JointKind::prismatic : JointKind::revolute;
    if (out_.model.add({parents_[i], kind}, j.placement, j.axis, body) != Status::ok)
      fail(robot_.file, "joint " + quoted(j.name) + " has no place in the tree");
    auto& law = out_.model.laws[i];
    law.damping_nmspr = from_[i]->damping;
    law.friction_nm = from_[i]->friction;
  }

  const Urdf& robot_;
  const std::map<std::string, double>& hold_;
  RobotTree out_;
  std::set<std::string> moving_;
  std::vector<const UrdfJoint*> from_;
  std::vector<int> parents_;
};

}  // namespace

Urdf parse_urdf(std::string_view text, const std::string& name) {
  refuse_loops(check_xml(text, name), name);
  return Reader(text, name).read();
}

Urdf read_urdf(const std::string& path) {
  return parse_urdf(core::read_small_file(path, "a robot (URDF)"), path);
}

RobotTree tree_of(const Urdf& robot, const std::vector<std::string>& moving,
                  const std::map<std::string, double>& hold) {
  return TreeBuilder(robot, hold).build(moving);
}

}  // namespace furcula::model
