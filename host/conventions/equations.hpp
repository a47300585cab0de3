// The equations of all joints of a machine over the instants of its recordings, as they are read.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

#include "host/conventions/equation.hpp"
#include "host/conventions/instants.hpp"
#include "host/conventions/trial.hpp"

namespace furcula::conventions {

/// With fewer instants nothing is said.
inline constexpr std::size_t kFewestInstants = 40;

/// Log likelihood an instant by which each change of the reading must be ahead: the rest of a joint's equation falls to a third. What is
/// left after the right reading is what the model lacks, which is no noise; so how far it falls counts, not how many instants say so.
/// Causes of the catalogue do not look like that by chance (docs/decisions/0035-conventions-before-causes.md).
inline const double kFarBetter = std::log(3.0);
/// Signs and columns of two joints that are exchanged are the commonest faults: each counts for half a change. Of 404 machines with causes of the catalogue and
/// without, none gained more than 0.14 by a wrong one; half a change is 0.55.
inline constexpr double kSignOrExchange = 0.5;
/// An estimated number counts for half a change more: it would fit many a thing.
inline constexpr double kEstimated = 0.5;
/// At each joint a reading leaves less of the force, mean square, than it explains, or no more than the columns as named do.
inline constexpr double kUnexplained = 0.5;
/// With the columns as named: a scale of kNearOne or a zero of kNearZero_rad leaves half of the force; a part of that is fitted away by
/// what the trial fits in any case. A model that leaves less, and explains the accelerations, has no wrong unit, however much better
/// another reading is.
inline constexpr double kAsked = 0.2;

struct Equations {
  std::vector<Equation> of;  ///< each joint
  /// What the instants' likelihood has beside the rests: the Jacobian, and what the signals that stand for positions would be worth without a
  /// model (another signal says so much less if it is explained).
  double beside = 0.0;
  Eigen::MatrixXd mass;  ///< mean over the instants

  /// Of every `step`-th instant. False where the model says nothing of so many instants.
  bool write(const Family& family, std::span<const Instant> instants, std::size_t step,
             const Reading& reading);
  /// Log likelihood an instant, with these rests of the joints and the prior of what was fitted; of `instants` instants.
  double fit(const std::vector<Rest>& rests, std::size_t instants) const;
};

}  // namespace furcula::conventions
