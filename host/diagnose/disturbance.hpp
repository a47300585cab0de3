// A random force (Ornstein-Uhlenbeck) and random impacts that disturb a machine: a Kalman filter of linearised free runs, and the sizes under
// which the measured positions are likeliest.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <vector>

#include "host/diagnose/linear_runs.hpp"

namespace furcula::diagnose {

struct Disturbance {
  double force = 0;             ///< root mean square, N or N m
  double correlation_s = 0.02;  ///< of the force
  double impact = 0;            ///< standard deviation of the speed after an impact, as a share of it
  double noise = 1;             ///< of the sensor, as a multiple of the recording's position noise
};

/// Kalman filter of (position, velocity, random force). In each row measure(), then predict() the next.
struct DisturbanceFilter {
  /// Transition to the next row; covariance of the state.
  Eigen::Matrix3d step = Eigen::Matrix3d::Zero(), spread = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gain;
  double deviation = 0;  ///< standard deviation of what a measurement finds new

  DisturbanceFilter(const LinearRun& w, const Disturbance& disturbance) {
    spread(0, 0) = std::pow(1e3 * w.noise, 2);
    spread(1, 1) = std::pow(1e3 * w.noise / (10 * w.interval_s), 2);
    spread(2, 2) = disturbance.force * disturbance.force;
  }
  void measure(const LinearRun& w, const Disturbance& disturbance) {
    const double variance = spread(0, 0) + std::pow(disturbance.noise * w.noise, 2);
    deviation = std::sqrt(variance);
    gain = spread.col(0) / variance;
    spread -= gain * spread.row(0).eval();
  }
  void predict(const LinearRun& w, const Disturbance& disturbance, std::size_t i) {
    const double kept = std::exp(-w.interval_s / disturbance.correlation_s);
    step.topLeftCorner<2, 2>() = w.by[i];
    step.topRightCorner<2, 1>() = w.force[i];
    step(2, 2) = kept;
    spread = (step * spread * step.transpose()).eval();
    spread(2, 2) += disturbance.force * disturbance.force * (1 - kept * kept);
    spread(1, 1) += std::pow(disturbance.impact * w.impact_speed[i], 2);
  }
};

inline constexpr std::size_t kSettles = 4;  ///< rows in which the filter learns its start

/// Minus twice the logarithm of the likelihood of a run's first rows, but for a constant.
double deviance(const LinearRun& w, const Disturbance& disturbance, std::size_t rows);

/// Under which the runs are likeliest, by a search on a grid; of many runs, some that lie evenly. `typical_force`: N or N m.
Disturbance likeliest_disturbance(const std::vector<LinearRun>& runs, double typical_force);

}  // namespace furcula::diagnose
