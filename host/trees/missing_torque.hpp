// The torque that a model lacks, joint by joint, by inverse dynamics; and how much of it a flexible law of the state predicts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "host/trees/fit.hpp"

namespace furcula::trees {

/// Samples of one joint over all recordings; rows about a reversal are left out, where dry friction has any value.
struct TorqueSamples {
  struct Joint {
    std::vector<double> angle_rad, velocity_radps, acceleration_radps2, drive_nm;
  };
  std::size_t joint = 0;
  std::vector<std::size_t> recording;
  std::vector<double> time_s;      ///< from the recording's start
  std::vector<double> missing_nm;  ///< what would have to be added to the drive's torque
  std::vector<double> drive_rate_nmps;
  std::vector<double> asked_nm,
      needed_nm;  ///< of the drive along the measured motion: by its law, and by the bodies and friction
  double half_s = 0.0;        ///< so far on either side the smoothing of a sample reaches
  std::vector<Joint> others;  ///< what all joints did, this one among them

  const Joint& own() const { return others[joint]; }
};

/// About `most` samples a joint, evenly over the recordings. Accelerations come from angles that are smoothed, torques too; what that
/// makes of a motion is taken off by doing the same to the model's own motion, from window to window.
std::vector<TorqueSamples> missing_torque(const Problem& problem, const std::vector<Recording>& recordings,
                                          const Hypothesis& h, double window_s, std::size_t most = 6000);

/// Share of the missing torque's square that is predictable, on recordings left out of the fit (of fewer than three, on
/// quarters of them): by functions of the joint's own and the other joints' state, torque and time. Below 0: worse than nothing.
double predictable_share(const TorqueSamples& samples, std::size_t joint, std::size_t recordings);

/// Of the missing torque, the part that lasts from one sample to those that share no measurement with it, root mean square: not the
/// noise of angles that are differentiated twice. Whether or not anything predicts it; by the lower end of what its scatter allows. Of
/// what swings, at the time apart at which it agrees with itself, or contradicts itself, most.
double persistent_nm(const TorqueSamples& samples);

/// What a joint still lacks.
struct Remainder {
  double rms_nm = 0.0;
  double predictable = 0.0;  ///< share of the square
  double persistent_nm = 0.0;

  double predictable_nm() const { return std::sqrt(std::max(0.0, predictable)) * rms_nm; }
  /// A flexible law predicts some of it, and that is some of the drive's torque.
  bool is_structured(double torque_nm) const {
    return predictable > 0.03 && predictable_nm() > 0.01 * torque_nm;
  }
  /// So much of the drive's torque is no remainder of something named: it is another thing.
  bool is_another(double torque_nm) const {
    return is_structured(torque_nm) && predictable_nm() > kAnother * torque_nm;
  }
  /// Torque that is missing for longer than noise is, whatever it goes along with: by time, or by a state that no log has.
  bool lasts(double torque_nm) const { return persistent_nm > kAnother * torque_nm; }

  static constexpr double kAnother = 0.05;
};
Remainder remainder_of(const TorqueSamples& samples, std::size_t recordings);

/// A signal of correlated_with: all of another joint's state.
std::string what_does(const TreeModel& model, std::size_t joint);

/// The one signal that it goes along with most, in words, or nothing.
std::string correlated_with(const TorqueSamples& samples, std::size_t joint, std::size_t recordings,
                            const TreeModel& model);

/// Of each joint, the cycles a turn with which the missing torque swings most: at most two, none where nothing swings.
std::vector<std::vector<double>> ripple_cycles(const Problem& problem,
                                               const std::vector<TorqueSamples>& samples);

/// Of each joint, limits that its drive's torque may have: what it gives where it is asked for most, if that is less. At most two.
std::vector<std::vector<double>> limits_nm(const std::vector<TorqueSamples>& samples);

}  // namespace furcula::trees
