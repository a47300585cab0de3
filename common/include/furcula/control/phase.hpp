// Phase of the robot's stride: flight or stance, since when, and the height of the last apex.
#pragma once

#include <cstdint>

#include "furcula/control/height.hpp"

namespace furcula::control {

/// Phase of a stride.
enum class Phase : std::uint8_t {
  flight = 0,  ///< the toe is off the ground
  stance = 1   ///< the toe is on the ground
};

/// Thresholds of touch-down and lift-off.
struct PhaseConfig {
  float touchdown_height_m = 0.2819f;  ///< of the body, with the straight leg: 2 L cos(touch-down angle)
  /// The switch reports up to 10 ms early: further above the touch-down height than this a closed switch is
  /// no touch-down; m.
  float touchdown_margin_m = 0.03f;
  /// A body that rises faster does not touch down: lift-off's bounce closes the switch again; m/s.
  float touchdown_velocity_max_mps = 0.1f;
  /// Further above the touch-down height than this a straight leg does not reach the ground, whatever the
  /// switch reads (it reports lift-off up to 10 ms late); a leg is straight within this length; m.
  float liftoff_margin_m = 0.005f;
  /// Debouncing takes time, and the switch reports up to 10 ms late: how long ago the body passed the
  /// touch-down height follows from height and velocity, up to this time; s.
  float latest_report_s = 0.012f;
  /// The touch-down's bounce ends within this time: an open switch before is no lift-off; s.
  float shortest_stance_s = 0.02f;
};

/// State of estimate_phase() between two ticks.
struct PhaseState {
  Phase phase = Phase::flight;  ///< current phase
  bool seen_open = true;        ///< open since lift-off: a switch that stays closed is no second touch-down
  std::uint32_t ticks_in_phase = 0;       ///< since the phase was detected; saturates
  std::uint32_t ticks_of_last_phase = 0;  ///< length of the phase before
  float touchdown_before_s = 0.0f;        ///< from the last touch-down to the tick that detected it
  float highest_m = 0.0f;                 ///< greatest height in this flight
  float apex_height_m = 0.0f;  ///< greatest height in the last whole flight; 0 before there was one
};

/// Result of one tick.
struct PhaseEstimate {
  Phase phase = Phase::flight;     ///< phase after this tick
  bool touchdown = false;          ///< on this tick
  bool liftoff = false;            ///< on this tick
  float since_touchdown_s = 0.0f;  ///< since the last one; before the first one, since the start
  float since_liftoff_s = 0.0f;    ///< since the last one; before the first one, since the start
  float apex_height_m = 0.0f;      ///< highest point of the last whole flight; 0 before there was one
};

/// How long ago a body that moves down passed the touch-down height, s. 0: it is still above, it does not move down,
/// or it was longer ago than latest_report_s.
inline float time_since_passed(const PhaseConfig& config, const HeightEstimate& height) {
  const float below_m = config.touchdown_height_m - height.height_m;
  if (!(below_m > 0.0f) || !(height.velocity_mps < 0.0f)) return 0.0f;
  const float time_s = below_m / -height.velocity_mps;
  return time_s < config.latest_report_s ? time_s : 0.0f;
}

/// One tick. `contact_closed` is the debounced switch, `height` from the encoder, `leg_m` the leg's length.
inline PhaseEstimate estimate_phase(const PhaseConfig& config, PhaseState& state, bool contact_closed,
                                    const HeightEstimate& height, float leg_m, float dt_s) {
  const float height_m = height.height_m;
  PhaseEstimate estimate;
  if (state.ticks_in_phase != 0xffffffffu) ++state.ticks_in_phase;
  const float in_phase_s = static_cast<float>(state.ticks_in_phase) * dt_s;
  if (state.phase == Phase::flight) {
    if (height_m > state.highest_m) state.highest_m = height_m;
    if (!contact_closed) state.seen_open = true;
    // A body this far below has its leg bent on the ground, also where a lift-off was seen that was none.
    const bool stands = height_m < config.touchdown_height_m - config.touchdown_margin_m;
    estimate.touchdown = contact_closed && (state.seen_open || stands) &&
                         height.velocity_mps <= config.touchdown_velocity_max_mps &&
                         height_m <= config.touchdown_height_m + config.touchdown_margin_m;
  } else {
    const bool out_of_reach = height_m > config.touchdown_height_m + config.touchdown_margin_m;
    const bool rising_out = height_m > config.touchdown_height_m + config.liftoff_margin_m &&
                            leg_m > config.touchdown_height_m - config.liftoff_margin_m &&
                            in_phase_s >= config.shortest_stance_s;
    const bool opened = !contact_closed && in_phase_s >= config.shortest_stance_s;
    estimate.liftoff = out_of_reach || rising_out || opened;
  }
  if (estimate.touchdown || estimate.liftoff) {
    if (estimate.touchdown) {
      state.apex_height_m = state.highest_m;
      state.touchdown_before_s = time_since_passed(config, height);
    }
    state.highest_m = 0.0f;
    state.seen_open = false;
    state.phase = estimate.touchdown ? Phase::stance : Phase::flight;
    state.ticks_of_last_phase = state.ticks_in_phase;
    state.ticks_in_phase = 0;
  }
  const float now_s = static_cast<float>(state.ticks_in_phase) * dt_s;
  const float before_s = static_cast<float>(state.ticks_of_last_phase) * dt_s;
  estimate.phase = state.phase;
  estimate.since_touchdown_s =
      (state.phase == Phase::stance ? now_s : now_s + before_s) + state.touchdown_before_s;
  estimate.since_liftoff_s = state.phase == Phase::flight ? now_s : now_s + before_s;
  estimate.apex_height_m = state.apex_height_m;
  return estimate;
}

}  // namespace furcula::control
