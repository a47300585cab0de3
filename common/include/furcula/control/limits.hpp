// Limits of the torque that is commanded to the drive.
#pragma once

#include "furcula/core/sine.hpp"

namespace furcula::control {

/// Limits of magnitude and rate.
struct LimitsConfig {
  float torque_nm = 20.0f;           ///< largest magnitude
  float torque_rate_nmps = 4000.0f;  ///< change a second: here 4 N m a tick, a 10 Hz sine of 20 N m passes
};

/// State of limit_torque() between two ticks.
struct LimitsState {
  float last_nm = 0.0f;  ///< torque that was commanded on the last tick
};

/// `wanted_nm` within the magnitude, and changed by no more than the rate allows in `dt_s`. NaN and infinity count as 0.
inline float limit_torque(const LimitsConfig& config, LimitsState& state, float wanted_nm, float dt_s) {
  const auto between = [](float lower, float x, float upper) {
    return x < lower ? lower : x > upper ? upper : x;
  };
  const float change = config.torque_rate_nmps * dt_s;
  // A value that is not a number counts as no torque.
  const float target = is_finite(wanted_nm) ? between(-config.torque_nm, wanted_nm, config.torque_nm) : 0.0f;
  state.last_nm = between(state.last_nm - change, target, state.last_nm + change);
  return state.last_nm;
}

}  // namespace furcula::control
