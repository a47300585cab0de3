// Reading by urdfdom, which is seen in this file alone; what it lets pass is checked here.
#include "host/model/urdf.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <set>

#include "furcula/dynamics/tree/inverse_dynamics.hpp"
#include "host/core/error.hpp"
#include "host/core/message.hpp"
#include "host/core/strict_toml.hpp"
#include "host/linear/linear.hpp"
#include "host/model/plausible.hpp"
#include "host/model/urdf_filter.hpp"
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

/// Ascending, with their axes in columns.
struct Principal {
  Eigen::Vector3d moments;
  Eigen::Matrix3d axes;
};
Principal principal(const Sym3<double>& s) {
  Eigen::Matrix3d m;
  m << s.xx, s.xy, s.xz, s.xy, s.yy, s.yz, s.xz, s.yz, s.zz;
  const linear::Axes3 axes = linear::axes_of_three(m);
  return {axes.values, axes.vectors};
}

/// What single precision, in which programs compute moments, and their axes' turns leave of them: some ten times 6e-8.
constexpr double kRounding = 1e-6;

/// By how much the largest moment is more than the sum of the others.
double beyond_triangle(const Eigen::Vector3d& moments) { return moments(2) - moments(1) - moments(0); }
bool is_possible(const Eigen::Vector3d& moments, double error) {
  return moments(0) >= -error && beyond_triangle(moments) <= error;
}
bool is_possible(const Eigen::Vector3d& moments) {
  return is_possible(moments, kRounding * std::max(moments(2), 0.0));
}

/// Moves moments that are below 0, or off the triangle inequality, by no more than they are rounded, to its limit. An error E of the six numbers
/// moves a moment of axis v by v'Ev, and what is beyond the triangle, 2 v'Iv - trace I, by the sum of (2 vv' - 1) E.
bool repair(UrdfInertia& body, const std::array<double, 6>& rounding) {
  Principal p = principal(body.about_centre_kgm2);
  const double largest = p.moments(2);
  if (!(largest > 0.0)) return false;
  Eigen::Matrix3d error;
  error << rounding[0], rounding[1], rounding[2], rounding[1], rounding[3], rounding[4], rounding[2],
      rounding[4], rounding[5];
  const auto moved_by = [&](const Eigen::Matrix3d& weights) {
    return weights.cwiseAbs().cwiseProduct(error).sum();
  };
  bool repaired = false;
  for (int k = 0; k < 2; ++k) {
    if (p.moments(k) >= 0.0) continue;
    const double most = std::max(kRounding * largest, moved_by(p.axes.col(k) * p.axes.col(k).transpose()));
    if (-p.moments(k) > most) return false;
    p.moments(k) = 0.0;
    repaired = true;
  }
  const double beyond = beyond_triangle(p.moments);
  const Eigen::Vector3d axis = p.axes.col(2);
  // Equal to it but for the last bit of a decimal.
  constexpr double kLastBit = 1e-9;
  if (beyond > kRounding * largest &&
      beyond <= (1.0 + kLastBit) * moved_by(2.0 * axis * axis.transpose() - Eigen::Matrix3d::Identity())) {
    p.moments += Eigen::Vector3d(beyond / 3.0, beyond / 3.0, -beyond / 3.0);
    repaired = true;
  }
  if (!repaired) return false;
  const Eigen::Matrix3d m = p.axes * p.moments.asDiagonal() * p.axes.transpose();
  body.about_centre_kgm2 = {m(0, 0), m(0, 1), m(0, 2), m(1, 1), m(1, 2), m(2, 2)};
  return true;
}

