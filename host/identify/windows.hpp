// Windows: the stretches of a recording over which a model runs free from one start.
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "host/identify/recording.hpp"
#include "host/model/model.hpp"

namespace furcula::identify {

enum class WindowKind { stride, stance, flight, interval, release };

/// Rows [first, last] of a recording (both included). Of a release `touchdown` and `liftoff` are the rows
/// in which the coil is switched on and off; else `touchdown` and `liftoff` are the rows where a stride
/// crosses the touch-down height (0 where there is none).
struct Window {
  std::size_t recording = 0;
  std::size_t first = 0;
  std::size_t last = 0;
  WindowKind kind = WindowKind::interval;
  std::size_t touchdown = 0;
  std::size_t liftoff = 0;
  /// Stride: when the switch reported the touch-down, after the measured height fell through the touch-down
  /// height, s; not a number where it did not.
  double report_lag_s = std::numeric_limits<double>::quiet_NaN();
  double report_spread_s = 0.0;     ///< standard deviation of such lags
  double touchdown_velocity = 0.0;  ///< at that crossing, below zero

  std::size_t rows() const { return last - first + 1; }
};

/// Strides of a hopper's recording from apex to apex, found in the height alone: an apex is the top of a
/// stretch that rises at least 3 mm above the touch-down height. A recording that starts at rest in the air
/// begins with an apex.
std::vector<Window> strides(const Recording& r, std::size_t index, const model::Model& model);

/// Stances and flights of a hopper's recording, each from after the impact's vibration (15 ms into stance, 5
/// ms into flight) to before the next one.
std::vector<Window> stances(const Recording& r, std::size_t index, const model::Model& model);
std::vector<Window> flights(const Recording& r, std::size_t index, const model::Model& model);

/// Windows of `length_s` seconds, one after the other from `from_s` seconds after the recording's first row;
/// of a recording that begins under a command 0.1 s later, since what the drive did before is not known; the last one at least half as long. A pause of more than 50 ms, or five rows of a slow log, ends one: what drove it meanwhile is not known.
std::vector<Window> intervals(const Recording& r, std::size_t index, double length_s, double from_s = 0.0);

/// Flights of a rail carriage: rows in a row without contact, at least 30 ms and six rows, each from the
/// first row to the last; a pause of more than 50 ms ends one. Rows in which the carriage rests, before a release or on its stop, or rises faster and
/// faster, as only a push makes it, are no flight; without a contact column all others are.
std::vector<Window> free_flights(const Recording& r, std::size_t index, double gravity_mps2);

/// Releases of a clutch bench: from the rest before the coil is switched on (at most 50 ms of it, at least
/// three rows) to 0.25 s after it is switched off, or to before it is switched on again; at least 30 ms after
/// the switching off, and without a pause.
std::vector<Window> releases(const Recording& r, std::size_t index);

/// The windows that predictions are judged on: strides on the hopper (intervals of a recording that never
/// leaves the ground), flights on the rail carriage, releases on the clutch bench, intervals elsewhere.
std::vector<Window> prediction_windows(const std::vector<Recording>& recordings, const model::Model& model,
                                       double interval_s);

/// The windows that fits are made on: those of predictions; where they are few, also such that begin part-way
/// through them, so that an estimate does not hang on where the windows happen to begin.
struct TrainingWindows {
  std::vector<Window> windows;
  std::size_t layers = 1;  ///< in how many windows each row lies
  /// Squares beyond which a window counts as much as any other (simulation_fit.hpp, Effort).
  double most_squares = std::numeric_limits<double>::infinity();
};
TrainingWindows training_windows(const std::vector<Recording>& recordings, const model::Model& model,
                                 double interval_s);

/// Takes the leg angle out of recordings in which it does not follow the height in stance as z = 2 L
/// cos(theta) says: another unit (of degrees a note tells) or sign, an encoder that stands still, one at the end of its range. What a
/// backlash does to it stays, and a zero that is off.
void keep_plausible_leg_angles(std::vector<Recording>& recordings, const model::Model& model);

/// A start state estimated from the measured positions of the window's first 50 ms alone (its first tenth
/// where that is shorter), with its variance per unit of sample variance.
struct StartState {
  double position = 0.0, velocity = 0.0;
  double position_variance = 0.0, velocity_variance = 0.0, covariance = 0.0;
};

/// By a parabola through those positions; of a release the mean of the rest, with no velocity.
StartState start_state(const Recording& r, const Window& w);

/// By a parabola through what those positions leave over a run of `reference` from the start above: a
/// constant error of the reference's acceleration does no harm, and what the input does within the 50 ms is
/// followed.
StartState start_state(const Recording& r, const Window& w, const model::Model& reference);

}  // namespace furcula::identify
