// Where an elastic drive's rotor is along a recording: its own equation, driven by the recording's inputs, its spring's other end by the
// measured angle. J w' = tau - d w - K (theta - q).
//
// A rotor has no encoder, and it may still ring from what was long before a window; from the window alone nobody knows how.
#pragma once

#include <cstddef>

#include "host/trees/run.hpp"

namespace furcula::trees {

/// What a rotor is ahead of its balance on the spring, a time later: angle and rate.
void swing(const dynamics::tree::JointLaw<double>& law, double time_s, double& ahead_rad,
           double& ahead_radps);

class Rotor {
 public:
  /// Begins in balance with the drive's torque at row `from`.
  Rotor(const Setup& setup, const Recording& recording, std::size_t joint, std::size_t from);
  /// Begins so long before `row` that what it did before has decayed, or at the recording's start or last gap; and moves on to `row`.
  static Rotor at(const Setup& setup, const Recording& recording, std::size_t joint, std::size_t row);

  /// Moves on to the next row.
  void advance();

  double angle_rad() const { return angle_rad_; }
  double rate_radps() const { return rate_radps_; }
  /// What the joint has of the drive's torque, less what it would have of one without a spring, of this inertia and damping; summed over
  /// time, up to a constant, N m s.
  double impulse_nms(double stiff_inertia_kgm2, double stiff_damping_nmspr) const;

 private:
  double joint_rad(std::size_t row) const;  ///< measured, without the encoder's offset

  const Setup::Joint& drive_;
  const dynamics::tree::JointLaw<double>& law_;
  const Recording& r_;
  std::size_t joint_, row_;
  double lagged_nm_ = 0.0, angle_rad_ = 0.0, rate_radps_ = 0.0;
};

}  // namespace furcula::trees
