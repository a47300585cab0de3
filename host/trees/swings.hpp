// What swings with a frequency of its own: springs between drive and joint, and the ripple of a drive's torque. A probe of another stiffness or
// number of cycles swings otherwise than the true one, and says nothing about it: all are tried, on some of the windows.
#pragma once

#include <cstddef>
#include <vector>

#include "host/trees/candidates.hpp"

namespace furcula::trees {

/// What must be lost without a spring between drive and joint, of the loss, or surely of a joint's share of it.
inline constexpr double kRings = 0.3;

/// Of each joint the spring before it that does best: of those that would, some are fitted, where they would do about as much as at the
/// joint where they do most.
std::vector<Candidate> likely_springs(const Problem& problem, const Fit& fit);

/// Of each joint the ripples of its drive that would do best, by their number of cycles.
std::vector<Candidate> likely_ripples(const Problem& problem, const Fit& fit);

std::size_t springs_in(const Hypothesis& h);

/// A fit of `h`, which has more than `fit`. Where it has a spring more, nobody knows how its rotor starts: that is eliminated in both, and the
/// loss is as much of that of `fit` as it is there.
Fit fit_beside(const Problem& problem, const Hypothesis& h, const Fit& fit, int iterations);

}  // namespace furcula::trees
