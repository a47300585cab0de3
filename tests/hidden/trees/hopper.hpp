// The computer that lets a leg hop: in flight it brings the leg to where the toe shall come down, in stance it
// drives the body on and pushes it off. It knows the leg as the model has it.
#pragma once

#include "tests/hidden/trees/robot.hpp"

namespace furcula::hidden::trees {

/// How a laboratory has tuned it. Lengths in m, angles in rad, torques in N m.
struct Hopping {
  double landing_rad = 0.75;                                       ///< knee at touch-down
  double folds_rad = 0.3;                                          ///< knee further flexed on the way up
  double hip_kp = 130, hip_kd = 7.5, knee_kp = 32, knee_kd = 1.4;  ///< in flight
  double swing_s = 0.16;         ///< from lift-off to the place of touch-down
  double speed_gain_s = 0.06;    ///< toe further ahead for each m/s that the leg is too fast
  double drives_nmspr = 8.0;     ///< stance: hip torque over the error of the leg's turning speed
  double grip = 0.4;             ///< of the leg's force, that the hip may ask of the ground
  double stiffens_nmprad = 6.0;  ///< stance: a spring of the motor, from the angle at touch-down
  double pushes = 2.5;           ///< torque over weight and height of the hop
  double push_gain_npm = 50.0;   ///< N m more of push for each m of height that was missing
  double push_most_nm = 40.0;
  double damps_nmspr = 0.3;   ///< stance: while the knee flexes
  double lifts_nm = 8.0;      ///< flexes the knee at the end of a stance
  double sweeps_nms2 = 0.09;  ///< swings the thigh on there, over the square of the knee's speed
  double smooth_s = 0.003;    ///< low pass on the commands
  double most_nm = 150.0;
};

struct HopTarget {
  double speed_mps = 0.0;
  double drop_m = 0.1;  ///< height of the apex above that of touch-down
};

class Hopper {
 public:
  Hopper(const Robot& model, const Hopping& how);

  /// Pose in which the leg is let go: at the apex.
  Values start(const HopTarget& target) const;
  /// Torque commands, from the positions that were read, the speeds and the toe's switch.
  Values command(double t, const HopTarget& target, const Values& q, const Values& v, bool contact);

 private:
  double length_m(double knee_rad) const;
  /// From the thigh to the line from hip to toe, counted like the knee's angle.
  double bend_rad(double knee_rad) const;
  /// Of the centre of all masses.
  double forward_mps(const Values& q, const Values& v) const;
  double shortens_m(double knee_rad) const;  // length for each rad of flexion, < 0

  std::size_t hip_, knee_;
  double thigh_m_, shank_m_, weight_n_, spring_nmprad_;
  double rest_rad_;  // of a parallel spring; else below all angles
  bool switched_;
  double thigh_kgm_ = 0.0, shank_kgm_ = 0.0;  // first moments about hip and knee
  Hopping how_;
  double swing_s_;

  bool stance_ = false, extends_ = false, rose_ = false;
  double since_s_ = 0.0, extends_s_ = 0.0, stance_s_ = 0.16;
  double hip_then_ = 0.0, knee_then_ = 0.0;  // at the last change of the switch
  double misses_m_ = 0.0, more_nm_ = 0.0;
  double last_s_ = 0.0, hip_nm_ = 0.0, knee_nm_ = 0.0;
  bool first_ = true;
};

}  // namespace furcula::hidden::trees
