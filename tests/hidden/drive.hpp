// The virtual machines' drive: from the command to the torque (or force) at the motor. In closed form between
// the instants at which something changes, so that no integration step enters.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "tests/hidden/laws.hpp"

namespace furcula::hidden {

/// delay -> dead band -> limit -> lag -> [what the drive reports] -> gain, derating -> offset -> ripple ->
/// [delivered].
class Drive {
 public:
  /// Starts at `start_s` with nothing commanded. `draw` decides what is random in it.
  Drive(const std::vector<Planted>& planted, double start_s, std::uint64_t draw);

  /// From `time_s` on; calls in the order of time.
  void command(double time_s, double value);
  /// To be called on the way at each next_change_s(): what has become due by `time_s` takes effect.
  void settle(double time_s);
  /// When something next takes effect; +infinity if nothing is under way.
  double next_change_s() const;

  // Both are for times from the last settle() to the next change.
  double reported(double time_s) const;
  /// `angle_rad`: the motor's, for the ripple.
  double delivered(double time_s, double angle_rad) const;

 private:
  struct Change {
    double time_s, value;
  };
  double target() const;

  double delay_s_ = 0, time_constant_s_ = 0, limit_, dead_band_ = 0;
  double gain_ = 1, final_gain_ = 1, derating_s_ = 1, offset_ = 0;
  double ripple_ = 0, ripple_cycles_ = 0, ripple_phase_rad_ = 0;
  std::vector<double> dropouts_s_;  // instants at which it goes off, on, off, ...

  std::deque<Change> pending_;
  double value_ = 0, since_s_, lag_from_ = 0, commanded_s_ = 0;
  std::size_t dropout_ = 0;  // how many of the instants are over
};

}  // namespace furcula::hidden
