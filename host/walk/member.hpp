// One robot of an ensemble: its numbers, what its sensors get wrong, and what pushes it.
#pragma once

#include <array>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/walk/rollout.hpp"

namespace furcula::walk {

/// An acceleration of the whole robot, as by a force that acts on every link in proportion to its mass.
struct Push {
  double begin_s = 0.0, end_s = 0.0;
  double x_mps2 = 0.0, y_mps2 = 0.0;  ///< ground's axes
};

struct Member {
  static constexpr std::size_t kPushes = 16;

  dynamics::biped::Description robot;
  SensorOffsets sensors;
  double foot_change_n = 0.0;          ///< the feet's sensors read so much more
  std::array<Push, kPushes> pushes{};  ///< one after the other; the last ones may have no length
};

/// A walk, and who walks it.
struct Job {
  Parameters walk{};
  std::size_t member = 0;  ///< of an ensemble's members
};

}  // namespace furcula::walk
