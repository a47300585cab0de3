// Robots from URDF files: links and joints as they stand there, and the tree for the dynamics.
//
// Conventions of the format: <origin xyz rpy> places a child's frame in its parent's, R = Rz(yaw) Ry(pitch)
// Rx(roll); a link's <inertial><origin> places the frame of its inertia, at the centre of mass; <axis> is in
// the joint's frame, which is the child link's.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "furcula/dynamics/tree/model.hpp"

namespace furcula::model {

using dynamics::tree::Frame;
using dynamics::tree::Sym3;
using dynamics::tree::Vec3;

struct UrdfInertia {
  double mass_kg = 0.0;
  Frame<double> frame;             ///< at the centre of mass, in the link
  Sym3<double> about_centre_kgm2;  ///< in that frame's axes
};

struct UrdfLink {
  std::string name;
  std::optional<UrdfInertia> inertia;
};

struct UrdfLimits {
  double lower = 0.0, upper = 0.0;  ///< rad or m; both zero on a continuous joint
  double effort = 0.0;              ///< N m or N
  double velocity = 0.0;            ///< rad/s or m/s
};

struct UrdfJoint {
  enum class Kind { fixed, revolute, continuous, prismatic };

  std::string name;
  Kind kind = Kind::fixed;
  std::size_t parent = 0, child = 0;  ///< indices of links
  Frame<double> placement;            ///< of the child link in the parent link, at position zero
  Vec3<double> axis;                  ///< of length 1, in the child link; not of a fixed joint
  std::optional<UrdfLimits> limits;
  double damping = 0.0;   ///< N m s/rad or N s/m
  double friction = 0.0;  ///< N m or N
  std::string mimics;     ///< the joint that it follows, or empty
};

/// From the root, links[0], outwards; a link's branches one after the other, by their joints' names.
struct Urdf {
  std::string file;  ///< for messages
  std::string name;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
};

/// @throws core::DataError naming file, element and what was expected: not readable, larger than 1 MiB, empty,
/// not XML, nested too deep, not a robot, a link with two parents, a loop, a floating or planar joint, an axis
/// of no length, a number that is missing or not finite, a negative mass, damping or friction, limits the
/// wrong way round.
Urdf read_urdf(const std::string& path);

/// The same on text; `name` stands for the path in messages.
Urdf parse_urdf(std::string_view text, const std::string& name);

inline constexpr std::size_t kMostJoints = 48;
using RobotShape = dynamics::tree::DynamicTopology<kMostJoints>;
using RobotModel = dynamics::tree::Model<double, RobotShape>;

/// A robot's tree: the joints that move, each with the bodies that are fixed to its link merged into it.
struct RobotTree {
  struct Joint {
    std::string name, link;
    UrdfJoint::Kind kind = UrdfJoint::Kind::revolute;
    Frame<double> placement;  ///< of the link in the body of the joint before it, or the base; links' frames
    Vec3<double> axis;
    std::optional<UrdfLimits> limits;
  };
  struct Link {
    std::string name;
    int joint = -1;       ///< that moves it; -1: fixed to the base
    Frame<double> frame;  ///< in the link frame of that joint, or in the base
  };

  std::string name;
  RobotModel model;  ///< damping and friction from the file; static friction is that of motion
  std::vector<Joint> joints;
  std::vector<Link> links;
};

/// The tree in which the joints `moving` move (their order there does not matter; empty: all that can), and
/// the others are fixed at the positions in `hold` (0 where they are not in it). Its joints are in the order of
/// Urdf::joints.
/// @throws core::DataError: a joint that is not in the robot, that is fixed, or that follows another or is
/// followed by one; a moving joint in `hold`; no joint that moves or more than kMostJoints; a
/// body that moves without an inertia or with one that no body can have, the link and its principal moments named.
RobotTree tree_of(const Urdf& robot, const std::vector<std::string>& moving = {},
                  const std::map<std::string, double>& hold = {});

}  // namespace furcula::model
