// What a search tries: each effect at each site, and at several sites with one value, as probes that a linear test can
// tell the size of.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "host/trees/fit.hpp"

namespace furcula::trees {

/// Cycles a turn that torque ripple is asked about, where the joint's travel times them is a cycle and a half at least.
inline constexpr int kFewestCycles = 2, kMostCycles = 48;
inline constexpr double kTravel_rad = 9.0;

/// A cause at its sites, in so many columns: the change that each of `columns` makes is taken as linear.
struct Candidate {
  Effect effect;
  std::vector<std::size_t> sites;
  std::vector<Cause> columns;
  bool only_forward = true;  ///< coefficients below zero make no sense
  std::ptrdiff_t replaces =
      -1;  ///< a cause of the hypothesis that it contains (dry friction by a fuller law of it)
  std::size_t of_many = 1;   ///< it is the best of so many of its sort, and must be surer by that
  bool of_one_size = false;  ///< its coefficient is 1, or it is none
  double fitted_gain = 0.0;  ///< where it was fitted, on some windows: of the loss
  std::optional<double>
      damping_nmspr{};  ///< of the joint's drive, from then on: what the fits made of it without the cause is wrong
};

/// What has values that no probe tells, guessed from the recordings.
struct Guesses {
  std::vector<std::vector<double>> ripple_cycles;  ///< a turn: of each joint, some or none
  std::vector<std::vector<double>> limits_nm;      ///< of each joint's drive: some or none
  std::vector<Candidate> springs;                  ///< between drives and joints
};

/// All that the hypothesis does not have yet.
std::vector<Candidate> candidates(const Problem& problem, const Hypothesis& h, const Guesses& guesses);

/// Springs between a joint and its drive, from soft ones to such as ring faster than the fits may step: so many that one of them
/// rings about as the true one does. Where the damping is free, with the model's own too: a fit takes the ringing for damping. None
/// where the joint stands still, or the drive has no rotor's inertia, or a spring already.
std::vector<Candidate> springs(const Problem& problem, const Hypothesis& h, std::size_t joint);

/// Torque ripple of each drive with each whole number of cycles a turn that its joint's travel can show.
std::vector<Candidate> ripples(const Problem& problem, const Hypothesis& h);

/// The hypothesis with a column of a candidate.
Hypothesis with_column(const Hypothesis& h, const Candidate& c, std::size_t column);

/// The hypothesis with the candidate at the size that the coefficients of its columns say.
Hypothesis with_candidate(const TreeModel& model, const Hypothesis& h, const Candidate& c,
                          std::span<const double> coefficients);

Hypothesis without(const Hypothesis& h, std::size_t cause);

}  // namespace furcula::trees
