// The seam between a bench experiment and the stand that it runs on.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace furcula::bench {

/// How one release and catch is set up.
struct Conditions {
  double load_kg = 1.0;
  double window_s = 0.040;  ///< from the release command to the catch command
  double supply_v = 12.0;
  double pressing_n = 8.0;  ///< of the return spring on the key
};

/// Of a trial, in milliseconds: it hangs, is released for the window, and is watched.
struct Timing {
  std::size_t rest = 20, window = 40, watch = 500;
  std::size_t rows() const { return rest + window + watch + 1; }
};

/// What the board read at an instant, and what it told the coil from then on.
struct Reading {
  std::int32_t count = 0;  ///< of the pulley's encoder, from where the belt hung; positive: the load is lower
  double current_a = std::numeric_limits<double>::quiet_NaN();  ///< of the coil, where it is measured
  double voltage_v = 0.0;  ///< across the coil until then; NaN where it is not measured
  double coil = 0.0;       ///< share of the supply, from then on
};

/// What of the conditions a board sets up by itself: all of them, or the window alone. Where a person hangs
/// the weight, the conditions say what is there.
enum class Adjusts : std::uint8_t { everything, window };

class Board {
 public:
  Board() = default;
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;
  virtual ~Board() = default;

  virtual std::string name() const = 0;
  virtual Adjusts adjusts() const { return Adjusts::everything; }
  virtual double metres_per_count() const = 0;
  virtual double pulley_radius_m() const = 0;
  virtual double tooth_pitch_m() const = 0;
  virtual double travel_m() const = 0;  ///< of the load, to the floor or the belt's end
  /// A trial whose load hangs at rest on the caught belt before it: its rows, a millisecond apart, the first
  /// at 0. The conditions' window is not looked at. @throws core::DataError where the stand does not play
  /// along.
  virtual std::vector<Reading> run(const Conditions& conditions, const Timing& timing) = 0;
};

}  // namespace furcula::bench
