// Which of two fits explains the recordings better, and how surely.
#pragma once

#include "host/trees/fit.hpp"

namespace furcula::trees {

/// What a parameter more must be worth, of the loss.
inline constexpr double kOfParameter = 0.01;
/// One that is behind another by less than so many times the scatter stands for it.
inline constexpr double kStands = 2.0;

/// By how much `fit` is better than `other`, in the scatter of the difference from window to window.
double against(const Fit& fit, const Fit& other);

/// Of `fit` against `other`, natural logarithm: of their likelihoods, of their parameters (Schwarz, Annals of Statistics 6(2), 1978, the
/// windows being what is independent), and of what is known beforehand. A window has Student's distribution, with as many degrees of
/// freedom as residuals. Where the difference of two fits scatters from window to window by more than that of Gaussian residuals, twice
/// the square of its distance from 0 is less than the likelihoods' logarithm, and right.
double log_odds(const Problem& problem, const Fit& fit, const Fit& other);

/// Whether `a` is, weighed as either of them says, each parameter more being worth what it must.
bool better(Problem& problem, const Fit& a, const Fit& b);

}  // namespace furcula::trees
