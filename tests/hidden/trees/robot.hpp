// Robots of several joints and their equations of motion, M(q) qdd + h(q, v) = torque, from the Jacobians of
// the bodies' centres in world axes: M = sum m Jv' Jv + Jw' I Jw, and h from the accelerations that remain at
// qdd = 0, which are the exact derivatives of the bodies' velocities.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tests/hidden/random.hpp"
#include "tests/hidden/trees/linear.hpp"

namespace furcula::hidden::trees {

inline constexpr double kGravity_mps2 = 9.81;

/// Between a body and its parent; q, v in rad, rad/s or m, m/s.
struct Joint {
  std::string name;
  int parent = -1;  ///< index of the joint before it; -1: the base
  Vec3 at, rpy;     ///< of its frame in the parent's, m, rad
  Vec3 axis{0, 0, 1};
  bool prismatic = false;
  double centre = 0.0, range = 1.0;  ///< paths stay within centre +- range
  double lower = -3.0, upper = 3.0;
  double effort = 100.0, velocity = 20.0;
};

struct Body {
  std::string name;
  int joint = 0;      ///< index of the joint that moves it
  bool tool = false;  ///< on a fixed joint of its own, at `at`, `rpy` in the joint's frame
  Vec3 at, rpy;
  double mass_kg = 1.0;
  Vec3 centre_m;   ///< in the link's frame
  Vec3 turned;     ///< rpy of the inertial frame
  Vec3 moments{};  ///< about the centre, along the inertial frame, kg m^2
  Vec3 point_m{};  ///< a point mass, in the link's frame
  double point_kg = 0.0;
};

/// What makes a robot one that hops: the toe, which stands on the ground, and the spring at the knee.
struct Leg {
  std::string link;          ///< that ends in the toe
  std::size_t hip = 0;       ///< joint between torso and thigh
  std::size_t knee = 0;      ///< joint before the link with the toe
  Vec3 toe_m;                ///< in the link's frame
  double spring_nmprad = 0;  ///< pulls the knee back to its rest angle, and never pushes
  bool switched = true;  ///< acts in stance alone, from the angle at touch-down; else always, from rest_rad
  double rest_rad = 0.0;
};

struct Robot {
  std::string form;  ///< "pendulum", "arm", "leg", "branched", "monopod"
  std::vector<Joint> joints;
  std::vector<Body> bodies;
  std::optional<Leg> leg;
  std::size_t size() const { return joints.size(); }
};

/// A rigid body as the equations need it, in its joint's frame. Made once for a robot.
struct Mass {
  std::size_t joint;
  double mass_kg;
  Vec3 centre_m;
  Mat3 inertia_kgm2;  ///< about the centre
};

/// A point of a body in world axes, m, m/s, m/s^2.
struct Point {
  Vec3 at, v;
  Vec3 a;                        ///< at qdd = 0
  std::array<Vec3, kMost> move;  ///< of each joint: what its speed adds to v
};

class Dynamics {
 public:
  Dynamics(const Robot& robot, Vec3 gravity_mps2);

  /// Mass matrix and the torques h that gravity and speed take at qdd = 0.
  void evaluate(const Values& q, const Values& v, Matrix& mass, Values& bias) const;
  /// M qdd + h.
  Values torque(const Values& q, const Values& v, const Values& qdd) const;
  /// Kinetic and potential energy, J.
  double energy_j(const Values& q, const Values& v) const;
  /// A point in the frame behind `joint`.
  Point point(std::size_t joint, Vec3 in_frame, const Values& q, const Values& v) const;
  std::size_t size() const { return joints_.size(); }

 private:
  struct Place {
    int parent;
    Vec3 at, axis;
    Mat3 turn;
    bool prismatic;
  };
  struct Pose {
    Vec3 p, axis;  // origin and axis, world
    Mat3 r;
    Vec3 w, v, alpha, a;  // turning and origin's velocity and acceleration at qdd = 0
  };
  std::array<Pose, kMost> poses(const Values& q, const Values& v) const;

  std::vector<Place> joints_;
  std::vector<Mass> masses_;
  Vec3 gravity_;
};

/// A robot of 2 to 7 joints; `joints` 0: any number.
Robot draw_robot(Random& random, std::size_t joints);

/// The monopod of document 001 on a boom that slides: each mass, length and inertia within 20 % of the printed
/// one.
Robot draw_monopod(Random& random);

/// The robot as a URDF, resonators (joints from `visible` on) left out.
std::string urdf_of(const Robot& robot, std::size_t visible);

}  // namespace furcula::hidden::trees
