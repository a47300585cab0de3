// Drive of the clutch's coil: full supply until the key is in, less to keep it there, and never more heat than the
// coil stands.
#pragma once

#include <cstdint>

namespace furcula::control {

/// Drive and thermal limit of the coil.
struct CoilConfig {
  float peak_s = 0.035f;    ///< full supply for so long pulls the key in
  float hold_duty = 0.45f;  ///< share of the supply that keeps it in
  float longest_s = 1.0f;   ///< that the coil may be on without a pause
  /// The limit of I^2 t: the duty's square, its mean over this time with the past fading, stays below
  /// heat_max, which is what the coil stands for ever (1: full supply for ever).
  float heat_time_constant_s = 60.0f;
  float heat_max = 0.35f;  ///< limit of CoilState::heat, 0 to 1: mean square of the duty
};

/// State of drive_coil().
struct CoilState {
  std::uint32_t ticks_on = 0;  ///< ticks with a duty above 0 since the coil was wanted
  float heat = 0.0f;           ///< 0 cold, 1 what full supply comes to
  bool blocked = false;  ///< too hot or too long: until it has cooled by a tenth and is not wanted any more
};

/// One tick. @returns share of the supply across the coil over the coming tick, 0 to 1.
inline float drive_coil(const CoilConfig& config, CoilState& state, bool wanted, float dt_s) {
  if (state.heat >= config.heat_max) state.blocked = true;
  if (!wanted) {
    state.ticks_on = 0;
    if (state.heat < 0.9f * config.heat_max) state.blocked = false;
  }
  const float on_s = static_cast<float>(state.ticks_on) * dt_s;
  if (wanted && on_s >= config.longest_s) state.blocked = true;
  const float duty = !wanted || state.blocked ? 0.0f : on_s < config.peak_s ? 1.0f : config.hold_duty;
  if (duty > 0.0f) ++state.ticks_on;
  state.heat += (duty * duty - state.heat) * (dt_s / config.heat_time_constant_s);
  return duty;
}

}  // namespace furcula::control
