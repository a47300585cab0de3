// The motor moves the leg in flight along a path of its length.
#pragma once

#include "furcula/control/phase.hpp"
#include "furcula/core/sine.hpp"

namespace furcula::control {

/// Gains of the leg's position control in flight.
struct LegPositionConfig {
  float stiffness_nmprad = 80.0f;  ///< about the hip; with the leg's inertia: some 25 Hz
  float damping_nmsprad = 0.9f;    ///< about the hip
  float inertia_kgm2 = 0.003f;     ///< of the leg about the hip, toe in the air
};

/// Smallest lever that follow_path() divides by: a leg that is closer to straight has nearly none.
inline constexpr float kShortestLever_m = 0.02f;

/// Leg angles of the last ticks, kept by note_angle().
struct LegPositionState {
  float last_angle_rad = 0.0f,  ///< on the last tick
      angle_before_rad = 0.0f;  ///< on the tick before it
};

/// A point of the leg's path.
struct LegPath {
  float fold_m = 0.0f,           ///< by how much the leg is to be shorter than on its stop
      rate_mps = 0.0f,           ///< first derivative of fold_m
      acceleration_mps2 = 0.0f;  ///< second derivative of fold_m
};

/// Half a wave, or the whole wave, of a raised cosine: `share` 0 to 1 of `time_s`, from 0 up to `height_m` and
/// (`back`) down again; at rest at both ends.
inline LegPath raised_cosine(float height_m, float time_s, float share, bool back) {
  constexpr float kTau = 6.283185307f;
  const float turns = back ? share : 0.5f * share;
  const float rate = kTau * (back ? 1.0f : 0.5f) / time_s;
  const float half = 0.5f * height_m, cosine = sine_of_turns(turns + 0.25f), sine = sine_of_turns(turns);
  return {half * (1.0f - cosine), half * rate * sine, half * rate * rate * cosine};
}

/// Decrease of the leg's length per angle, m/rad: 2 L sin(leg angle).
inline float leg_lever_m(float link_length_m, float leg_angle_rad) {
  return 2.0f * link_length_m * sine_of_turns(leg_angle_rad * 0.159154943f);
}

/// Torque that keeps the leg on its path, N m: feedforward for its inertia and the spring's pull, and proportional and
/// derivative feedback about the hip. One tick; `fold_m` as measured, `pull_n` of the spring along the leg, `lever_m`
/// from leg_lever_m(). The rate is that over the last two ticks.
inline float follow_path(const LegPositionConfig& config, LegPositionState& state, const LegPath& path,
                         float fold_m, float leg_angle_rad, float lever_m, float pull_n, float dt_s) {
  const float rate_radps = (leg_angle_rad - state.angle_before_rad) / (2.0f * dt_s);
  const float per_lever = 1.0f / (lever_m > kShortestLever_m ? lever_m : kShortestLever_m);
  return config.stiffness_nmprad * (path.fold_m - fold_m) * per_lever +
         config.damping_nmsprad * (path.rate_mps * per_lever - rate_radps) +
         config.inertia_kgm2 * path.acceleration_mps2 * per_lever + pull_n * lever_m;
}

/// Damping in a landing without the switch, about the hip; with the leg half folded some 25 N s/m along it, of the 60
/// that would be critical for 1.5 kg on 600 N/m.
inline constexpr float kBrake_nmsprad = 0.5f;

/// Torque that brakes a leg in stance, N m; 0 in flight. The rate is that over the last two ticks.
inline float brake_torque_nm(const LegPositionState& state, const PhaseEstimate& phase, float leg_angle_rad,
                             float dt_s) {
  if (phase.phase == Phase::flight) return 0.0f;
  return -kBrake_nmsprad * (leg_angle_rad - state.angle_before_rad) / (2.0f * dt_s);
}

/// Keeps the angle of a tick for the rate. Call it at the end of each tick, whether the leg is driven or not.
inline void note_angle(LegPositionState& state, float leg_angle_rad) {
  state.angle_before_rad = state.last_angle_rad;
  state.last_angle_rad = leg_angle_rad;
}

}  // namespace furcula::control
