// A window's run made linear: what a small torque at a joint, at any time, changes of all that follows.
//
// One run with its transition matrices stands for a run a candidate: of a candidate, only the torque that it adds along
// the window's motion is computed, and carried on. To first order in that torque this is the change that a run
// with the candidate would have; in the candidate's own parameters it is exact. What acts at a joint behind a spring is taken as acting at
// its drive. The spring itself, which brings a rotor that moves by itself, is seen by the measured motion (rotor.hpp).
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "host/trees/run.hpp"
#include "host/trees/windows.hpp"

namespace furcula::trees {

class Linearised {
 public:
  /// `torque_nm`: of each joint, a change by which nothing else changes much.
  Linearised(const Setup& setup, const Recording& recording, const Window& window,
             std::span<const double> torque_nm);

  /// What the measured angles change with each of `setups` in place of the one that was run: bin by bin and joint by joint (rows as
  /// in Window::measured), a column each.
  Eigen::MatrixXd changes(std::span<const Setup* const> setups) const;

  /// What the measured angles change with a torque of 1 N m at each joint in each of `slices` equal parts of the window: columns joint by joint, in
  /// each by time; rows as in Window::measured.
  Eigen::MatrixXd of_torques(std::size_t slices) const;

  /// What the measured angles change with the start of the rotor behind the spring that each setup has and the run has not: two columns
  /// each, by its angle and by its rate; zero where there is no such spring.
  Eigen::MatrixXd rotor_starts(std::span<const Setup* const> setups) const;

  std::size_t steps() const { return steps_; }  ///< of integration

 private:
  using Joints = model::RobotModel::Joints;
  /// The run between two of its times, some milliseconds apart.
  struct Interval {
    Joints position_rad, velocity_radps, acceleration_radps2;  ///< of the joints, in the middle
    Joints forth;                     ///< share of it in forward motion, less that in backward motion
    Joints body_nm;                   ///< what the bodies ask for
    Eigen::MatrixXd carried, driven;  ///< the state's change by that before, and by the joints' torques
  };
  /// What one tree makes of an interval, beside another.
  class Torques;

  const Setup setup_;
  const Recording& recording_;
  const Window& window_;
  double step_s_;
  std::size_t steps_ = 0;
  std::vector<Interval> intervals_;
  std::vector<std::vector<double>> share_;  ///< of each bin in the run's times: bin by bin
};

}  // namespace furcula::trees
