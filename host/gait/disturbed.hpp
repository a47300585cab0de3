// A gait on the board's controller over many strides, on uneven ground and with a late switch: how often it falls.
#pragma once

#include <cstdint>

#include "host/gait/gait.hpp"
#include "host/gait/held_law.hpp"

namespace furcula::gait {

struct DisturbedOptions {
  unsigned strides = 1000;
  double ground_m = 0.01;       ///< each landing's ground is drawn evenly within this of level
  double switch_late_s = 5e-3;  ///< of each touch-down and lift-off that the controller is told
  std::uint64_t seed = 1;
};

struct Disturbed {
  unsigned strides = 0, falls = 0;
  double cost_j = 0.0;         ///< of a stride, mean of those without a fall
  double apex_spread_m = 0.0;  ///< standard deviation of the apex's height
};

/// After a fall it is dropped anew from the gait's apex. Sensors in whole counts. The same for the same seed.
Disturbed run_disturbed(const Gait& gait, const StanceGains& gains, const DisturbedOptions& options = {});

}  // namespace furcula::gait
