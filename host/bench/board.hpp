// The seam between a bench experiment and the stand that it runs on.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace furcula::bench {

/// How one release and catch is set up.
struct Conditions {
  double load_kg = 1.0;
  double window_s = 0.040;  ///< from the release command to the catch command
  double supply_v = 12.0;
  double pressing_n = 8.0;  ///< of the return spring on the key
};

struct Reading {
  std::int32_t count = 0;  ///< of the pulley's encoder, from where the belt hung; positive: the load is lower
  double current_a = std::numeric_limits<double>::quiet_NaN();  ///< of the coil, where it is measured
  double voltage_v = 0.0;                                       ///< across the coil
};

class Board {
 public:
  Board() = default;
  Board(const Board&) = delete;
  Board& operator=(const Board&) = delete;
  virtual ~Board() = default;

  virtual std::string name() const = 0;
  virtual double metres_per_count() const = 0;
  virtual double pulley_radius_m() const = 0;
  virtual double tooth_pitch_m() const = 0;
  virtual double travel_m() const = 0;  ///< of the load, to the floor or the belt's end
  /// The load hangs at rest on the caught belt.
  virtual void prepare(const Conditions& conditions) = 0;
  /// One millisecond with the coil switched on or off; what is read at its end.
  virtual Reading tick(bool coil) = 0;
};

}  // namespace furcula::bench
