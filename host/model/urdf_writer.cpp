// Writing URDF, see urdf_writer.hpp.
#include "host/model/urdf_writer.hpp"

#include <cmath>

#include "host/core/markup.hpp"
#include "host/core/message.hpp"

namespace furcula::model {
namespace {

using core::shortest;
using Kind = UrdfJoint::Kind;

std::string attribute(const char* name, const std::string& value) {
  return std::string(" ") + name + "=\"" + core::escape(core::printable(value)) + "\"";
}
std::string three(const Vec3<double>& v) { return shortest(v.x) + " " + shortest(v.y) + " " + shortest(v.z); }
/// Roll, pitch and yaw of R = Rz Ry Rx, whose transposed is `turn`.
Vec3<double> angles(const dynamics::tree::Mat3<double>& turn) {
  const double sin_pitch = -turn.x.z, cos_pitch = std::hypot(turn.x.x, turn.x.y);
  constexpr double kUpright = 1e-12;
  if (cos_pitch < kUpright)  // roll and yaw are about one axis
    return {std::atan2(-turn.z.y, turn.y.y), std::atan2(sin_pitch, cos_pitch), 0.0};
  return {std::atan2(turn.y.z, turn.z.z), std::atan2(sin_pitch, cos_pitch), std::atan2(turn.x.y, turn.x.x)};
}
std::string origin(const Frame<double>& f) {
  return "<origin" + attribute("xyz", three(f.at)) + attribute("rpy", three(angles(f.turn))) + "/>";
}
std::string link(const UrdfLink& l) {
  std::string out = "  <link" + attribute("name", l.name);
  if (!l.inertia) return out + "/>\n";
  const Sym3<double>& s = l.inertia->about_centre_kgm2;
  out += ">\n    <inertial>\n      " + origin(l.inertia->frame) + "\n      <mass" +
         attribute("value", shortest(l.inertia->mass_kg)) + "/>\n      <inertia";
  for (const auto& [name, value] :
       {std::pair{"ixx", s.xx}, {"ixy", s.xy}, {"ixz", s.xz}, {"iyy", s.yy}, {"iyz", s.yz}, {"izz", s.zz}})
    out += attribute(name, shortest(value));
  return out + "/>\n    </inertial>\n  </link>\n";
}
const char* type_of(Kind kind) {
  switch (kind) {
    case Kind::revolute:
      return "revolute";
    case Kind::continuous:
      return "continuous";
    case Kind::prismatic:
      return "prismatic";
    case Kind::other:
      return "floating";
    case Kind::fixed:
      break;
  }
  return "fixed";
}
std::string joint(const Urdf& robot, const UrdfJoint& j) {
  std::string out = "  <joint" + attribute("name", j.name) + attribute("type", type_of(j.kind)) + ">\n    " +
                    origin(j.placement) + "\n    <parent" + attribute("link", robot.links[j.parent].name) +
                    "/>\n    <child" + attribute("link", robot.links[j.child].name) + "/>\n";
  if (j.kind != Kind::fixed && j.kind != Kind::other) {
    out += "    <axis" + attribute("xyz", three(j.axis)) + "/>\n";
    if (j.damping != 0.0 || j.friction != 0.0 || j.rotor_inertia_kgm2 != 0.0)
      out += "    <dynamics" + attribute("damping", shortest(j.damping)) +
             attribute("friction", shortest(j.friction)) +
             (j.rotor_inertia_kgm2 == 0.0 ? "" : attribute("armature", shortest(j.rotor_inertia_kgm2))) +
             "/>\n";
    if (j.limits)
      out += "    <limit" + attribute("lower", shortest(j.limits->lower)) +
             attribute("upper", shortest(j.limits->upper)) + attribute("effort", shortest(j.limits->effort)) +
             attribute("velocity", shortest(j.limits->velocity)) + "/>\n";
    if (!j.mimics.empty()) out += "    <mimic" + attribute("joint", j.mimics) + "/>\n";
  }
  return out + "  </joint>\n";
}

}  // namespace

std::string format_urdf(const Urdf& robot) {
  std::string out = "<?xml version=\"1.0\"?>\n<robot" + attribute("name", robot.name) + ">\n";
  for (const UrdfLink& l : robot.links) out += link(l);
  for (const UrdfJoint& j : robot.joints) out += joint(robot, j);
  return out + "</robot>\n";
}

}  // namespace furcula::model