class Reader {
 public:
  Reader(FilteredUrdf filtered, const std::string& name)
      : filtered_(std::move(filtered)), robot_(parsed(filtered_.text, name)) {
    out_.file = name;
  }

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
    out_.closures = std::move(filtered_.closures);
    out_.notes = std::move(filtered_.notes);
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
    const FilteredLink& from = filtered_.links[link.name];
    UrdfLink out{link.name, inertia(link), from.line, from.flaw, false};
    if (out.inertia) out.repaired = repair(*out.inertia, from.rounding_kgm2);
    out_.links.push_back(std::move(out));
    ahead_.insert(ahead_.end(), link.child_joints.rbegin(), link.child_joints.rend());
  }
  std::optional<UrdfInertia> inertia(const urdf::Link& link) const {
    if (!link.inertial) return std::nullopt;
    const urdf::Inertial& i = *link.inertial;
    const std::string what = "link " + quoted(link.name);
    const std::string moment = what + ": its <inertia>";
    return UrdfInertia{finite(i.mass, what + ": its <mass>"),
                       frame(i.origin, what + ": its <inertial>"),
                       {finite(i.ixx, moment), finite(i.ixy, moment), finite(i.ixz, moment),
                        finite(i.iyy, moment), finite(i.iyz, moment), finite(i.izz, moment)}};
  }
  void add(const urdf::Joint& joint) {
    const std::string what = "joint " + quoted(joint.name);
    static_cast<void>(word(joint.name, "a joint's name"));
    const FilteredJoint& from = filtered_.joints[joint.name];
    UrdfJoint out;
    out.name = joint.name;
    out.kind = from.kind;
    out.parent = index_.at(joint.parent_link_name);
    out.placement = frame(joint.parent_to_joint_origin_transform, what);
    out.axis = {0.0, 0.0, 1.0};
    if (out.kind != UrdfJoint::Kind::fixed && out.kind != UrdfJoint::Kind::other) {
      const Vec3<double> axis = finite(joint.axis, what + ": its <axis>");
      out.axis = axis * (1.0 / std::sqrt(dot(axis, axis)));
    }
    out.limits = from.limits;
    out.damping = from.damping;
    out.friction = from.friction;
    out.mimics = from.mimics;
    out.line = from.line;
    out.type = from.type;
    out.flaw = from.flaw;
    out.limit_flaw = from.limit_flaw;
    out.reduction = from.reduction;
    out.rotor_inertia_kgm2 = from.rotor_inertia_kgm2;
    out.spring_nmprad = from.spring_nmprad;
    out.spring_rest_rad = from.spring_rest_rad;
    out.child = out_.links.size();
    add(*robot_->links_.at(joint.child_link_name));
    out_.joints.push_back(std::move(out));
  }

  FilteredUrdf filtered_;
  urdf::ModelInterfaceSharedPtr robot_;
  Urdf out_;
  std::map<std::string, std::size_t> index_;  ///< of links
  std::vector<urdf::JointSharedPtr> ahead_;
};

