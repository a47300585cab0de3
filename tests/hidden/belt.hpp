// The virtual release/catch bench of the hidden-effect tests: a weight on a toothed belt, let go and caught
// by a key. Written from the contract, by classic Runge-Kutta steps with events found by bisection; it shares
// no code with the plant that the diagnosis simulates with.
//
// Where the contract's line leaves a choice, it is made here:
// - a tooth holds the belt if the holding force is at least the load on it: the belt's pull half-way to the
//   next tooth plus its kinetic energy over a pitch (clutch_slip). Else the belt goes on to that tooth, with
//   the holding force against it.
// - the auxiliary spring is slack at the encoder's zero.
#pragma once

#include <cstdint>
#include <vector>

#include "host/log/log.hpp"
#include "tests/hidden/machine.hpp"
#include "tests/hidden/random.hpp"

namespace furcula::hidden {

class Belt {
 public:
  /// Hangs caught at the angle 0 from the time 0 on.
  explicit Belt(const Truth& truth);

  /// Pulls the key out, or presses it on the belt: from then on.
  void pull_key();
  void press_key();
  void advance(double until_s);

  double time_s() const { return time_s_; }
  double angle_rad() const { return angle_; }
  double speed_radps() const { return speed_; }
  bool held() const { return state_ == State::held; }
  int skipped() const { return skipped_; }

 private:
  enum class State { held, loose, seeking, skipping };
  double torque(double angle, double speed, bool with_friction) const;
  void stepped(double h, double& angle, double& speed) const;
  double next_tooth(int direction) const;
  bool bears() const;

  double mass_, radius_, inertia_, damping_, spring_npm_, pitch_rad_;
  Disturbed disturbed_;
  double friction_nm_ = 0, holding_n_ = 1e12, snag_nm_ = 0, snag_from_ = 0, snag_to_ = 0, warm_nm_ = 0,
         warming_s_ = 1;
  double time_s_ = 0, angle_ = 0, speed_ = 0, from_ = 0;
  State state_ = State::held;
  int skipped_ = 0;
};

struct BenchExperiment {
  std::vector<double> windows_s;  ///< of the coil, one after the other
  double rest_s = 0.3;            ///< before each, and after the last
};

struct BenchSensors {
  double quantum_rad = 2.0 * 3.14159265358979323846 / 2400;
  double noise_rad = 0.0;  ///< standard deviation, before quantisation
  double dropped_fraction = 0.0;
};

log::Log record_bench(const Truth& truth, const BenchExperiment& experiment, const BenchSensors& sensors,
                      Random& random);

}  // namespace furcula::hidden
