// What joints do on the paths of a scenario, and paths that stay within limits.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "host/excite/limits.hpp"
#include "host/trees/simulate.hpp"

namespace furcula::excite {

/// Of one joint over a scenario. Units as in JointLimits.
struct Extremes {
  double lowest_rad = 0.0, highest_rad = 0.0, velocity_radps = 0.0, torque_nm = 0.0;
};

/// Without noise and disturbance, every `step_s`. Under the torque law of joints that are on their paths; under the position law
/// of a simulation whose set points the paths are.
std::vector<Extremes> extremes(const trees::TreeModel& model, const trees::Scenario& scenario, double step_s);

/// The largest share of a limit that is used, of position, velocity and torque; above 1 a designed motion breaks one. Of positions it is 1 at
/// the limit.
double used(const Extremes& extremes, const JointLimits& limits);

/// Sums of sines that begin and end at rest, by ramps of half a second. Their frequencies are free: a Fourier series with a harmonic a
/// recording (Swevers and others, Optimal robot excitation and identification, IEEE Trans. Robotics and Automation 13(5), 1997) has a
/// higher peak for the same power.
class Sines {
 public:
  /// Frequencies from one period a recording to `highest_hz`. Motions that the drives cannot make are moved towards `posture`.
  Sines(std::vector<double> posture, double duration_s, double highest_hz);

  /// Numbers that determine the paths: of each joint its centre, then three for each sine.
  std::size_t size() const;
  /// The paths of such numbers, usual ones of about 1 in size, made smaller until they are within the limits; empty where nothing is.
  std::optional<trees::Scenario> within(const trees::TreeModel& model, std::span<const JointLimits> limits,
                                        std::span<const double> numbers, double rate_hz) const;

 private:
  std::vector<double> posture_;
  double duration_s_, highest_hz_;
};

}  // namespace furcula::excite
