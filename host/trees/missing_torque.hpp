// The torque that a model lacks, joint by joint, by inverse dynamics; and how much of it a flexible law of the state foretells.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "host/trees/fit.hpp"

namespace furcula::trees {

/// Samples of one joint over all recordings; rows about a reversal are left out, where dry friction has any value.
struct TorqueSamples {
  std::vector<std::size_t> recording;
  std::vector<double> time_s, angle_rad, velocity_radps, acceleration_radps2, drive_nm, drive_rate_nmps;
  std::vector<double> missing_nm;      ///< what would have to be added to the drive's torque
  std::vector<std::vector<double>> other_angle_rad, other_velocity_radps, other_acceleration_radps2, other_drive_nm;  ///< of all joints
};

/// About `most` samples a joint, evenly over the recordings.
std::vector<TorqueSamples> missing_torque(const Problem& problem, const std::vector<Recording>& recordings, const Hypothesis& h,
                                          std::size_t most = 6000);

/// Share of the missing torque's square that is foretold, on recordings left out of the fit (of fewer than three, on
/// quarters of them): by functions of the joint's own and the other joints' state, torque and time. Below 0: worse than nothing.
double predictable_share(const TorqueSamples& samples, std::size_t joint, std::size_t recordings);

/// The one signal that it goes along with most, in words, or nothing.
std::string goes_along_with(const TorqueSamples& samples, std::size_t joint, std::size_t recordings, const TreeModel& model);

}  // namespace furcula::trees
