// The release/catch test of 002 section 5.1: a weight hangs on the clutch's belt, is let go and caught again.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string_view>
#include <vector>

#include "host/bench/board.hpp"
#include "host/bench/limits.hpp"
#include "host/log/log.hpp"

namespace furcula::bench {

/// One release and catch, as its encoder saw it. Times in s, NaN where it did not happen.
struct Trial {
  Conditions conditions;
  /// From the release command to the first motion.
  double released_after_s = std::numeric_limits<double>::quiet_NaN();
  /// From the catch command to the last motion before it stood for 50 ms, not at the end of its way.
  double caught_after_s = std::numeric_limits<double>::quiet_NaN();
  double drop_m = 0.0;            ///< from where the load hung to where it stood
  bool held = true;               ///< before the release command
  bool slipped = false;           ///< it moved again after it stood
  std::vector<Reading> readings;  ///< a millisecond apart, the first at 0

  bool released() const { return released_after_s == released_after_s; }
  bool caught() const { return caught_after_s == caught_after_s; }  ///< after it was released
};

/// Hangs for kRest_s, is released, caught, and watched for kWatch_s after the catch command.
inline constexpr double kRest_s = 0.020, kWatch_s = 0.500;
Trial run_trial(Board& board, const Conditions& conditions);

/// @throws core::DataError where rows are missing, or the coil was not on just when it was to be.
void require_as_told(const std::vector<Reading>& rows, const Timing& timing, const std::string& board);

/// As furcula-log/1 of the rig clutch_bench.
log::Log to_log(const Trial& trial, const Board& board, const std::string& path);

/// The largest load that the clutch holds without being released, kg, to 0.5 %; 0 if not 10 g.
double holding_load_kg(Board& board, const Conditions& conditions);

/// Of all trials; times over those that were caught, NaN if there is none.
struct Summary {
  std::size_t trials = 0, not_held = 0, not_released = 0, not_caught = 0, slips = 0;
  double caught_after_median_s, caught_after_p5_s, caught_after_p95_s, caught_after_worst_s;
  double released_after_worst_s;
  double drop_median_m, drop_worst_m;
};
Summary summarise(const std::vector<Trial>& trials);

struct Options {
  Conditions conditions;
  std::size_t trials = 100;  ///< with load, window and supply varied
  double load_share = 0.2;   ///< by which the load varies either way
  double window_s = 0.005;   ///< by which the window varies either way
  double supply_share = 0.1;
  std::uint64_t seed = 0;
  std::function<void(double fraction, std::string_view doing)> progress;
};

struct Sweep {
  std::string_view of;  ///< "load_kg", "window_s" or "pressing_n"
  std::vector<double> values;
  std::vector<Trial> trials;
};

/// The largest load that a pressing force holds.
struct Holding {
  double pressing_n, load_kg;
};

/// A check of the limits: what was measured against what was asked.
struct Check {
  std::string_view name, unit;
  double measured, limit;
  bool at_most;  ///< else at least
  bool passed;
};

struct ReleaseCatch {
  std::string board;
  Options options;
  Trial standard;             ///< at the conditions given
  std::vector<Trial> trials;  ///< varied; without readings but the worst
  std::size_t worst = 0;      ///< not caught, else caught last
  Summary summary;
  std::vector<Sweep> sweeps;
  /// Over the pressing force; empty where the board does not set the load.
  std::vector<Holding> holding;
  double holding_kg = 0.0;  ///< at the conditions given; NaN where it was not looked for
  std::vector<Check> checks;
  bool passed = true;
};

/// The whole test; on a board that adjusts no more than the window, what varies that alone. The same options
/// give the same result on a board that does. @throws core::DataError as Board::run() does, and where a limit
/// asks for what the board cannot look for.
ReleaseCatch run_release_catch(Board& board, const Options& options, const Limits& limits);

}  // namespace furcula::bench
