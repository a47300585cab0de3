// Writing MJCF, see mjcf.hpp.
#include "host/model/mjcf.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "host/core/markup.hpp"
#include "host/core/message.hpp"
#include "host/linear/linear.hpp"

namespace furcula::model {
namespace {

using core::shortest;
using dynamics::tree::Inertia;
using dynamics::tree::Mat3;

std::string escaped(const std::string& text) { return core::escape(core::printable(text)); }
std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + value + "\"";
}
std::string attribute(const char* name, double value) { return attribute(name, shortest(value)); }
std::string attribute(const char* name, const Vec3<double>& v) {
  return attribute(name, shortest(v.x) + " " + shortest(v.y) + " " + shortest(v.z));
}

/// Position, and the quaternion (w x y z) that takes the frame's coordinates to the parent's.
std::string place(const Frame<double>& f) {
  const Mat3<double>& e = f.turn;  // parent's to frame's: the transposed
  // The largest part first: the others are divided by it.
  const double squares[4] = {1 + e.x.x + e.y.y + e.z.z, 1 + e.x.x - e.y.y - e.z.z, 1 - e.x.x + e.y.y - e.z.z,
                             1 - e.x.x - e.y.y + e.z.z};
  const auto largest = std::max_element(squares, squares + 4) - squares;
  const double wx = e.y.z - e.z.y, wy = e.z.x - e.x.z, wz = e.x.y - e.y.x;
  const double xy = e.x.y + e.y.x, xz = e.x.z + e.z.x, yz = e.y.z + e.z.y;
  const double rows[4][4] = {
      {squares[0], wx, wy, wz}, {wx, squares[1], xy, xz}, {wy, xy, squares[2], yz}, {wz, xz, yz, squares[3]}};
  const double scale = 0.5 / std::sqrt(squares[largest]);
  std::string quaternion;
  for (const double part : rows[largest])
    quaternion += (quaternion.empty() ? "" : " ") + shortest(part * scale);
  return attribute("pos", f.at) + attribute("quat", quaternion);
}

/// Moments as MuJoCo takes them: above mjMINVAL (1e-15), and none more than the sum of the others. Those of points, rods, sheets and bodies
/// without mass are raised by what no simulation sees; all others stay bit by bit.
void raise(Eigen::Matrix3d& about_centre) {
  constexpr double kLeast = 1e-12, kShare = 1e-9;
  const linear::Axes3 axes = linear::axes_of_three(about_centre);
  Eigen::Vector3d m = axes.values;
  if (m(0) >= kLeast && m(0) + m(1) >= m(2) * (1.0 + kShare)) return;
  const double least = std::max(kLeast, kShare * m(2));
  m = m.cwiseMax(least);
  if (const double beyond = m(2) * (1.0 + 2.0 * kShare) - m(0) - m(1); beyond > 0.0) {
    m(0) += 0.5 * beyond;
    m(1) += 0.5 * beyond;
  }
  about_centre = axes.vectors * m.asDiagonal() * axes.vectors.transpose();
}

std::string inertial(const Inertia<double>& b) {
  constexpr double kLeast_kg = 1e-12;
  const bool weighs = b.mass_kg > kLeast_kg;
  const Vec3<double> c = weighs ? b.moment_kgm * (1.0 / b.mass_kg) : Vec3<double>{0.0, 0.0, 0.0};
  const Sym3<double>& o = b.inertia_kgm2;
  const Sym3<double> s = dynamics::tree::minus_squared_cross(c);
  const double m = b.mass_kg;
  Eigen::Matrix3d about;
  about << o.xx - s.xx * m, o.xy - s.xy * m, o.xz - s.xz * m, o.xy - s.xy * m, o.yy - s.yy * m,
      o.yz - s.yz * m, o.xz - s.xz * m, o.yz - s.yz * m, o.zz - s.zz * m;
  raise(about);
  const double full[6] = {about(0, 0), about(1, 1), about(2, 2), about(0, 1), about(0, 2), about(1, 2)};
  std::string text;
  for (const double part : full) text += (text.empty() ? "" : " ") + shortest(part);
  return "<inertial" + attribute("pos", c) + attribute("mass", weighs ? m : kLeast_kg) +
         attribute("fullinertia", text) + "/>\n";
}

class Writer {
 public:
  Writer(const RobotTree& robot, const std::vector<PositionGains>& gains) : robot_(robot), gains_(gains) {}

