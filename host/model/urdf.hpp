// Robots from URDF files: links and joints as they stand there, and the tree for the dynamics.
//
// Conventions of the format: <origin xyz rpy> places a child's frame in its parent's, R = Rz(yaw) Ry(pitch)
// Rx(roll); a link's <inertial><origin> places the frame of its inertia, at the centre of mass; <axis> is in
// the joint's frame, which is the child link's.
#pragma once

#include <array>
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
  std::size_t line = 0;  ///< of the file
  std::string
      flaw{};  ///< what is wrong with its <inertial>, which then is not in `inertia`; with file and line
  bool repaired =
      false;  ///< its moments were below 0 or off the triangle inequality by less than they are rounded, and are moved to the limit
  std::string file{};           ///< where it is not Urdf::file: one that this includes
  bool between_joints = false;  ///< between two joints of one body of MJCF: it has no mass, as it should
};

struct UrdfLimits {
  double lower = 0.0,
         upper = 0.0;     ///< rad or m; both zero on a continuous joint, and where they are of no use
  double effort = 0.0;    ///< N m or N
  double velocity = 0.0;  ///< rad/s or m/s
};

struct UrdfJoint {
  enum class Kind {
    fixed,
    revolute,
    continuous,
    prismatic,
    other
  };  ///< other: floating, planar, spherical, ...

  std::string name;
  Kind kind = Kind::fixed;
  std::size_t parent = 0, child = 0;  ///< indices of links
  Frame<double> placement;            ///< of the child link in the parent link, at position zero
  Vec3<double> axis;                  ///< of length 1, in the child link; not of a fixed joint
  std::optional<UrdfLimits> limits;
  double damping = 0.0;   ///< N m s/rad or N s/m
  double friction = 0.0;  ///< N m or N
  std::string mimics;     ///< the joint that it follows, or empty
  std::size_t line = 0;   ///< of the file
  std::string type{};     ///< as the file calls it
  std::string
      flaw{};  ///< what is wrong with its axis or <dynamics>, which then have their defaults; with file and line
  std::string limit_flaw{};  ///< why its range is of no use
  double reduction = 0.0;    ///< of its <transmission>, motor's speed over the joint's; 0: none is given
  double rotor_inertia_kgm2 =
      0.0;  ///< at the joint, by extensions of the format; 0: none is given. Not in the tree
  double spring_nmprad = 0.0;    ///< likewise; it acts both ways
  double spring_rest_rad = 0.0;  ///< where that spring is relaxed
  std::string file{};            ///< where it is not Urdf::file: one that this includes
  enum class Actuator { unknown, none, torque, position };
  Actuator actuator = Actuator::unknown;     ///< of MJCF alone
  double kp_nmprad = 0.0, kd_nmsprad = 0.0;  ///< of a position actuator, at the joint
};

/// What joins links beside the tree of joints: <loop_joint>, bushings and constraints of Drake, <joint> in <gazebo>.
struct UrdfClosure {
  std::size_t line = 0;
  std::string tag;
  std::vector<std::string> links;  ///< those of its links that are known; an empty name: the world
  std::string file{};              ///< where it is not Urdf::file: one that this includes
};

/// From the root, links[0], outwards; a link's branches one after the other, by their joints' names.
struct Urdf {
  std::string file;  ///< for messages
  std::string name;
  std::vector<UrdfLink> links;
  std::vector<UrdfJoint> joints;
  std::vector<UrdfClosure> closures{};
  std::vector<std::string> notes{};  ///< what of the file is not used, in sentences
  /// From MJCF: rotor inertias and springs of joints are in the tree, and gravity is the file's.
  bool is_mjcf = false;
  bool is_expanded = false;  ///< by xacro: the file itself is no URDF
  Vec3<double> gravity_mps2{0.0, 0.0, -9.81};
};

/// @throws core::DataError naming file, line, element and what was expected: not readable, larger than 1 MiB, empty,
/// not XML, nested too deep, not a robot, a xacro file, a link with two parents, a loop, more than one root, a joint's place that is no number.
/// What is wrong with a link's <inertial>, a joint's axis or <dynamics> is told by tree_of, where the link or joint moves; limits are never refused.
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
  std::vector<std::string> notes{};  ///< what was taken, left out and repaired, in sentences
};

struct TreeOptions {
  bool accept_inertias = false;  ///< take masses and moments as they are that no body has, or none of a robot
  bool judge_motion = true;      ///< require_joint_inertia, without rotors
};

/// The tree in which the joints `moving` move (their order there does not matter; empty: default_joints), and
/// the others are fixed at the positions in `hold` (0 where they are not in it). Its joints are in the order of
/// Urdf::joints.
/// @throws core::DataError: a joint that is not in the robot, that is fixed, floating or the like, or that follows another or is
/// followed by one; a moving joint in `hold`; no joint that moves or more than kMostJoints; a closed loop that moves; a link, joint or body
/// that moves and has a flaw: a number that is none, moments that no body can have once the links that are fixed to each other are one,
/// lengths or moments in another unit (plausible.hpp).
RobotTree tree_of(const Urdf& robot, const std::vector<std::string>& moving = {},
                  const std::map<std::string, double>& hold = {}, const TreeOptions& options = {});

/// Those that can move by themselves: not fixed, floating or the like, not in `hold`, not following a joint nor followed by one.
std::vector<std::string> default_joints(const Urdf& robot, const std::map<std::string, double>& hold = {});

/// Refuses a tree whose joint-space inertia is singular wherever its joints are, `rotors_kgm2` (a number a joint, or none at all) included: a joint
/// that nothing gives an inertia. Notes where it is so only with all joints at 0.
/// @throws core::DataError naming `file`, joint, link and what to do
void require_joint_inertia(RobotTree& tree, const std::string& file,
                           const std::vector<double>& rotors_kgm2 = {});

}  // namespace furcula::model
