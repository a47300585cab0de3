// The motor moves the leg in flight along a path of its length.
#pragma once

#include "furcula/control/phase.hpp"
#include "furcula/core/sine.hpp"

namespace furcula::control {

struct LegPositionConfig {
  float stiffness_nmprad = 80.0f;  ///< with the leg's inertia: some 25 Hz
  float damping_nmsprad = 0.9f;
  float inertia_kgm2 = 0.003f;  ///< of the leg about the hip, toe in the air
};

/// A leg that is closer to straight has none to speak of.
inline constexpr float kShortestLever_m = 0.02f;

struct LegPositionState {
  float last_angle_rad = 0.0f, angle_before_rad = 0.0f;
};

/// By how much the leg is to be shorter than on its stop, m, and its derivatives.
struct LegPath {
  float fold_m = 0.0f, rate_mps = 0.0f, acceleration_mps2 = 0.0f;
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

/// Of the leg's length over its angle, m/rad: 2 L sin(leg angle).
inline float leg_lever_m(float link_length_m, float leg_angle_rad) {
  return 2.0f * link_length_m * sine_of_turns(leg_angle_rad * 0.159154943f);
}

/// Torque that keeps the leg on its path, N m: what its inertia and the spring's pull take, and springs and
/// dampers about the hip for the rest. One tick; `fold_m` as measured, `pull_n` of the spring along the leg.
/// The rate is that over the last two ticks.
inline float follow_path(const LegPositionConfig& config, LegPositionState& state, const LegPath& path,
                         float fold_m, float leg_angle_rad, float lever_m, float pull_n, float dt_s) {
  const float rate_radps = (leg_angle_rad - state.angle_before_rad) / (2.0f * dt_s);
  const float per_lever = 1.0f / (lever_m > kShortestLever_m ? lever_m : kShortestLever_m);
  return config.stiffness_nmprad * (path.fold_m - fold_m) * per_lever +
         config.damping_nmsprad * (path.rate_mps * per_lever - rate_radps) +
         config.inertia_kgm2 * path.acceleration_mps2 * per_lever + pull_n * lever_m;
}

/// Of a landing without the switch. About the hip; with the leg half folded some 25 N s/m along it, of the 60
/// that would be critical for 1.5 kg on 600 N/m.
inline constexpr float kBrake_nmsprad = 0.5f;

/// Torque that takes motion out of a leg in stance, and never puts any in, N m. The rate is that over the last
/// two ticks.
inline float brake_torque_nm(const LegPositionState& state, const PhaseEstimate& phase, float leg_angle_rad,
                             float dt_s) {
  if (phase.phase == Phase::flight) return 0.0f;
  return -kBrake_nmsprad * (leg_angle_rad - state.angle_before_rad) / (2.0f * dt_s);
}

/// One tick, whether the leg is driven or not: takes note of the angle.
inline void note_angle(LegPositionState& state, float leg_angle_rad) {
  state.angle_before_rad = state.last_angle_rad;
  state.last_angle_rad = leg_angle_rad;
}

}  // namespace furcula::control
