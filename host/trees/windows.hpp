// The windows of the recordings that a fit compares, and how large things are on this machine.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "host/trees/recording.hpp"

namespace furcula::trees {

/// How large things are on this machine: root mean squares over the recordings.
struct Scales {
  std::vector<double> drive_nm;   ///< what each joint's drive gives
  std::vector<double> torque_nm;  ///< what acts at each joint, by its drive or its motion
  std::vector<double> velocity_radps, acceleration_radps2;  ///< of each joint
  std::vector<double> lowest_rad, highest_rad;
  std::vector<bool> still;  ///< what it moves is lost in the encoder's noise: its parameters cannot show
};
Scales scales_of(const TreeModel& model, std::span<const Recording> recordings);

struct Window {
  std::size_t recording, first, last;
  double span_s;                                  ///< asked for
  std::vector<double> angle_rad, velocity_radps;  ///< start: as measured around it, and start_more
  Eigen::VectorXd start_precision;                ///< of angles, then velocities: one over the variance
  Eigen::VectorXd measured;                       ///< bin by bin, joint by joint
  std::vector<std::size_t> bin;                   ///< of each row from `first`
  /// What a fit of the start, angles, then velocities, has added to what is measured around it; empty: nothing.
  Eigen::VectorXd start_more{};
  /// Of elastic drives' rotors at the start, angles, then rates: added to what the recording says (rotor.hpp); empty: nothing.
  std::vector<double> rotor_more{};
  /// Of switched springs' rest angles in a stance, added to what the recording says; empty: nothing.
  std::vector<double> rest_more_rad{};
};

/// Windows of `window_s` side by side, none over a gap in the rows; at most `most` of them, evenly chosen (0: all).
std::vector<Window> windows_of(const TreeModel& model, std::span<const Recording> recordings, double window_s,
                               std::size_t most = 0);

}  // namespace furcula::trees
