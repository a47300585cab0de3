// A set of effects on top of the model, fitted: what it leaves, and what that is worth as evidence.
#pragma once

#include <vector>

#include "host/identify/simulation_fit.hpp"

namespace furcula::diagnose {

/// The model with a set of effects, all unknowns fitted.
struct Hypothesis {
  std::vector<dynamics::Effect> effects;  ///< in the order of the catalogue
  std::vector<identify::Unknown> unknowns;
  identify::Fit fit;
  model::Model fitted;  ///< the model at the fit's values
  double cross_validated_squares = 0.0;
  bool failed = false;  ///< no start from which the model's run stays finite: nothing else is set
  bool meaningful =
      true;  ///< no effect at a limit, and each away from nothing by more than the windows scatter
};

/// A set that was fitted, weighed against the chosen one; both in units of twice a log-likelihood ratio.
struct Weighed {
  std::vector<dynamics::Effect> effects;
  double evidence = 0.0;  ///< over the chosen set
  double prior = 0.0;     ///< over the chosen set's
};

/// Which of two hypotheses the training data prefer. All in units of a log-likelihood ratio times two, with
/// the number of independent samples that the residuals are worth.
struct Comparison {
  double evidence = 0.0;    ///< of the larger over the smaller
  double threshold = 0.0;   ///< what chance would reach, the number of hypotheses tried taken into account
  double gain = 0.0;        ///< share of the smaller one's cross-validated error that the larger removes
  bool told_apart = false;  ///< beyond chance, and beyond what two honest simulators differ by
  /// Beyond what two honest simulators differ by, and worth a name beside what the model without any effect leaves.
  bool counts = false;
  bool significant = false;  ///< it counts, and is beyond chance
};

/// One channel of all windows.
identify::ChannelShare channel(const identify::Fit& fit, identify::Channel which);

/// Whether the body's motion is followed but for the measuring noise.
bool follows_the_body(const Hypothesis& h);

/// Cross-validated squares of the motion alone: what the model lacks in another channel (a backlash at the leg's encoder, the drive's
/// current sensor) would hide beside it what moves the body.
double squares_of_body(const Hypothesis& h);

/// Whether `one` leaves more than `other` by this share, in a channel at least; the motion cross-validated.
bool leaves_more(const Hypothesis& one, const Hypothesis& other, double share);

/// Twice the log-likelihood ratio of `larger` over `smaller`, with as many independent samples as the
/// residuals of `of` are worth; each channel with a noise level of its own. `layers`: in how many windows
/// each row lies. `motion`: whether the body's motion is among the channels.
double evidence_of(const identify::Fit& smaller, const identify::Fit& larger, const identify::Fit& of,
                   std::size_t layers, bool motion = true);

/// Which windows an estimate is made without: the training recordings (or, of few, stretches of them) in
/// folds, and by how much the unknowns move without each fold, by one Gauss-Newton step.
struct Crossing {
  std::vector<std::size_t> fold;      ///< of each window
  std::vector<Eigen::VectorXd> step;  ///< of each fold
};
Crossing crossing_of(const identify::Fit& fit, const std::vector<identify::Window>& windows,
                     std::size_t recordings);

/// The squares of a window after such a step.
double squares_after(const identify::WindowShare& share, const Eigen::VectorXd& step);

/// Squares on windows that the estimate has not seen: the training recordings (or, of a single one, its
/// stretches) in folds, each predicted with the estimate that one Gauss-Newton step makes without the fold.
double cross_validate(const identify::Fit& fit, const std::vector<identify::Window>& windows,
                      std::size_t recordings);

/// By how much `larger` is better than `smaller` in each window, of which the estimates have not seen the fold: squares.
std::vector<double> gains_unseen(const identify::Fit& smaller, const identify::Fit& larger,
                                 const std::vector<identify::Window>& windows, std::size_t recordings);

/// How much more the windows' pulls at the unknowns scatter from unit to unit (recording or block of windows)
/// than as many independent residuals' would as the evidence counts: 1 or more. What a model does not have
/// pulls elsewhere in each recording, and its evidence is worth so much less.
double overdispersion(const identify::Fit& fit, const std::vector<std::vector<std::size_t>>& units);

/// What a chi-square of `freedom` degrees (one at least) exceeds at the level that Bonferroni's price for
/// `tries` leaves of a false alarm in two hundred.
double chi_square_point(double tries, double freedom);

/// False if an effect's parameters mean nothing: where the effect is not there, against a physical limit, a
/// friction that gives energy, or a drive and a clock that undo each other.
bool within_limits(const Hypothesis& h);

/// Of a law that can take many shapes: whether its size is away from where the effect is not there, by the
/// scatter between windows: a law that fits what differs from window to window is no cause. (Wald's test of
/// the parameters that have such a value; of an effect without one, of its first parameter against zero.)
bool stands_out(const Hypothesis& h, const model::Model& model, dynamics::Effect e, double tries);

/// Whether the intervals of its sizes all hold the value at which there is nothing, or which the model has; of several sizes also their
/// common one.
bool may_be_none(const Hypothesis& h, const model::Model& model, dynamics::Effect e);

/// Whether a friction of two sizes is not one of one size: the sizes are four standard deviations apart, by the scatter between windows,
/// and a Stribeck velocity is two away from none. True of other laws.
bool told_from_special_case(const Hypothesis& h, dynamics::Effect e);

}  // namespace furcula::diagnose
