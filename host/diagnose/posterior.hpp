// How sure a name is: the share of all sets that were fitted which hold it, each weighed by what the training
// recordings and prior expectations say of it, and what limits that (docs/decisions/0023-three-parts.md).
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "host/diagnose/diagnosis.hpp"
#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/hypothesis.hpp"
#include "host/identify/recording.hpp"

namespace furcula::diagnose {

/// The constants of a confidence, in one place.
struct ConfidenceRules {
  /// Somebody else's machine may always have what nobody thought of.
  double most = 0.99;
  /// Evidence is worth less where the best set leaves what a flexible law predicts; where next to nothing but
  /// that is left, so much less. Below a tenth of it the flexible law's own errors count.
  double largest_misfit = 10.0;
  /// None of the catalogue, again: odds by the share of the motion (RMS over its own, noise apart) that held-out runs are off by with all
  /// that is named. A tenth makes them even: names beside such an error stand for something else as often as not.
  double even_at_share_of_motion = 0.1;
  /// A drive's limit that clips more of the samples than this is no limit but another scale of the input.
  double most_clipped = 0.9, clips_nearly_all = 0.3;
  /// Below this share of all sets, or with more than the rest of it unexplained, it is said why.
  double clear = 0.9;
  /// Fewer stretches to predict than three say nothing of how an estimate scatters.
  double few_windows = 0.5;
  /// Its interval holds the value at which there is nothing: as likely there as not.
  double may_be_none = 0.5;
  /// Another law explains the training recordings as well.
  double undecided = 0.5;
  /// A value at a physical limit, or an interval as wide as its bounds: the recordings say nothing of it.
  double not_held = 0.3;
  /// The held-out recordings are predicted worse with it than without it: rather not.
  double contradicted = 0.4;
  /// Without it they are predicted less than a tenth worse, of what there is to explain: it may be luck.
  double not_confirmed = 0.5;
  double least_confirmation = 0.1;
  /// Or by less than this of all squares, whatever there is to explain: as little as a flexible law may take off
  /// what is adequate (predictable.hpp).
  double least_gain = 0.02;
  /// The law was seen in so small a part that others look alike.
  double little_seen = 0.5;
  /// What swings is told from a bend or a slope by two whole swings.
  double fewest_swings = 2.0;
  /// A motor's warming is told from a constant gain where the times at which it is driven are half its time
  /// constant apart: it has then gone through a third of the change.
  double least_warming = 0.5;
  /// Rows below the Stribeck velocity, and windows that hold some: once is chance.
  double fewest_slow_rows = 20.0, fewest_slow_windows = 3.0;
};
inline constexpr ConfidenceRules kConfidence{};

/// The most that a name may be believed where held-out runs are off by so much: their NMSE and that of noise alone.
inline double most_beside(double nmse, double noise_nmse) {
  const double left = nmse > noise_nmse ? nmse - noise_nmse : 0.0;
  return 1.0 / (1.0 + left / (kConfidence.even_at_share_of_motion * kConfidence.even_at_share_of_motion));
}

/// How the sets share what is to be believed, if one of them is right. Names of one law count once.
class Posterior {
 public:
  Posterior(const model::Model& model, const std::vector<Weighed>& sets, double misfit);

  /// The share of sets that hold the effect, or its law under other names.
  double share_with(dynamics::Effect e) const;
  /// The share of this set alone, under all its names; 0 of one that is not among them.
  double weight_of(const EffectSet& effects) const;

 private:
  struct Law {
    std::set<dynamics::Effect> laws;
    double weight;
  };
  const model::Model& model_;
  std::vector<Law> laws_;
};

/// What the evidence is divided by where even the best set leaves what a flexible law predicts.
double misfit_of(const std::optional<Remainder>& left);

/// Of what there is to explain between an error before and after, that which nothing named explains. `left`:
/// what a flexible law predicts of the rest; `nothing_left`: only what comes at random.
double unnamed_share(double before, double after, double floor, const Predictable* predictable,
                     bool nothing_left);

/// What the recordings would have to show of a law and do not, in words; nothing where they do.
std::optional<std::string> too_little_seen(dynamics::Effect e, const model::Model& fitted,
                                           const std::vector<identify::Recording>& recordings,
                                           const std::vector<identify::Window>& windows);

}  // namespace furcula::diagnose
