#include "host/biped/robot.hpp"

#include <algorithm>

#include "host/core/error.hpp"
#include "host/core/message.hpp"

namespace furcula::biped {
namespace {

using core::quoted;
using core::shortest;
using dynamics::biped::Axis;
using dynamics::biped::Description;
using dynamics::biped::DesignTopology;
using dynamics::biped::kJoints;
using dynamics::biped::kLegJointNames;
using dynamics::biped::kLegJoints;
using dynamics::biped::LinkDescription;
using dynamics::tree::Mat3;
using dynamics::tree::Vec3;

[[noreturn]] void fail(const model::Urdf& robot, const std::string& message) {
  throw core::DataError(robot.file + ": " + message);
}

std::string text(const Vec3<double>& v) { return shortest(v.x) + " " + shortest(v.y) + " " + shortest(v.z); }

Vec3<double> unit(Axis a) {
  return {a == Axis::x ? 1.0 : 0.0, a == Axis::y ? 1.0 : 0.0, a == Axis::z ? 1.0 : 0.0};
}

bool near(const Vec3<double>& a, const Vec3<double>& b) {
  const Vec3<double> d = a - b;
  return dot(d, d) < 1e-18;
}

LinkDescription link(const model::Urdf& robot, std::size_t index, const Vec3<double>& offset_m) {
  const model::UrdfLink& from = robot.links[index];
  if (!from.inertia || !(from.inertia->mass_kg > 0.0))
    fail(robot, "link " + quoted(from.name) + " has no mass; expected one above 0");
  const model::UrdfInertia& i = *from.inertia;
  return {offset_m, i.mass_kg, i.frame.at, turned_back(i.frame.turn, i.about_centre_kgm2)};
}

}  // namespace

Description biped_of(const model::Urdf& robot) {
  model::tree_of(robot);  // refuses bodies that cannot be
  Description d = dynamics::biped::design();
  d.pelvis = link(robot, 0, {0.0, 0.0, 0.0});
  for (std::size_t side = 0; side < 2; ++side) {
    std::size_t parent = 0;
    for (std::size_t j = 0; j < kLegJoints; ++j) {
      const std::string name = (side == 0 ? "left_" : "right_") + std::string(kLegJointNames[j]);
      const auto found = std::find_if(robot.joints.begin(), robot.joints.end(),
                                      [&](const model::UrdfJoint& joint) { return joint.name == name; });
      const std::string who = "joint " + quoted(name);
      if (found == robot.joints.end()) fail(robot, "no " + who + "; expected the biped's 12 joints");
      if (found->kind != model::UrdfJoint::Kind::revolute)
        fail(robot, who + " is not revolute; expected a revolute joint");
      if (!found->mimics.empty())
        fail(robot, who + " mimics " + quoted(found->mimics) + "; expected a joint with a drive of its own");
      if (found->damping != 0.0 || found->friction != 0.0)
        fail(robot, who + " has damping or friction; expected none, which are the drives'");
      if (!found->limits || !(found->limits->effort > 0.0))
        fail(robot, who + " has no effort; expected the drive's largest torque, above 0");
      if (found->parent != parent)
        fail(robot, who + " is on link " + quoted(robot.links[found->parent].name) + "; expected it on " +
                        quoted(robot.links[parent].name));
      const Vec3<double> axis = unit(DesignTopology::kAxes[j]);
      if (!near(found->axis, axis))
        fail(robot, who + " is about " + text(found->axis) + "; expected " + text(axis));
      const Mat3<double>& turn = found->placement.turn;
      if (!near(turn.x, {1, 0, 0}) || !near(turn.y, {0, 1, 0}) || !near(turn.z, {0, 0, 1}))
        fail(robot, who + " is turned against its parent; expected rpy = 0 0 0");
      const Vec3<double>& at = found->placement.at;
      const unsigned may = DesignTopology::kOffsets[j];
      if ((!(may & 1) && at.x != 0.0) || (!(may & 2) && at.y != 0.0) || (!(may & 4) && at.z != 0.0))
        fail(robot, who + " is at " + text(at) + " in its parent; expected 0 for " + (may & 1 ? "" : "x ") +
                        (may & 2 ? "" : "y ") + (may & 4 ? "" : "z ") + "as in the design");
      d.legs[side][j] = link(robot, found->child, at);
      d.drives[side][j].limit_nm = found->limits->effort;
      parent = found->child;
    }
  }
  if (robot.joints.size() != kJoints)
    fail(robot, "there are " + std::to_string(robot.joints.size()) +
                    " joints; expected the biped's 12 and no other, with the feet as leaves");
  return d;
}

Description read_biped(const std::string& path) { return biped_of(model::read_urdf(path)); }

}  // namespace furcula::biped