bool can_move(const UrdfJoint& j) {
  return j.kind != UrdfJoint::Kind::fixed && j.kind != UrdfJoint::Kind::other;
}
const UrdfJoint* found(const Urdf& robot, const std::string& name) {
  for (const UrdfJoint& j : robot.joints)
    if (j.name == name) return &j;
  return nullptr;
}
/// Those that follow another joint, and those that are followed.
std::set<std::string> tied_joints(const Urdf& robot) {
  std::set<std::string> out;
  for (const UrdfJoint& j : robot.joints)
    if (!j.mimics.empty() && can_move(j)) {
      out.insert(j.name);
      if (found(robot, j.mimics) != nullptr) out.insert(j.mimics);
    }
  return out;
}
/// `joints = ["a", "b"]`, as a model file has it.
std::string joints_line(const std::vector<std::string>& names) {
  std::string out = "joints = [";
  for (std::size_t i = 0; i < names.size(); ++i)
    out += (i == 0 ? "\"" : ", \"") + core::printable(names[i]) + "\"";
  return out + "]";
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

constexpr const char* kAcceptThem =
    " (--accept-inertias, or accept_inertias = true in [model], takes it as it is)";

class TreeBuilder {
 public:
  TreeBuilder(const Urdf& robot, const std::map<std::string, double>& hold, const TreeOptions& options)
      : robot_(robot), hold_(hold), options_(options) {}

  RobotTree build(const std::vector<std::string>& wanted) {
    choose(wanted);
    check_holds();
    out_.name = robot_.name;
    if (robot_.is_mjcf) out_.model.gravity_mps2 = robot_.gravity_mps2;
    std::vector<const UrdfJoint*> over(robot_.links.size(), nullptr);  // the joint of each link
    for (const UrdfJoint& j : robot_.joints) over[j.child] = &j;
    place_links(over);
    check_closures();
    std::vector<Inertia<double>> bodies(out_.joints.size());
    for (std::size_t i = 0; i < robot_.links.size(); ++i) {
      const RobotTree::Link& at = out_.links[i];
      if (at.joint < 0) continue;
      if (!robot_.links[i].flaw.empty()) throw core::DataError(robot_.links[i].flaw);
      if (!robot_.links[i].inertia) continue;
      auto& body = bodies[static_cast<std::size_t>(at.joint)];
      body = body + inertia_back(at.frame, judged(i));
    }
    for (std::size_t i = 0; i < out_.joints.size(); ++i) judge_body(i, bodies[i]);
    for (std::size_t i = 0; i < out_.joints.size(); ++i) add(i, bodies[i]);
    note_joints();
    note_bodies();
    judge_units(out_, robot_, options_.accept_inertias);
    if (options_.judge_motion) require_joint_inertia(out_, robot_.file);
    return std::move(out_);
  }

 private:
  /// At a link, joint or closure.
  template <class Element>
  [[noreturn]] void fail_at(const Element& at, const std::string& message) const {
    fail((at.file.empty() ? robot_.file : at.file) + ":" + std::to_string(at.line), message);
  }
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
  /// What to write instead: those of the joints that move by themselves.
  std::string instead(const std::vector<std::string>& wanted) const {
    const std::set<std::string> tied = tied_joints(robot_);
    std::vector<std::string> rest;
    for (const std::string& name : wanted)
      if (const UrdfJoint* j = found(robot_, name); j != nullptr && can_move(*j) && !tied.contains(name))
        rest.push_back(name);
    if (rest.empty()) rest = default_joints(robot_, hold_);
    if (rest.empty()) return "";
    return ": write " + joints_line(rest) + " in [model], and the others are held";
  }
  void choose(const std::vector<std::string>& wanted) {
    for (const std::string& name : wanted) {
      const UrdfJoint& j = joint(name);
      if (!can_move(j))
        fail_at(j, "joint " + quoted(name) + " is " + core::printable(j.type) +
                       ", expected one that moves (revolute, continuous or prismatic)" + instead(wanted));
      if (!moving_.insert(name).second) fail(robot_.file, "joint " + quoted(name) + " is named twice");
    }
    if (wanted.empty())
      for (const std::string& name : default_joints(robot_, hold_)) moving_.insert(name);
    for (const UrdfJoint& j : robot_.joints) {
      if (j.mimics.empty() || !can_move(j)) continue;
      if (moving_.contains(j.name) && found(robot_, j.mimics) == nullptr)
        fail_at(
            j,
            "joint " + quoted(j.name) + " mimics " + quoted(j.mimics) +
                ", which is no joint of the robot; expected no <mimic> if it moves by itself, or the joint held" +
                instead(wanted));
      if (moving_.contains(j.name) || moving_.contains(j.mimics))
        fail_at(j, "joint " + quoted(j.name) + " mimics " + quoted(j.mimics) +
                       ", expected joints that move by themselves (or both held)" + instead(wanted));
    }
    if (moving_.empty()) {
      const bool tied = !tied_joints(robot_).empty();
      fail(robot_.file, "no joint that moves" + std::string(tied ? " by itself" : "") +
                            ", expected at least one" +
                            (tied ? " that mimics no other and is mimicked by none" : ""));
    }
    if (moving_.size() > kMostJoints)
      fail(robot_.file, std::to_string(moving_.size()) + " joints that move, expected at most " +
                            std::to_string(kMostJoints) +
                            " (joints = [...] in [model] names those that do, the others are held)");
    for (const UrdfJoint& j : robot_.joints) {
      const auto held = hold_.find(j.name);
      const bool at_zero = held == hold_.end() || held->second == 0.0;
      if (!j.flaw.empty() && (moving_.contains(j.name) || !at_zero)) throw core::DataError(j.flaw);
    }
  }
  void check_holds() const {
    for (const auto& [name, position] : hold_) {
      const UrdfJoint& j = joint(name);
      if (moving_.contains(name))
        fail(robot_.file, "joint " + quoted(name) +
                              " moves, expected to be held one that else could move (take it out of "
                              "[locked_joints], or out of joints in [model])");
      if (j.kind == UrdfJoint::Kind::other)
        fail(robot_.file, "joint " + quoted(name) + " is " + core::printable(j.type) +
                              ": such a joint is held at 0 without an entry; take it out of [locked_joints]" +
                              (position == 0.0 ? "" : ", and put a place that is not 0 into its <origin>"));
      if (!can_move(j))
        fail(robot_.file, "joint " + quoted(name) + " is " + core::printable(j.type) +
                              " and stays where it is without an entry; take it out of [locked_joints]");
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
  /// What joins two links that move against each other, or links that are not known, changes the dynamics.
  void check_closures() {
    std::vector<std::string> rigid, others;
    std::vector<const UrdfClosure*> torn;
    for (const UrdfClosure& c : robot_.closures) {
      std::set<int> bodies;
      for (const std::string& name : c.links) {
        int body = -1;
        for (const RobotTree::Link& l : out_.links)
          if (l.name == name) body = l.joint;
        bodies.insert(body);
      }
      const std::string title = "<" + c.tag + "> in line " + std::to_string(c.line);
      if (c.links.size() >= 2 && bodies.size() == 1) {
        rigid.push_back(title);
        continue;
      }
      if (!torn.empty()) others.push_back(title);
      torn.push_back(&c);
    }
    if (!torn.empty()) {
      const UrdfClosure& c = *torn[0];
      std::vector<std::string> names;
      for (const std::string& name : c.links) names.push_back(name.empty() ? "the world" : quoted(name));
      // Of MJCF; a URDF's closures have other names.
      const bool is_tendon = c.tag.starts_with("fixed") || c.tag.starts_with("spatial");
      std::string message = "<" + c.tag + ">";
      if (names.size() >= 2)
        message += " joins the links " + first_names(names) + ", which move against each other";
      else
        message += " joins links that are not known";
      std::vector<std::string> outside;
      for (const RobotTree::Joint& j : out_.joints)
        if (std::none_of(torn.begin(), torn.end(),
                         [&](const UrdfClosure* t) { return is_within(*t, j.name); }))
          outside.push_back(j.name);
      message +=
          is_tendon
              ? ": a tendon is not supported, expected forces on joints alone; hold the joints that it acts across"
              : ": a closed loop is not supported, expected a tree of joints; hold the joints within the loop";
      message += outside.empty() || outside.size() == out_.joints.size()
                     ? " (joints = [...] in [model] names those that move)"
                     : " (" + joints_line(outside) + " in [model])";
      message += ", or take the element out of the file where the robot has no such " +
                 std::string(is_tendon ? "tendon" : "loop");
      if (!others.empty())
        message += "; so with " + first_names(others) +
                   (outside.empty() ? "" : ", for which these joints are held, too");
      fail_at(c, message);
    }
    if (!rigid.empty())
      out_.notes.push_back("No joint within the loop moves that is closed by " + first_names(rigid) +
                           ": left out.");
  }
  /// Whether a joint is on the way between the links of a loop.
  bool is_within(const UrdfClosure& c, const std::string& name) const {
    // Beyond it are some of the links, and not all.
    std::size_t beyond = 0;
    for (const std::string& link : c.links) {
      int at = -1;
      for (const RobotTree::Link& l : out_.links)
        if (l.name == link) at = l.joint;
      while (at >= 0 && out_.joints[static_cast<std::size_t>(at)].name != name)
        at = parents_[static_cast<std::size_t>(at)];
      beyond += at >= 0 ? 1 : 0;
    }
    return beyond > 0 && beyond < c.links.size();
  }

  std::string link_at(std::size_t i) const { return "link " + quoted(robot_.links[i].name); }
  static std::string listed(const Eigen::Vector3d& m) {
    return core::rounded(m(0)) + ", " + core::rounded(m(1)) + ", " + core::rounded(m(2));
  }
  /// Of a link that moves: about its own frame.
  Inertia<double> judged(std::size_t i) {
    const UrdfLink& link = robot_.links[i];
    const UrdfInertia& b = *link.inertia;
    if (b.mass_kg < 0.0) {
      if (!options_.accept_inertias)
        fail_at(link, link_at(i) + ": its <mass> is " + shortest(b.mass_kg) + ", expected at least 0" +
                          kAcceptThem);
      accepted_.push_back("the <mass> " + shortest(b.mass_kg) + " of " + link_at(i));
    }
    const Eigen::Vector3d moments = principal(b.about_centre_kgm2).moments;
    if (!is_possible(moments)) impossible_.push_back(i);
    if (link.repaired) repaired_.push_back(quoted(link.name));
    if (b.mass_kg == 0.0 && moments.cwiseAbs().maxCoeff() > 0.0) massless_.push_back(quoted(link.name));
    return inertia_back(
        b.frame, dynamics::tree::inertia_of(b.mass_kg, Vec3<double>{0.0, 0.0, 0.0}, b.about_centre_kgm2));
  }
  /// Links that are fixed to each other are one body. A sum of bodies is one, so only where one of them is none can theirs be none.
  void judge_body(std::size_t joint, const Inertia<double>& body) {
    std::vector<std::size_t> wrong;
    for (const std::size_t i : impossible_)
      if (out_.links[i].joint == static_cast<int>(joint)) wrong.push_back(i);
    if (wrong.empty()) return;
    const Sym3<double>& o = body.inertia_kgm2;
    Sym3<double> about = o;
    if (body.mass_kg != 0.0) {
      const Sym3<double> s = dynamics::tree::minus_squared_cross(body.moment_kgm * (1.0 / body.mass_kg));
      const double m = body.mass_kg;
      about = {o.xx - m * s.xx, o.xy - m * s.xy, o.xz - m * s.xz,
               o.yy - m * s.yy, o.yz - m * s.yz, o.zz - m * s.zz};
    }
    const Eigen::Vector3d moments = principal(about).moments;
    // What is left of the difference of two large numbers, in double precision.
    constexpr double kCancelled = 1e-12;
    if (is_possible(moments,
                    kRounding * std::max(moments(2), 0.0) + kCancelled * std::abs(o.xx + o.yy + o.zz))) {
      for (const std::size_t i : wrong) merged_.push_back(quoted(robot_.links[i].name));
      return;
    }
    const auto shortfall = [&](std::size_t i) {
      const Eigen::Vector3d m = principal(robot_.links[i].inertia->about_centre_kgm2).moments;
      return std::max(-m(0), beyond_triangle(m));
    };
    const std::size_t worst =
        *std::max_element(wrong.begin(), wrong.end(),
                          [&](std::size_t a, std::size_t b) { return shortfall(a) < shortfall(b); });
    const Eigen::Vector3d m = principal(robot_.links[worst].inertia->about_centre_kgm2).moments;
    const std::string what =
        link_at(worst) + ": its <inertia> has the principal moments " + listed(m) + " kg m^2, ";
    if (!options_.accept_inertias)
      fail_at(robot_.links[worst],
              what +
                  (m(0) < -kRounding * std::max(m(2), 0.0)
                       ? "expected none below 0"
                       : "which no body has; expected that none is more than the sum of the other two") +
                  kAcceptThem);
    accepted_.push_back("the <inertia> of " + link_at(worst));
  }
  void note_joints() {
    std::vector<std::string> others, unknown, ranges, reductions;
    for (const UrdfJoint& j : robot_.joints) {
      if (j.kind == UrdfJoint::Kind::other)
        others.push_back(quoted(j.name) + " (" + core::printable(j.type) + ")");
      if (!j.mimics.empty() && found(robot_, j.mimics) == nullptr)
        unknown.push_back(quoted(j.name) + " (" + quoted(j.mimics) + ")");
    }
    for (const UrdfJoint* j : from_) {
      if (!j->limit_flaw.empty())
        ranges.push_back(quoted(j->name) + " (" + core::printable(j->limit_flaw) + ")");
      if (j->reduction != 0.0 && j->reduction != 1.0)
        reductions.push_back(quoted(j->name) + " (" + shortest(j->reduction) + ")");
    }
    if (!others.empty()) out_.notes.push_back("Held at 0: joint " + first_names(others) + ".");
    if (!unknown.empty())
      out_.notes.push_back("Held, its <mimic> of a joint that the robot does not have is left out: " +
                           first_names(unknown) + ".");
    if (!ranges.empty())
      out_.notes.push_back("Without a range, its <limit> is not used: joint " + first_names(ranges) + ".");
    if (!reductions.empty())
      out_.notes.push_back(
          "A <transmission> has a reduction: joint " + first_names(reductions) +
          ". Torque and rotor inertia of the model are at the joint: the motor's times the reduction, and times its square.");
  }
  void note_bodies() {
    const auto note = [&](const std::string& what, const std::vector<std::string>& names,
                          const std::string& after) {
      if (!names.empty()) out_.notes.push_back(what + first_names(names) + after);
    };
    std::vector<std::string> empty;
    for (std::size_t i = 0; i < out_.joints.size(); ++i) {
      bool any = false;
      for (std::size_t k = 0; k < robot_.links.size(); ++k)
        any |= out_.links[k].joint == static_cast<int>(i) && robot_.links[k].inertia.has_value();
      const UrdfLink& link = robot_.links[from_[i]->child];
      if (!any && !link.between_joints) empty.push_back(quoted(out_.joints[i].link));
    }
    note("No <inertial>, moves without mass: link ", empty, ".");
    note("An <inertia> and no mass: link ", massless_, ". The inertia is kept.");
    note(
        "Moments of inertia were off by less than they are rounded, and are moved to the nearest that a body has: link ",
        repaired_, ".");
    note("Moments of inertia that no body has alone: link ", merged_,
         ". Together with the links that it is fixed to it is one.");
    note("Accepted as they are: ", accepted_, ".");
  }
  void add(std::size_t i, const Inertia<double>& body) {
    const RobotTree::Joint& j = out_.joints[i];
    const JointKind kind = j.kind == UrdfJoint::Kind::prismatic ? JointKind::prismatic : JointKind::revolute;
    if (out_.model.add({parents_[i], kind}, j.placement, j.axis, body) != Status::ok)
      fail(robot_.file, "joint " + quoted(j.name) + " has no place in the tree");
    auto& law = out_.model.laws[i];
    law.damping_nmspr = from_[i]->damping;
    law.friction_nm = from_[i]->friction;
    if (!robot_.is_mjcf) return;
    law.armature_kgm2 = from_[i]->rotor_inertia_kgm2;
    law.stiffness_nmprad = from_[i]->spring_nmprad;
    law.rest_rad = from_[i]->spring_rest_rad;
  }

  const Urdf& robot_;
  const std::map<std::string, double>& hold_;
  const TreeOptions& options_;
  RobotTree out_;
  std::set<std::string> moving_;
  std::vector<const UrdfJoint*> from_;
  std::vector<int> parents_;
  std::vector<std::size_t> impossible_;  ///< links
  std::vector<std::string> repaired_, merged_, massless_, accepted_;
};

/// The joint-space inertia at a pose, scaled by what each joint could have at most.
struct JointInertia {
  double least =
      0.0;  ///< eigenvalue, the matrix scaled to a diagonal of ones; 0 where a joint has none at all
  std::size_t joint = 0;  ///< that lacks it
  bool negative = false;
};
JointInertia joint_inertia(const RobotModel& model, const RobotModel::Joints& q) {
  const auto h = dynamics::tree::mass_matrix(model, q);
  const std::size_t n = model.count();
  // Of a revolute joint: the trace of all that is outwards of it, about its origin. That of some other axis there is at least half of it.
  std::vector<Inertia<double>> composite(n);
  std::vector<double> most(n);
  for (std::size_t i = n; i-- > 0;) {
    composite[i] = composite[i] + model.aligned_inertia(i);
    const Inertia<double>& c = composite[i];
    most[i] = model.laws[i].armature_kgm2 +
              (model.shape().kind(i) == JointKind::prismatic
                   ? std::abs(c.mass_kg)
                   : std::abs(c.inertia_kgm2.xx) + std::abs(c.inertia_kgm2.yy) + std::abs(c.inertia_kgm2.zz));
    if (const int p = model.shape().parent(i); p >= 0) {
      auto& up = composite[static_cast<std::size_t>(p)];
      up = up + inertia_back(model.frame(i, q[i]), c);
    }
  }
  // Sums of n products of doubles: what is less is zero.
  constexpr double kZero = 1e-12;
  JointInertia out{1.0, 0, false};
  for (std::size_t i = 0; i < n; ++i)
    if (!(h[i][i] > kZero * most[i])) return {0.0, i, h[i][i] < -kZero * most[i]};
  Eigen::MatrixXd scaled(n, n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < n; ++k)
      scaled(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k)) =
          h[i][k] / std::sqrt(h[i][i] * h[k][k]);
  const linear::Axes axes = linear::axes(scaled);
  out.least = axes.values(0);
  Eigen::Index worst = 0;
  axes.vectors.col(0).cwiseAbs().maxCoeff(&worst);
  out.joint = static_cast<std::size_t>(worst);
  return out;
}

/// Files that come in the place of a URDF when it is downloaded or linked: each with what to do.
void refuse_other_files(std::string_view text, const std::string& name) {
  constexpr std::string_view kBlank = " \t\r\n";
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const std::size_t first = text.find_first_not_of(kBlank);
  const auto refuse = [&](const std::string& what) {
    const auto lines = std::count(
        text.begin(), text.begin() + static_cast<std::ptrdiff_t>(std::min(first, text.size())), '\n');
    fail(name + ":" + std::to_string(lines + 1), what);
  };
  if (first == text.npos)
    refuse("the file has nothing but blanks, expected a robot (URDF); copy the robot's file here again");
  std::string begin(text.substr(first, 4096));
  std::transform(begin.begin(), begin.end(), begin.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  // Comments and the like may stand before the first element.
  std::string_view rest = begin;
  while (rest.starts_with("<!--") || rest.starts_with("<?")) {
    const std::string_view end = rest.starts_with("<?") ? "?>" : "-->";
    const std::size_t at = rest.find(end);
    rest = at == rest.npos ? std::string_view{} : rest.substr(at + end.size());
    rest.remove_prefix(std::min(rest.find_first_not_of(kBlank), rest.size()));
  }
  const auto is_tag = [&](std::string_view tag) {
    return rest.starts_with(tag) &&
           (rest.size() == tag.size() || std::string_view(" \t\r\n>/").find(rest[tag.size()]) != rest.npos);
  };
  if (is_tag("<!doctype html") || is_tag("<html") || is_tag("<head") || is_tag("<body"))
    refuse(
        "a web page (HTML), expected a URDF; it was downloaded from a page that shows the file: download the file itself "
        "(\"Raw\" on the page, or git clone)");
  if (begin.starts_with("version https://git-lfs"))
    refuse("a pointer of Git LFS, expected a URDF; git lfs pull fetches the file itself");
  if (begin.starts_with("404"))
    refuse("the answer of a server that has no such file, " + quoted(text.substr(first, 40)) +
           ", expected a URDF; download it again from its right address");
  // What a link is where a system has none, or a page shows it.
  const std::string_view line = text.substr(first, text.find_last_not_of(kBlank) + 1 - first);
  if (line.size() < 256 && line.find_first_of("<> \t\r\n") == line.npos &&
      (line.ends_with(".urdf") || line.ends_with(".xacro") || line.ends_with(".xml")))
    refuse("nothing but a path, " + quoted(line) +
           ", expected a URDF; the file is a link to that one: name that one in urdf of [model]");
}

}  // namespace

Urdf parse_urdf(std::string_view text, const std::string& name) {
  refuse_other_files(text, name);
  return Reader(filter_urdf(check_xml(text, name), name), name).read();
}

Urdf read_urdf(const std::string& path) {
  return parse_urdf(core::read_small_file(path,
                                          "a robot (URDF); copy the robot's file here again, or let xacro "
                                          "write it, and see that urdf in [model] names it"),
                    path);
}

RobotTree tree_of(const Urdf& robot, const std::vector<std::string>& moving,
                  const std::map<std::string, double>& hold, const TreeOptions& options) {
  return TreeBuilder(robot, hold, options).build(moving);
}

std::vector<std::string> default_joints(const Urdf& robot, const std::map<std::string, double>& hold) {
  const std::set<std::string> tied = tied_joints(robot);
  std::vector<std::string> out;
  for (const UrdfJoint& j : robot.joints)
    if (can_move(j) && !tied.contains(j.name) && !hold.contains(j.name)) out.push_back(j.name);
  return out;
}

void require_joint_inertia(RobotTree& tree, const std::string& file, const std::vector<double>& rotors_kgm2) {
  RobotModel model = tree.model;
  for (std::size_t i = 0; i < rotors_kgm2.size(); ++i) model.laws[i].armature_kgm2 = rotors_kgm2[i];
  // Below, more than nine of the sixteen digits of an acceleration are lost, and it is coarser than an encoder of 24 bits.
  constexpr double kRegular = 1e-9;
  // A singular pose may lie among regular ones (a wrist whose axes line up). It is the dynamics that are singular where all poses are.
  constexpr int kPoses = 5;
  constexpr double kGolden = 0.6180339887498949, kPlastic = 0.7548776662466927;
  JointInertia best = joint_inertia(model, {});
  const JointInertia at_zero = best;
  for (int pose = 1; pose < kPoses; ++pose) {
    RobotModel::Joints q{};
    for (std::size_t i = 0; i < model.count(); ++i) {
      const double share = std::fmod(pose * kGolden + static_cast<double>(i) * kPlastic, 1.0);
      const auto& l = tree.joints[i].limits;
      const bool slides = tree.joints[i].kind == UrdfJoint::Kind::prismatic;
      double lower = slides ? -1.0 : -3.0, upper = -lower;
      if (l && l->lower < l->upper) {
        lower = std::max(lower, l->lower);
        upper = std::min(upper, l->upper);
      }
      q[i] = lower + share * (upper - lower);
    }
    const JointInertia here = joint_inertia(model, q);
    if (here.negative || here.least < -kRegular) {
      best = {here.least, here.joint, true};
      break;
    }
    if (here.least > best.least) best = here;
  }
  const auto who = [&](const JointInertia& j) { return "joint " + quoted(tree.joints[j.joint].name); };
  const auto drive = [&](const JointInertia& j) {
    return "rotor_inertia_kgm2 in [drive." + core::printable(tree.joints[j.joint].name) +
           "] of the model file";
  };
  if (best.negative || !(best.least > kRegular)) {
    const std::string link = quoted(tree.joints[best.joint].link);
    fail(file,
         "link " + link + " moves (" + who(best) + ") and " +
             (best.negative ? "its inertia about the joint is below 0"
                            : "nothing gives the joint an inertia: not it, no link beyond it, no rotor") +
             "; expected an <inertial> that does, or " + drive(best) +
             " above 0, or the joint held (not in joints = [...])");
  }
  if (at_zero.least <= kRegular)
    tree.notes.push_back("With all joints at 0 nothing gives " + who(at_zero) +
                         " an inertia of its own, and its motion is not determined there; " + drive(at_zero) +
                         " gives it one.");
}

}  // namespace furcula::model
