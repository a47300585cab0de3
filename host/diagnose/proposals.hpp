// What an effect promises before it is fitted: shapes tried from several start values, each judged by one
// linear step of all unknowns on some of the training windows.
#pragma once

#include "host/diagnose/trainer.hpp"

namespace furcula::diagnose {

/// An effect's most promising start values.
struct Proposal {
  dynamics::Effect effect{};
  std::array<double, dynamics::kMaxEffectParameters> values{};
  /// Of a law that can take many shapes: other promising starts, for the fit's landscape has many valleys.
  std::vector<std::array<double, dynamics::kMaxEffectParameters>> others;
  double gain = 0.0;  ///< share of the smaller model's squares that a linear step from there removes
};

class Proposer {
 public:
  explicit Proposer(const Trainer& trainer);

  /// What `on` leaves of the windows that proposals are judged on.
  double squares_left(const Hypothesis& on) const;

  /// The best start of `effect` for the set `larger` (which holds it), the rest starting as in `on`. `left`: squares_left(on).
  Proposal best(const Hypothesis& on, const std::vector<dynamics::Effect>& larger, dynamics::Effect effect,
                double left) const;

 private:
  using Values = std::array<double, dynamics::kMaxEffectParameters>;
  /// Of the training windows.
  struct Some {
    std::vector<identify::Window> windows;
    std::vector<identify::Whitening> whitening{};

    Some(const Trainer& trainer, std::size_t most);
    identify::Fit look(const Trainer& trainer, const model::Model& model,
                       const std::vector<identify::Unknown>& unknowns,
                       const std::vector<double>& values) const;
  };
  struct Screening {
    double squares;  ///< after the step
    Values values;   ///< of the effect after it, within bounds
  };
  std::vector<Values> starts(dynamics::Effect effect) const;
  /// Start values of an effect that swings with the position: its phase and amplitude by two steps for each
  /// frequency. `at(frequency)` gives the parameter.
  std::vector<Values> swings(const Hypothesis& on, const std::vector<dynamics::Effect>& larger,
                             dynamics::Effect effect) const;
  Screening step(const Hypothesis& on, const std::vector<dynamics::Effect>& larger, dynamics::Effect effect,
                 const Values& values, const Some& some, bool shape_held) const;

  const Trainer& t_;
  Some some_, few_;
  double force_ = 1.0, speed_ = 1.0, top_input_ = 1.0, low_ = 0.0, high_ = 1.0;
};

/// Fits a set with one effect more than `on`, from what was proposed for it and, where a fit may stick, from
/// other starts.
Hypothesis fit_new(const Trainer& trainer, const std::vector<dynamics::Effect>& larger, const Hypothesis& on,
                   const Proposal& proposal);

}  // namespace furcula::diagnose
