// The release/catch test of 002 section 5.1 as a board runs it: from rest the coil on for a window, then the
// catch is watched. What the load does meanwhile is in the rows of the trial, one a tick.
#pragma once

#include <cstdint>

namespace furcula::control {

/// Whether the board is on the clutch's bench, and the times of a trial.
struct BenchConfig {
  /// 1: the board is a clutch's on its bench, without leg, rail and drive; to run is to make one trial.
  std::uint32_t on_bench = 0;
  std::uint32_t rest_ticks = 20;    ///< before the release command; a tick is 1 ms
  std::uint32_t window_ticks = 40;  ///< from the release command to the catch command; the coil is on
  std::uint32_t watch_ticks = 500;  ///< after the catch command
};

/// Rows of a trial: at its beginning, and at the end of each of its ticks.
constexpr std::uint32_t trial_rows(const BenchConfig& c) {
  return c.rest_ticks + c.window_ticks + c.watch_ticks + 1;
}

/// Progress of a trial; a new one begins with the default values.
struct BenchState {
  std::uint32_t rows = 0;  ///< of the trial so far
};

/// What one tick of the bench yields.
struct TrialEstimate {
  std::uint32_t row = 0;  ///< which this tick's sample is
  bool runs = false;      ///< this tick's sample is a row
  bool ended = false;     ///< all rows are there
  bool coil = false;      ///< the coil shall be on
};

/// One tick of a trial.
inline TrialEstimate run_trial(const BenchConfig& config, BenchState& state) {
  TrialEstimate out;
  if (state.rows < trial_rows(config)) {
    out.runs = true;
    out.row = state.rows++;
    out.coil = out.row >= config.rest_ticks && out.row < config.rest_ticks + config.window_ticks;
  }
  out.ended = state.rows >= trial_rows(config);
  return out;
}

}  // namespace furcula::control
