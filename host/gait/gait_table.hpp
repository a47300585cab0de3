// A gait as the table that the board's controller plays (control/gait_config.hpp).
#pragma once

#include "furcula/control/gait_config.hpp"
#include "host/gait/gait.hpp"
#include "host/gait/held_law.hpp"

namespace furcula::gait {

/// Angles, rates and torques along one stride, with the law's gains; ranges and lengths from the machine.
/// @throws core::DataError: the gait makes no stride
control::GaitConfig controller_config(const Gait& gait, const StanceGains& gains);

}  // namespace furcula::gait
