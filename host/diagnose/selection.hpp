// Which effects the data ask for: nested extensions of the model, each fitted with the model's free
// parameters moving, compared on the training recordings alone.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string_view>
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

/// Which of two hypotheses the training data prefer. All in units of a log-likelihood ratio times two, with
/// the number of independent samples that the residuals are worth.
struct Comparison {
  double evidence = 0.0;   ///< of the larger over the smaller
  double threshold = 0.0;  ///< what chance would reach, the number of hypotheses tried taken into account
  double gain = 0.0;       ///< share of the smaller one's cross-validated error that the larger removes
  bool significant = false;
};

/// One row of the diagnosis' table.
struct Tried {
  Hypothesis hypothesis;
  std::size_t round = 0;  ///< 0: alone on top of the re-fitted model
  Comparison against_smaller;
};

struct Selection {
  Hypothesis refitted;  ///< no effect added
  /// The same with wider bounds, where the bounds of free parameters hold it back and that explains the
  /// training recordings as well as `chosen`, or better.
  std::optional<Hypothesis> beyond_bounds;
  Hypothesis chosen;
  std::vector<Tried> tried;
  /// Sets that explain the training data as well as `chosen` with as many parameters, by the member that they
  /// replace.
  struct Rival {
    dynamics::Effect of;
    Hypothesis hypothesis;
  };
  std::vector<Rival> equals;
  /// For each chosen effect, the chosen set without it, re-fitted; in the order of chosen.effects.
  std::vector<Hypothesis> without;
  std::vector<Comparison> against_without;
};

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

class Proposer;
struct Proposal;

struct Trainer {
  const model::Model& model;
  const std::vector<identify::Recording>& recordings;
  const identify::TrainingWindows& training;
  unsigned threads = 1;
  std::function<void(double, std::string_view)> progress;

  /// The effects of the catalogue that could extend the model: they exist on its kind and do not
  /// repeat a parameter that is free anyway. One that is on may have the wrong size.
  std::vector<dynamics::Effect> candidates() const;

  /// Fits the model with these effects from the values of `from` (a hypothesis with some of them) and, for
  /// those that it has not, from `starts`.
  Hypothesis fit(const std::vector<dynamics::Effect>& effects, const Hypothesis* from,
                 const Starts& starts = {}) const;

  /// `larger` has parameters that `smaller` has not; `tries` hypotheses were looked at.
  Comparison compare(const Hypothesis& smaller, const Hypothesis& larger, std::size_t tries) const;

  /// Fits a set with one effect more than `on`, from what was proposed for it and, where a fit may stick,
  /// from other starts.
  Hypothesis fit_new(const std::vector<dynamics::Effect>& larger, const Hypothesis& on,
                     const Proposal& proposal) const;

  /// What moves the axis (root mean square of the input, on the hopper the weight; N or N m) and the root
  /// mean square of its speed.
  struct Scales {
    double force = 1.0, speed = 1.0;
  };
  Scales scales() const;

  /// Forward selection with backward elimination, then the search for equals.
  Selection select();

  double reference_squares =
      0.0;  ///< of the body's motion, of the re-fitted model without an effect; set by select()

 private:
  /// By how much `other` is preferred to `one`, in the units of the evidence: what the recordings say, and
  /// what was to be expected before.
  double preference(const Hypothesis& one, const Hypothesis& other) const;
  /// The re-fitted model with wider bounds for those that it lies on; nothing where it lies on none, or where
  /// it gains nothing by it. Zero, where a parameter ends physically, is not widened.
  std::optional<Hypothesis> widened(const Hypothesis& refitted) const;
  /// False where an effect is smaller than what its channel resolves.
  bool beyond_resolution(const Hypothesis& h) const;
  /// How many of the proposals are fitted; puts them first.
  std::size_t worth_a_fit(std::vector<Proposal>& proposals, std::size_t most) const;
  /// Where one effect does not explain the recordings: pairs that begin with other effects than the best one.
  void beam(Selection& s, const std::vector<dynamics::Effect>& all, const Proposer& proposer) const;
  /// Backward: takes out members that the others have made needless.
  void prune(Hypothesis& chosen, std::size_t tries) const;
  /// What each effect on top of `on` promises, the most promising first.
  std::vector<Proposal> propose(const Proposer& proposer, const Hypothesis& on,
                                const std::vector<dynamics::Effect>& effects, double progress_from,
                                double progress_share) const;
  /// Sets with as many parameters that explain as much as the chosen one, with another effect (or two) in the
  /// place of each member.
  std::vector<Selection::Rival> rivals(const Selection& s, const std::vector<dynamics::Effect>& all,
                                       const Proposer& proposer) const;
};

}  // namespace furcula::diagnose
