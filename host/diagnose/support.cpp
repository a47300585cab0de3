#include "host/diagnose/support.hpp"

#include <algorithm>

#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/estimates.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/repeatability.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;

/// Standard errors by which causes must help on training recordings that their fit has not seen. They are beyond
/// chance by all recordings together already; two would withdraw the friction of a real pendulum of which there is
/// one recording. Help in one recording alone is 1.0, whatever its size.
constexpr double kSureHelp = 1.2;
/// Of a belt, of which fits without each of few recordings predict falls that end on one tooth or another: beyond nine of ten draws of chance
/// in five recordings (Student's t).
constexpr double kSureHelpOfFalls = 1.6;
/// Standard errors of help from which causes stand though others would do as well: that one of them is there is plain.
constexpr double kPlainHelp = 3.0;

/// Whether the re-fitted model leaves noise alone.
bool refitted_stands(const DataSet& data, const Crossed& crossed, const Hypothesis& refitted,
                     const Support& support) {
  const auto left = remainder_of(refitted.fitted, data.training(), crossed.windows());
  const identify::ChannelShare motion = channel(refitted.fit, identify::Channel::motion);
  // The floor of predictions is mostly the start states' noise: where more is known, it does not decide.
  return motion.squares <= kWithinNoise * motion.rows ||
         (!left && support.before <= kWithinNoise * (support.floor + kNumerics)) ||
         random_alone_in_training(refitted.fitted, data.training(), crossed.windows(), left);
}

}  // namespace

/// No simulator's numerics jump from one row to the next, and a slip in one recording says nothing of another.
Support support_of(const model::Model& model, const DataSet& data, const Crossed& crossed,
                   const Selection& selection, const WithoutRules& without, unsigned threads) {
  Support s;
  const Hypothesis &chosen = selection.chosen, &refitted = selection.refitted;
  s.withdrawn = selection.beyond_bounds.has_value();
  if (s.withdrawn || chosen.effects.empty()) return s;
  for (const auto& rival : selection.equals)
    s.undecided = s.undecided || !always_same(model, rival.hypothesis.effects, chosen.effects);
  double gain = 0.0;
  const bool jumps = ends_on_teeth(model.kind) && data.training().size() > 1;
  if (jumps) {
    const Crossed::Predictable again = crossed.fitted_again(model, refitted, chosen, threads);
    s.before = again.smaller, s.after = again.larger, gain = again.gain;
  } else {
    s.before = crossed.nmse(refitted, refitted);
    s.after = crossed.nmse(chosen, refitted);
    gain = crossed.gain_in_standard_errors(refitted, chosen);
  }
  s.floor = crossed.noise_floor(refitted);
  const bool other_channels = std::all_of(chosen.effects.begin(), chosen.effects.end(), [&](Effect e) {
    return judged_on(e, data.training()) != identify::Channel::motion;
  });
  if (other_channels) return s;
  const bool slipped = holds(chosen.effects, Effect::encoder_slip);
  const bool numerics = s.before <= kNumerics && !slipped;
  const bool helps = slipped || (jumps ? gain > kSureHelpOfFalls : s.after < s.before && gain > kSureHelp);
  const bool doubtful = (s.undecided && gain < kPlainHelp) || !helps ||
                        std::any_of(chosen.effects.begin(), chosen.effects.end(), [&](Effect e) {
                          return may_be_none(chosen, model, e) || not_held(chosen, model.kind, e);
                        });
  s.by_rule = !numerics && doubtful && !without.contains(Rule::withdrawal) &&
              refitted_stands(data, crossed, refitted, s);
  s.withdrawn = numerics || s.by_rule;
  if (s.withdrawn) s.undecided = false;
  return s;
}

std::vector<Diagnosis::BeyondBounds> beyond_bounds(const model::Model& model, const Selection& selection) {
  std::vector<Diagnosis::BeyondBounds> all;
  if (!selection.beyond_bounds) return all;
  const Hypothesis& h = *selection.beyond_bounds;
  for (std::size_t i = 0; i < h.unknowns.size(); ++i) {
    const auto& u = h.unknowns[i];
    const auto& bounds = model.free.at(u.parameter);
    if (h.fit.values[i] < bounds.lower || h.fit.values[i] > bounds.upper)
      all.push_back({u.name, u.unit, bounds.lower, bounds.upper, h.fit.values[i]});
  }
  return all;
}

}  // namespace furcula::diagnose
