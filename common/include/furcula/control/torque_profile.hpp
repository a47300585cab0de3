// The torque that keeps the robot hopping: open loop over a stance, restarted at each detected touch-down
// (002 section 4.1). Positive torque flexes the leg, that is, pulls the body down.
#pragma once

#include <cstdint>

#include "furcula/control/phase.hpp"
#include "furcula/core/sine.hpp"

namespace furcula::control {

/// Shape of the torque over a stance; equations: profile_torque_nm().
enum class ProfileShape : std::uint8_t {
  zero,      ///< no torque
  harmonic,  ///< a sine of the time since touch-down
  constant   ///< a constant magnitude with the sign of the motion
};

/// Torque profile of a stance.
struct TorqueProfileConfig {
  ProfileShape shape = ProfileShape::zero;  ///< of the torque over time
  float amplitude_nm = 0.0f;                ///< positive pumps energy in, negative takes it out
  float period_s = 0.3f;                    ///< of `harmonic`
};

/// Torque of one tick, N m. Zero in flight. In stance
///   harmonic   T sin(2 pi (t - t_td) / P), 002 eq. 4.1; t is the middle of the tick over which the torque is held
///   constant   -T sgn(z_dot): the torque pulls the body down while it sinks, and pushes it up while it rises
inline float profile_torque_nm(const TorqueProfileConfig& config, const PhaseEstimate& phase,
                               float velocity_mps, float dt_s) {
  if (phase.phase == Phase::flight) return 0.0f;
  switch (config.shape) {
    case ProfileShape::zero:
      return 0.0f;
    case ProfileShape::harmonic:
      return config.amplitude_nm * sine_of_turns((phase.since_touchdown_s + 0.5f * dt_s) / config.period_s);
    case ProfileShape::constant:
      return velocity_mps < 0.0f ? config.amplitude_nm : velocity_mps > 0.0f ? -config.amplitude_nm : 0.0f;
  }
  return 0.0f;
}

}  // namespace furcula::control
