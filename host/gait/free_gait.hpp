// Gaits of free torques: the joints' angles over stance and flight are splines, the torques those that these
// need. So every candidate obeys the equations of motion exactly, and what is left to the optimiser is the cost,
// the events, and the ground that only pushes.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/gait/machine.hpp"
#include "host/optimise/spline.hpp"

namespace furcula::gait {

using optimise::Spline;

/// What a gait has to do: in place with a toe clearance, or forward with a speed.
struct Task {
  std::optional<double> clearance_m;  ///< in place: the toe's highest point
  std::optional<double> speed_mps;    ///< forward; below zero the knee points forward
  LegLiftOff lift_off = LegLiftOff::force;
  std::optional<double> touchdown_knee_rad;
  std::optional<double> friction;  ///< of the ground; without it the toe never slips
  double landing_speed_mps =
      0.0;  ///< with which the toe comes down at least; one that comes down slowly may miss
};

/// The angles of hip and knee over one phase.
struct JointPath {
  double duration_s = 0.0;
  std::vector<double> hip, knee;  ///< coefficients

  Spline spline() const { return Spline(hip.size() - Spline::kDegree); }
  struct At {
    Joints2<double> angle, rate, acceleration;
  };
  /// Outside of the phase the polynomials at its ends go on.
  At at(double time_s) const;
  /// The n-th derivative by time, in one of the spline's intervals.
  Joints2<double> derivative(double time_s, std::size_t n, std::size_t interval) const;
};

/// In stance; rising until the toe is highest (in place) or the hip is (forward); falling until touch-down.
struct FreeGait {
  std::array<JointPath, 3> phases;
  double cost = 0.0;  ///< as the optimiser sees it: J in place, else of transport

  JointPath& stance() { return phases[0]; }
  const JointPath& stance() const { return phases[0]; }
  /// Of a switched spring: the knee's angle where it catches, and what the tooth loses.
  double spring_rest_rad(const Catching& catching) const {
    return catching.delay_s > 0.0 ? stance().at(catching.delay_s).angle.knee + catching.lost_rad
                                  : stance().knee.front() + catching.lost_rad;
  }
};

/// Whether the spring's torque has a kink inside a phase.
inline bool has_kinks(const Machine& machine, const Task& task) {
  return machine.spring == LegSpring::parallel ||
         (machine.spring == LegSpring::switched &&
          (task.lift_off == LegLiftOff::unguarded || !machine.catching.ideal()));
}

struct FreeOptions {
  std::size_t stance_intervals = 16, flight_intervals = 8;  ///< of each part of the flight
  int iterations = 300;
  double margin = 0.0;  ///< N of the ground's force, 0.1 mm of the toe's height, % of the motors' limits
  bool near = false;    ///< the start is a gait of a similar task
  std::function<bool(int iteration, double cost, double violation)> progress;
};

struct FreeResult {
  bool found = false;
  std::string status, worst;
  double violation = 0.0;
  int iterations = 0;
  FreeGait gait;
};

/// A rough hop to start from. `variety` 0 is the plain one; others differ at random, the same for the same number.
FreeGait rough_gait(const Machine& machine, const Task& task, std::uint64_t variety);

FreeResult find_free_gait(const Machine& machine, const Task& task, const FreeGait& start,
                          const FreeOptions& options);

}  // namespace furcula::gait
