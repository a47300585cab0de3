// What a flexible law (flexible_law.hpp) predicts of what a model leaves.
#pragma once

namespace furcula::diagnose {

/// What the flexible law does on recordings that it was not learned on.
struct Predictable {
  /// Root mean square of what it adds, N or N m.
  double force = 0.0;
  /// Of the squares that free runs with their best start leave, what it takes off; below 0: it adds.
  double share = 0.0;
  /// What it gains, in standard errors of that over the windows: by what the filter finds new, or by free runs.
  double deviations = 0.0;
  /// Root mean square of what it changes in the positions of free runs, over the sensor's noise.
  double noises = 0.0;

  /// It takes off something that counts.
  bool counts(double typical_force) const {
    constexpr double kSure = 3.0, kCounts = 0.01, kShare = 0.02, kNoises = 0.5;
    return noises > kNoises && deviations > kSure && force > kCounts * typical_force && share > kShare;
  }
};

}  // namespace furcula::diagnose
