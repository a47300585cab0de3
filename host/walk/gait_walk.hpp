// A gait as a start for walks: the targets of the walk's controller that come nearest to it.
#pragma once

#include "furcula/dynamics/biped/state.hpp"
#include "host/walk/gait.hpp"

namespace furcula::walk {

/// The robot at a moment of a gait; the world's ground is z = 0, its origin under the left ankle.
biped::State<double> state_of(const biped::Description& robot, const GaitPhase::At& at,
                              const Stance<double>& stance);

struct GaitWalk {
  Parameters walk;
  double error_rad = 0.0;  ///< of the targets over the step, root of the mean square
};
/// The targets that the drives need, q + (torque + kd qd) / kp, less the feedback of the start values' gains; posture, times and targets of `up` and
/// `down` are fitted to them. Gains, start and stop are the start values.
GaitWalk walk_of(const biped::Description& robot, WalkMode mode, const Gait& gait);

}  // namespace furcula::walk
