// Fits of the model with sets of effects to the training recordings, and which of two those prefer.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "host/diagnose/hypothesis.hpp"

namespace furcula::diagnose {

/// What a fit of the model with these effects moves.
std::vector<identify::Unknown> unknowns_of(const model::Model& model,
                                           const std::vector<dynamics::Effect>& effects);

/// The channel that an effect is judged on: that of the motion, unless it does not move the body.
identify::Channel judged_on(dynamics::Effect e, const std::vector<identify::Recording>& recordings);

/// The model with the largest of the recordings' slips, where encoder_slip is among the effects.
model::Model with_slips(model::Model model, const std::vector<identify::Recording>& recordings,
                        const std::vector<dynamics::Effect>& effects);

/// Start values of effects' parameters.
using Starts = std::map<dynamics::Effect, std::array<double, dynamics::kMaxEffectParameters>>;

/// Sets that were fitted, by their start values: a search comes by the same fit on several ways.
struct FittedSets {
  std::mutex lock;
  std::map<std::pair<std::vector<dynamics::Effect>, std::vector<double>>, Hypothesis> all;
};

struct Trainer {
  const model::Model& model;
  const std::vector<identify::Recording>& recordings;
  const identify::TrainingWindows& training;
  unsigned threads = 1;
  double reference_squares = 0.0;  ///< of the body's motion, of the re-fitted model without an effect
  std::shared_ptr<FittedSets> fitted = std::make_shared<FittedSets>();
  std::vector<identify::Whitening>
      whitening{};  ///< of each training window; none: squares of free runs count

  /// The effects of the catalogue that could extend the model: they exist on its kind, do not repeat a
  /// parameter that is free anyway, and what comes in lets them show. One that is on may have the wrong size.
  std::vector<dynamics::Effect> candidates() const;

  /// Fits the model with these effects from the values of `from` (a hypothesis with some of them) and, for
  /// those that it has not, from `starts`.
  Hypothesis fit(const std::vector<dynamics::Effect>& effects, const Hypothesis* from,
                 const Starts& starts = {}) const;

  /// The same; marked as failed where the model runs away from there.
  Hypothesis fit_if_it_runs(const std::vector<dynamics::Effect>& effects, const Hypothesis& from,
                            const Starts& starts = {}) const;

  /// The re-fitted model with wider bounds for those that it lies on; nothing where it lies on none, or where
  /// it gains nothing by it. Zero, where a parameter ends physically, is not widened.
  std::optional<Hypothesis> widened(const Hypothesis& refitted) const;

  /// `larger` has parameters that `smaller` has not; `tries` hypotheses were looked at.
  Comparison compare(const Hypothesis& smaller, const Hypothesis& larger, std::size_t tries) const;

  /// By how much `other` is preferred to `one`, in the units of the evidence: what the recordings say, and
  /// what was to be expected before.
  double preference(const Hypothesis& one, const Hypothesis& other) const;

  /// What was to be expected of a set before any recording, in units of the evidence: minus the price of its
  /// parameters and of having looked at so many laws and shapes, and minus the doubts.
  double prior(const std::vector<dynamics::Effect>& effects) const;

  /// What the jumps from one row to the next say for slips of the encoder, in units of the evidence: free runs between them scatter by what
  /// disturbs the machine, and no disturbance moves a body within a row.
  double evidence_of_jumps() const;

  /// Evidence of `h` over `reference`, by the noise levels and correlation of what `reference` leaves.
  double evidence_over(const Hypothesis& reference, const Hypothesis& h) const;

  /// What moves the axis (root mean square of the input, without one of the inertia force; on hopper and
  /// clutch bench the weight; N or N m) and the root mean square of its speed.
  struct Scales {
    double force = 1.0, speed = 1.0;
  };
  Scales scales() const;

  /// Between which positions the training windows move, but for their outermost hundredths.
  struct Travel {
    double low, high;
  };
  Travel travel() const;

  /// The usual time from row to row.
  double row_s() const;

  /// Cycles a revolution below which a ripple hardly comes again within the travel: there it is any torque that
  /// depends on the angle. None on a hopper, where the other laws of the place are in the catalogue.
  double fewest_ripples() const;

 private:
  /// Whether the model has a clutch, and it is released in the recordings.
  bool clutch_works() const;
  /// Whether what comes in lets it show: a change of the command needs a command, a shift of it one that
  /// changes. (A ripple is there without a current as well: cogging.)
  bool shows(dynamics::Effect e) const;
  /// False where an effect is smaller than what its channel resolves.
  bool beyond_resolution(const Hypothesis& h) const;
};

}  // namespace furcula::diagnose
