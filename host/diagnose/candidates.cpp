#include "host/diagnose/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/diagnose/estimates.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/wording.hpp"

namespace furcula::diagnose {

std::string why_not(const Tried& t, const Selection& s) {
  const auto& h = t.hypothesis;
  for (std::size_t i = 0; i < h.unknowns.size(); ++i)
    if (h.unknowns[i].of_effect && h.fit.at_bound[i])
      return "its best value is none at all, or a physical limit";
  if (!h.meaningful) return "its size scatters from window to window as much as it is away from none";
  if (!t.against_smaller.significant)
    return t.against_smaller.evidence > t.against_smaller.threshold
               ? "removes less than differences of numerics could"
               : "removes no more than chance would";
  const double ratio = std::sqrt(h.fit.squares / std::max(s.chosen.fit.squares, 1e-300));
  if (t.round == 0 && ratio > 1.05 && !s.chosen.effects.empty())
    return "leaves " + number(ratio) + " times the error of " + names(s.chosen.effects) +
           " on the training recordings";
  if (h.effects.size() >= s.chosen.effects.size() && ratio <= 1.05)
    return "explains the training recordings no better than " + names(s.chosen.effects);
  return "needless beside " + names(s.chosen.effects);
}

std::vector<Candidate> candidates_of(const model::Model& model, const Selection& selection, bool withdrawn,
                                     const HeldOut& held_out) {
  // Of long recordings on a sample of the windows alone: there are dozens of rows.
  const double before = held_out.sample_nmse(selection.refitted.fitted),
               floor = held_out.sample_noise_floor(selection.chosen.fitted);
  std::vector<Candidate> all;
  const auto row = [&](const Hypothesis& h, bool chosen, std::string outcome) {
    Candidate c;
    c.effects = names_of(h.effects);
    c.parameters = parameters_of_effects(h);
    c.training_gain =
        1.0 - h.cross_validated_squares / std::max(selection.refitted.cross_validated_squares, 1e-300);
    c.held_out_gain = explained_share(before, held_out.sample_nmse(h.fitted), floor);
    c.chosen = chosen;
    c.outcome = std::move(outcome);
    all.push_back(std::move(c));
  };
  const auto is_new = [&](const Hypothesis& h) {
    return std::none_of(all.begin(), all.end(),
                        [&](const Candidate& c) { return c.effects == names_of(h.effects); });
  };
  if (!selection.chosen.effects.empty())
    row(selection.chosen, !withdrawn, withdrawn ? "fits what is within the measuring noise" : "named");
  for (const auto& rival : selection.equals)
    if (is_new(rival.hypothesis))
      row(rival.hypothesis, false,
          always_same(model, rival.hypothesis.effects, selection.chosen.effects)
              ? "the same law under another name"
              : "explains the recordings equally well");
  for (const Tried& t : selection.tried)
    if (is_new(t.hypothesis)) row(t.hypothesis, false, why_not(t, selection));
  return all;
}

}  // namespace furcula::diagnose
