// Whether a walk keeps itself: the periodic stride to which it comes, and what a deviation from it is after a stride.
//
// The section is where the right leg begins to come down, a fixed time after a landing: the impact has died away there. Landings are located
// between two ticks. The state is the robot's, the feet's anchors, the filter's vertical and bias, the accelerometer's last sample, the
// targets, and what is of an open knee alone. Place and heading, and the filter's heading, are left out: nothing hangs on them.
#pragma once

#include <string>
#include <vector>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/walk/rollout.hpp"

namespace furcula::walk {

struct ReturnMap {
  bool found = false;  ///< a periodic stride of two steps
  std::string none;    ///< else why not
  double stride_s = 0.0, stride_m = 0.0;
  double closure = 0.0;  ///< largest difference of the state after a stride, SI units
  /// Sizes of the eigenvalues of a stride's return map, largest first. Above 1 the walk leaves its stride.
  std::vector<double> multipliers;
  double cot = 0.0;    ///< of the periodic stride: without start and stop
  double cpu_s = 0.0;  ///< the multipliers alone
};

/// Of `strides` strides of two steps. Of the walk without an end, with steps and ticks of `options.step_s`, in double, with sensors that do not err; none where drives are late.
ReturnMap return_map_of(const dynamics::biped::Description& robot, const RolloutOptions& options,
                        const Parameters& walk, int strides = 1);

}  // namespace furcula::walk
