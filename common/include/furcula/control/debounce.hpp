// The contact switch bounces: what it reports, freed from chatter.
#pragma once

#include <cstdint>

namespace furcula::control {

/// How a change of the switch is accepted.
enum class DebounceRule : std::uint8_t {
  two_readings,  ///< Algorithm 1 of 002 section 4.1: a change counts when the switch reads so twice running
  settling,      ///< a level rises while the switch reads closed and falls while open, and has two thresholds
};

/// Rule and times of the debouncing.
struct DebounceConfig {
  DebounceRule rule = DebounceRule::two_readings;  ///< the times below are used by `settling` only
  /// Time that the switch must read closed, net of open readings, for the level to rise from 0 to 1.
  float close_settle_s = 0.003f;
  /// Time that the switch must read open, net of closed readings, for the level to fall from 1 to 0.
  float open_settle_s = 0.005f;
};

/// State of debounce().
struct DebounceState {
  bool closed = false;        ///< the debounced contact
  bool last_reading = false;  ///< of the switch
  float level = 0.0f;         ///< for `settling`: 0 = surely open, 1 = surely closed
};

/// One reading `dt_s` after the last. @returns whether the contact counts as closed.
inline bool debounce(const DebounceConfig& config, DebounceState& state, bool reading, float dt_s) {
  switch (config.rule) {
    case DebounceRule::two_readings:
      if (reading == state.last_reading) state.closed = reading;
      break;
    case DebounceRule::settling:
      state.level += reading ? dt_s / config.close_settle_s : -dt_s / config.open_settle_s;
      // A hair inside the thresholds, so that n readings of 1/n reach them despite rounding.
      if (state.level > 0.9999f) {
        state.level = 1.0f;
        state.closed = true;
      } else if (state.level < 0.0001f) {
        state.level = 0.0f;
        state.closed = false;
      }
      break;
  }
  state.last_reading = reading;
  return state.closed;
}

}  // namespace furcula::control
