// Writes down a hopper's rig, a row a millisecond.
#pragma once

#include <vector>

#include "boards/sim_host/board.hpp"
#include "host/log/log.hpp"

namespace furcula::sim {

/// The columns of simulate() on a hopper.
class HopperRecorder {
 public:
  explicit HopperRecorder(double duration_s);

  /// The tick that the board is at, after its command; rows without a height are left out.
  void add(sim_host::SimBoard& board);

  /// Puts the columns into `log`; `clutch`: with that of the cable.
  void finish(log::Log& log, bool clutch);

 private:
  std::vector<std::vector<double>> values_;
};

}  // namespace furcula::sim
