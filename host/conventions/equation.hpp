// A joint's equation of motion over the instants of the recordings, and what is fitted to it beside the model (trial.hpp).
#pragma once

#include <Eigen/Core>
#include <vector>

namespace furcula::conventions {

/// How a joint's input is read.
struct InputScale {
  double scale = 1.0;
  bool estimated = false;
};

/// What is left of an equation.
struct Rest {
  double mean_square = 0.0;  ///< trimmed
  double input_scale = 1.0;
  double force = 0.0;           ///< RMS of what is asked for with what was fitted, or given
  double pushed = 0.0;          ///< RMS of what is given
  double inertia = 0.0;         ///< that was fitted beside the joint's
  double constant = 0.0;        ///< force that was fitted
  double inertia_factor = 1.0;  ///< by which the joint's is so much more, or less
  /// Log likelihood an instant that the drive's force is worth: without it the rest would be so much larger.
  double worth_of_drive() const;
  double off() const;  ///< RMS of what is left over that of the force
};

/// The largest twentieth of what is left is left out: an impact, a knock.
inline constexpr double kTrimmed = 0.05;
/// Without the largest kTrimmed of them.
double trimmed_mean(std::vector<double> squares);

/// A column of a joint's equation, with the bounds of its coefficient.
struct Column {
  std::vector<double> values;
  double lower, upper;
  bool friction = false;  ///< or a constant force
  double inertia = 0.0;   ///< what one of it adds to the joint's inertia, as a share
};

/// The columns of each joint's equation, in their order; from kFree on the free parameters.
enum : Eigen::Index { kCoulomb, kViscous, kRotor, kConstant, kFree };

/// A joint's equation over the instants: input scale x given = needed + columns x coefficients.
struct Equation {
  std::vector<double> needed, given, of_drive;
  std::vector<double> passive;  ///< gravity, springs: `needed` without the drive's part and the inertia's
  std::vector<Column> columns;
  /// What one of a rotor's inertia adds to the joint's, as a share; summed over the instants.
  double rotor_share = 0.0;
  bool falls = false;   ///< its weight and its inertia are of one mass
  double acting = 0.0;  ///< RMS of what acts beside the drive: gravity, springs

  /// Of the input, to move as it does without friction.
  double likely_scale() const;

  /// With `any_cause`, whatever a cause of the catalogue may be: friction of any size (a constant force stays bounded), and gravity and springs that are off by as much as an
  /// inertia may be.
  Rest solve(InputScale how, bool any_cause = false) const;
};

}  // namespace furcula::conventions
