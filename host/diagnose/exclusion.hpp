// Whether a recording is excluded: a comparison of hypotheses, as between sets of causes (docs/decisions/0040-another-machine.md).
#pragma once

#include "host/diagnose/selection.hpp"

namespace furcula::diagnose {

/// Prior odds that one recording of a set is of another machine, or torn: gross errors are 1 to 10 % of routine data (Hampel, Ronchetti,
/// Rousseeuw and Stahel, Robust Statistics, 1986, section 1.2). The lower end: who records a set of logs looks at it.
inline constexpr double kOddsOfAnother = 0.01;

/// Twice the logarithm of the odds between two hypotheses, by the training recordings:
/// - one is of another machine: `set` holds for the others (`without`: its fit to their windows, in their order). The other machine is
///   described as well as theirs, at the price of its own values;
/// - one machine made all: the likeliest set of causes that was fitted to all of them.
double log_odds_of_another(const Trainer& trainer, const Selection& selection, const Hypothesis& set,
                           std::size_t recording, const identify::Fit& without);

}  // namespace furcula::diagnose
