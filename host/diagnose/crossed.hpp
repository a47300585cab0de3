// The part of the data on which causes are chosen: training recordings, each predicted by an estimate that has
// not seen it. The held-out recordings judge, and choose nothing (docs/decisions/0023-three-parts.md).
#pragma once

#include "host/diagnose/bootstrap.hpp"
#include "host/diagnose/hypothesis.hpp"
#include "host/identify/prediction.hpp"

namespace furcula::diagnose {

class Crossed {
 public:
  /// `predicted`: the training recordings' prediction windows.
  Crossed(const std::vector<identify::Recording>& recordings, const identify::TrainingWindows& training,
          const std::vector<identify::Window>& predicted);

  /// NMSE of the position, predicted from each window's first 50 ms as held-out recordings are; start states
  /// by runs of `reference`.
  double nmse(const Hypothesis& h, const Hypothesis& reference) const;

  /// What a perfect model would have there.
  double noise_floor(const Hypothesis& h) const;

  /// By how much `larger` is better than `smaller` in free runs with their best starts, on windows that the
  /// estimates have not seen: the mean over recordings (or blocks of few) in standard errors of it.
  double gain_in_standard_errors(const Hypothesis& smaller, const Hypothesis& larger) const;

  /// What both predict of recordings that they have not seen: NMSE as above; and by what factor `larger` leaves less of a window's squares,
  /// its logarithm's mean in standard errors.
  struct Predictable {
    double smaller = 0.0, larger = 0.0, gain = 0.0;
  };
  /// By fits without each recording: of a machine whose runs jump a linear step tells nothing. At least two recordings.
  Predictable fitted_again(const model::Model& model, const Hypothesis& smaller, const Hypothesis& larger,
                           unsigned threads) const;

  const std::vector<identify::Window>& windows() const { return predicted_; }
  const Units& units() const { return units_; }  ///< of the windows that fits are made on

 private:
  const std::vector<identify::Recording>& recordings_;
  const identify::TrainingWindows& training_;
  std::vector<identify::Window> predicted_;
  std::vector<std::size_t> place_;  ///< of each predicted window among those that fits are made on
  Units units_, predicted_units_;
};

}  // namespace furcula::diagnose