  std::string write() {
    out_ = "<mujoco" + attribute("model", escaped(robot_.name)) + ">\n";
    note_what_is_excluded();
    out_ += "  <compiler angle=\"radian\"/>\n  <option" + attribute("gravity", robot_.model.gravity_mps2) +
            "/>\n  <worldbody>\n";
    sites(-1, "    ");
    for (std::size_t i = 0; i < robot_.joints.size(); ++i)
      if (robot_.model.shape().parent(i) < 0) body(i, "    ");
    out_ += "  </worldbody>\n  <actuator>\n";
    for (const RobotTree::Joint& j : robot_.joints) actuator(j);
    return out_ + "  </actuator>\n</mujoco>\n";
  }

 private:
  void note_what_is_excluded() {
    for (std::size_t i = 0; i < robot_.joints.size(); ++i) {
      const auto& law = robot_.model.laws[i];
      std::string name = core::printable(robot_.joints[i].name);
      std::replace(name.begin(), name.end(), '-', '_');  // a comment holds no two hyphens
      if (law.static_friction_nm > law.friction_nm)
        out_ += "  <!-- " + name + ": static friction " + shortest(law.static_friction_nm) +
                " is more than MJCF holds -->\n";
      if (law.elastic)
        out_ += "  <!-- " + name + ": the drive's stiffness " + shortest(law.drive_stiffness_nmprad) +
                " is left out; its rotor counts as the joint's -->\n";
    }
  }
  void sites(int joint, const std::string& indent) {
    for (const RobotTree::Link& link : robot_.links)
      if (link.joint == joint &&
          (joint < 0 || link.name != robot_.joints[static_cast<std::size_t>(joint)].link))
        out_ += indent + "<site" + attribute("name", escaped(link.name)) + place(link.frame) + "/>\n";
  }
  // The depth of bodies within each other is at most kMostJoints.
  void body(std::size_t i, const std::string& indent) {  // NOLINT(misc-no-recursion)
    const RobotTree::Joint& j = robot_.joints[i];
    const auto& law = robot_.model.laws[i];
    const std::string in = indent + "  ";
    const bool slides = j.kind == UrdfJoint::Kind::prismatic;
    out_ += indent + "<body" + attribute("name", escaped(j.link)) + place(j.placement) + ">\n";
    out_ += in + inertial(robot_.model.body(i));
    out_ += in + "<joint" + attribute("name", escaped(j.name)) +
            attribute("type", slides ? "slide" : "hinge") + attribute("axis", j.axis) +
            attribute("armature", law.armature_kgm2) + attribute("damping", law.damping_nmspr) +
            attribute("frictionloss", law.friction_nm);
    if (law.stiffness_nmprad != 0.0)
      out_ += attribute("stiffness", law.stiffness_nmprad) + attribute("springref", law.rest_rad);
    if (j.limits && j.limits->lower < j.limits->upper && j.kind != UrdfJoint::Kind::continuous)
      out_ += attribute("limited", "true") +
              attribute("range", shortest(j.limits->lower) + " " + shortest(j.limits->upper));
    out_ += "/>\n";
    sites(static_cast<int>(i), in);
    for (std::size_t k = i + 1; k < robot_.joints.size(); ++k)
      if (robot_.model.shape().parent(k) == static_cast<int>(i)) body(k, in);
    out_ += indent + "</body>\n";
  }
  void actuator(const RobotTree::Joint& j) {
    const auto gains =
        std::find_if(gains_.begin(), gains_.end(), [&](const PositionGains& g) { return g.joint == j.name; });
    const std::string names = attribute("name", escaped(j.name)) + attribute("joint", escaped(j.name));
    if (gains == gains_.end()) {
      out_ += "    <motor" + names + "/>\n";
      return;
    }
    out_ += "    <general" + names + attribute("biastype", "affine") +
            attribute("gainprm", gains->kp_nmprad) +
            attribute("biasprm", "0 " + shortest(-gains->kp_nmprad) + " " + shortest(-gains->kd_nmsprad)) +
            "/>\n";
  }

  const RobotTree& robot_;
  const std::vector<PositionGains>& gains_;
  std::string out_;
};

}  // namespace

std::string format_mjcf(const RobotTree& robot, const std::vector<PositionGains>& gains) {
  return Writer(robot, gains).write();
}

}  // namespace furcula::model
