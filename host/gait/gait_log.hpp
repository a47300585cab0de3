// A leg that plays a gait on the board's controller, as a log.
#pragma once

#include <cstdint>

#include "host/gait/gait.hpp"
#include "host/log/log.hpp"

namespace furcula::gait {

struct GaitLogOptions {
  double duration_s = 6.0;
  double ground_m = 0.005;  ///< each landing's ground is drawn evenly within this of level
  std::uint64_t seed = 0;
};

/// `machine`, which may differ from the gait's own, under the controller with its feedback in stance, from the gait's apex. A row
/// a tick: the boom's slides, hip and knee, the torques commanded, the toe's switch (the columns of leg_as_tree.hpp). Sensors in whole counts.
/// @throws core::DataError: the robot falls, when and why
log::Log log_of_gait(const Gait& gait, const Machine& machine, const GaitLogOptions& options = {});

}  // namespace furcula::gait
