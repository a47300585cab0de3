// The contact switch bounces: what it reports, freed from chatter.
#pragma once

#include <cstdint>

namespace furcula::control {

enum class DebounceRule : std::uint8_t {
  two_readings,  ///< Algorithm 1 of 002 section 4.1: a change counts when the switch reads so twice running
  settling,      ///< a level rises while the switch reads closed and falls while open, and has two thresholds
};

struct DebounceConfig {
  DebounceRule rule = DebounceRule::two_readings;
  /// For `settling`: how long the switch must read closed, net of open readings, for the level to go from one
  /// threshold to the other, and the same for open; s.
  float close_settle_s = 0.003f;
  float open_settle_s = 0.005f;
};

struct DebounceState {
  bool closed = false;
  bool last_reading = false;
  float level = 0.0f;  ///< for `settling`: 0 = surely open, 1 = surely closed
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
