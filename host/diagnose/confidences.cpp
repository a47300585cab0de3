#include "host/diagnose/confidences.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/estimates.hpp"
#include "host/diagnose/findings.hpp"
#include "host/diagnose/posterior.hpp"
#include "host/diagnose/repeatability.hpp"
#include "host/diagnose/verdict.hpp"
#include "host/diagnose/wording.hpp"
#include "host/result/confidence.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;
using identify::Recording;

/// Whether a drive's limit clips more of the samples in which it is driven than a limit does.
bool clips_nearly_all(const Finding& f, const std::vector<Recording>& training) {
  if (f.effect != Effect::torque_saturation || f.parameters.empty()) return false;
  const double limit = f.parameters.begin()->second.value;
  std::size_t driven = 0, clipped = 0;
  for (const Recording& r : training)
    for (const double u : r.drive_commands().command) {
      driven += u != 0.0;
      clipped += std::abs(u) > limit;
    }
  return static_cast<double>(clipped) > kConfidence.most_clipped * static_cast<double>(driven);
}

EffectSet effects_named(const std::vector<std::string>& names) {
  EffectSet all;
  for (const std::string& n : names) all.push_back(*dynamics::effect_named(n));
  return all;
}

}  // namespace

void fill_confidences(Diagnosis& d, const model::Model& model, const DataSet& data, const Crossed& crossed,
                      const Selection& selection, const Support& support, const HeldOut& held_out,
                      bool slips_predictable, bool slip_alone) {
  if (d.findings.empty()) return;
  const Hypothesis& chosen = selection.chosen;
  const std::vector<Recording>& training = data.training();
  const bool others_alone = other_channels_alone(d.findings);
  const std::optional<Remainder> left =
      d.remainder ? d.remainder : remainder_of(chosen.fitted, training, crossed.windows());
  const Posterior posterior(model, selection.pool, misfit_of(left));
  double unnamed = 0.0;
  if (!others_alone) {
    const bool structured = left && left->is_structured_in_training();
    unnamed =
        unnamed_share(support.before, support.after, support.floor, structured ? &left->crossed : nullptr,
                      random_alone_in_training(chosen.fitted, training, crossed.windows(), left));
  }
  const double none = result::share_of_none(std::max(unnamed, d.unnamed_share));
  d.none_of_catalogue = none;
  const double off = held_out.nmse(d.extended), beside = most_beside(off, held_out.nmse(d.noise_floor));
  const bool all_contradicted = !others_alone && !helps_held_out(d, held_out, slip_alone);
  for (Finding& f : d.findings) {
    const double share = posterior.share_with(f.effect);
    f.confidence = std::min(kConfidence.most, share * (1.0 - none));
    if (share < kConfidence.clear)
      f.lowered_by.push_back("sets of causes without it explain the training recordings nearly as well");
    if (none > 1.0 - kConfidence.clear)
      f.lowered_by.push_back("the names leave a part of what there is to explain");
    const auto limit = [&](bool applies, double most, std::string why) {
      if (!applies) return;
      f.confidence = std::min(f.confidence, most);
      f.lowered_by.push_back(std::move(why));
    };
    const bool told = f.effect != Effect::encoder_slip || slips_predictable;
    limit(f.undecided, kConfidence.undecided, "another cause explains the training recordings as well");
    limit(may_be_none(chosen, model, f.effect), kConfidence.may_be_none,
          "the interval of its size holds the value at which there is nothing");
    limit(data.has_few_windows(), kConfidence.few_windows,
          "the training recordings hold no more than " +
              number(static_cast<double>(data.independent_windows())) + " stretches to predict");
    limit(not_held(chosen, model.kind, f.effect), kConfidence.not_held,
          "one of its values may be anything within its bounds");
    const bool contradicted = told && f.contradicted;
    limit(contradicted, kConfidence.contradicted,
          "the held-out recordings are predicted worse with it than without it");
    limit(all_contradicted && f.channel.empty() && (told || slip_alone) && !contradicted,
          kConfidence.contradicted,
          "the held-out recordings are predicted worse with all that is named than without");
    limit(told && !contradicted &&
              (f.explainable_nmse_removed < kConfidence.least_confirmation ||
               f.squares_removed < kConfidence.least_gain),
          kConfidence.not_confirmed, "the held-out recordings hardly show it");
    if (f.channel.empty() && told)
      limit(beside < kConfidence.clear, beside,
            "held-out runs are off by " + number(100.0 * std::sqrt(off)) +
                " % of the motion with all that is named");
    limit(clips_nearly_all(f, training), kConfidence.clips_nearly_all,
          "the limit clips nearly every sample: it stands for another scale of the input");
    if (const auto little = too_little_seen(f.effect, chosen.fitted, training, crossed.windows()))
      limit(true, kConfidence.little_seen, *little);
  }
  for (Candidate& c : d.candidates) c.weight = posterior.weight_of(effects_named(c.effects));
}

}  // namespace furcula::diagnose
