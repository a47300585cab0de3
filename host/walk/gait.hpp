// A gait of the biped by gradients: one step, found from a robot that stands, whose end is the mirror image of its beginning.
//
// The unknowns are the joints' angles over the step, as splines, its duration, and the wrench under the second foot while both stand;
// torques follow by inverse dynamics on the foot that stands flat (stance_dynamics.hpp). So every candidate obeys the equations of motion and
// keeps that foot where it is; limits, the other foot's landing and the mirror are constraints, 000 eq. 1 is the cost. Ipopt has exact first
// and second derivatives (host/optimise/graph.hpp). Decision record 32 says why so.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/optimise/spline.hpp"
#include "host/walk/rollout.hpp"
#include "host/walk/stance_dynamics.hpp"

namespace furcula::walk {

struct GaitTask {
  WalkMode mode = WalkMode::active;
  WalkLimits limits;
  std::optional<double> speed_mps;  ///< without it the one that costs least
  bool yaw_held = true;             ///< hips' yaw stays at 0, as the walk's controller has it
  double clearance_m = 0.02;        ///< of the swing foot's sole in the middle of its swing
  double least_knee_rad = 0.1;      ///< a leg that is stretched has no way out
  double double_support_s =
      0.0;                  ///< both feet stand at least that long; 0: the load changes feet at an instant
  double yaw_arm_m = 0.05;  ///< a sole's moment about the vertical is at most friction times load times this
  double sole_margin_m = 0.005;  ///< of the centre of pressure from the sole's edge
  double cpu_s = 20.0;           ///< for the search
  std::function<void(int iteration, double cost, double violation)> progress;
};

/// A piece of the step: one foot stands, or both. Time runs from 0 to duration_s.
struct GaitPhase {
  bool both = false;
  double duration_s = 0.0;
  std::array<std::vector<double>, biped::kJoints>
      joints;  ///< coefficients of splines, rad; left leg, which stands
  /// Coefficients: moment (N m) and force (N) on the right foot about its ankle, in its axes; none while it swings.
  std::array<std::vector<double>, 6> wrench;

  struct At {
    JointNumbers<double> q, qd, qdd;
    biped::Force<double> other{};
  };
  At at(double time_s) const;
};

/// The left foot stands, the right one swings and lands; then both stand. The next step is the mirror image.
struct Gait {
  std::vector<GaitPhase> phases;
  double step_m = 0.0;        ///< from the left ankle to the right one at the end
  double step_width_m = 0.0;  ///< between the ankles

  double duration_s() const;
  /// The phase at a time of the step, and the time in it.
  std::pair<const GaitPhase*, double> phase_at(double time_s) const;
};

/// The most of what has a limit, on a fine grid over the step.
struct GaitFigures {
  double cot = 0.0, energy_j = 0.0, copper_j = 0.0, work_j = 0.0, positive_work_j = 0.0, constant_j = 0.0;
  double torque_nm = 0.0, speed_radps = 0.0, moment_nm = 0.0, range_rad = 0.0;
  double height_m = 0.0, apart_m = 0.0;  ///< the least
  double load_n = 0.0;                   ///< the least under a foot that stands
  double friction = 0.0;                 ///< shear over load, the most
  double pressure_m = 0.0;               ///< of a centre of pressure inside of the sole's edge, the least
  double least_knee_rad = 0.0;
  double spring_off_nm = 0.0;  ///< of a passive hip: what it needs beside its spring
  double sole_m = 0.0;         ///< the lowest corner of the swing foot over the ground
};

struct GaitResult {
  bool found = false;
  std::string status;   ///< Ipopt's, in words
  std::string against;  ///< where none is found: the constraint that is broken most
  double broken_by = 0.0;
  int iterations = 0;
  double cpu_s = 0.0;
  Gait gait;
  GaitFigures figures;
};

/// Torques of the motors at a moment: friction of the gear is on top of what the joint needs. A passive hip's is what its motor needs to follow.
JointNumbers<double> motor_torques(const biped::Description& robot, WalkMode mode, const GaitPhase::At& at,
                                   const Stance<double>& stance);

GaitResult find_gait(const biped::Description& robot, const GaitTask& task);
GaitFigures figures_of(const biped::Description& robot, const GaitTask& task, const Gait& gait);

}  // namespace furcula::walk
