#include "host/diagnose/other_words.hpp"

#include <algorithm>
#include <utility>

#include "host/diagnose/simplify.hpp"
#include "host/linear/linear.hpp"

namespace furcula::diagnose {

using dynamics::Effect;

void put_friction_that_pushes_otherwise(SearchState& s) {
  if (!holds(s.chosen.effects, Effect::asymmetric_friction)) return;
  const auto& [up, down, none] = s.chosen.fitted.effects.at(Effect::asymmetric_friction);
  if (std::min(up, down) >= 0.0) return;
  EffectSet words = without(s.chosen.effects, Effect::asymmetric_friction);
  if (!holds(words, Effect::stribeck_friction)) words = with(words, Effect::coulomb_friction);
  if (!holds(words, Effect::force_offset)) words = with(words, Effect::force_offset);
  Hypothesis other = s.trainer.fit_if_it_runs(
      words, s.chosen,
      {{Effect::coulomb_friction, {0.5 * (up + down)}}, {Effect::force_offset, {0.5 * (down - up)}}});
  if (other.failed || !other.meaningful) return;
  s.chosen = std::move(other);
  s.acted.insert(Rule::friction_that_pushes);
  prune(s);  // of a constant force alone, too, both sizes are found
}

void add_friction_of_two_sizes(SearchState& s) {
  const EffectSet& members = s.chosen.effects;
  if (!holds(members, Effect::coulomb_friction) || !holds(members, Effect::force_offset)) return;
  Hypothesis one = s.chosen;
  one.effects = with(without(without(members, Effect::coulomb_friction), Effect::force_offset),
                     Effect::asymmetric_friction);
  one.unknowns = unknowns_of(s.model(), one.effects);
  const auto n = static_cast<Eigen::Index>(one.unknowns.size());
  Eigen::MatrixXd words = Eigen::MatrixXd::Zero(n, n);  // the new values from the old ones
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < n; ++k) {
      const identify::Unknown& now = one.unknowns[static_cast<std::size_t>(i)];
      const identify::Unknown& old = s.chosen.unknowns[static_cast<std::size_t>(k)];
      if (!now.of_effect || now.effect != Effect::asymmetric_friction)
        words(i, k) = now.name == old.name ? 1.0 : 0.0;
      else if (old.of_effect && old.effect == Effect::coulomb_friction)
        words(i, k) = 1.0;
      else if (old.of_effect && old.effect == Effect::force_offset)
        words(i, k) = now.parameter == 0 ? -1.0 : 1.0;
    }
  Eigen::Map<Eigen::VectorXd>(one.fit.values.data(), n) =
      words * Eigen::Map<const Eigen::VectorXd>(s.chosen.fit.values.data(), n);
  one.fit.covariance = words * s.chosen.fit.covariance * words.transpose();
  const Eigen::MatrixXd back = linear::inverse(words);
  for (identify::WindowShare& share : one.fit.shares) {
    share.information = back.transpose() * share.information * back;
    share.gradient = back.transpose() * share.gradient;
  }
  one.fit.at_bound.assign(one.unknowns.size(), false);
  one.fit.ranges.clear();
  one.fitted.effects.erase(Effect::coulomb_friction);
  one.fitted.effects.erase(Effect::force_offset);
  one.fitted = identify::with_values(one.fitted, one.unknowns, one.fit.values);
  for (Effect e : {Effect::coulomb_friction, Effect::force_offset}) s.equals.push_back({e, one});
}

void add_drive_behind_early_rows(SearchState& s) {
  constexpr double kAWholeRow = 0.9, kMostOfIt = 0.5;
  const EffectSet& members = s.chosen.effects;
  if (!holds(members, Effect::time_skew) || holds(members, Effect::actuator_delay) ||
      holds(members, Effect::actuator_lag) || dynamics::has(s.model().kind, dynamics::LocationType::leg) ||
      judged_on(Effect::actuator_lag, s.trainer.recordings) != identify::Channel::motion)
    return;
  const double row_s = s.trainer.row_s(), early_s = -s.chosen.fitted.effects.at(Effect::time_skew)[0];
  if (early_s <= 0.0 || early_s > kAWholeRow * row_s) return;
  Hypothesis whole_row = s.chosen;
  whole_row.fitted.effects.at(Effect::time_skew)[0] = -row_s;
  const Hypothesis lagging = s.trainer.fit_if_it_runs(with(members, Effect::actuator_lag), whole_row,
                                                      {{Effect::actuator_lag, {row_s - early_s}}});
  if (!lagging.failed && lagging.meaningful &&
      lagging.fitted.effects.at(Effect::actuator_lag)[0] > kMostOfIt * (row_s - early_s)) {
    s.acted.insert(Rule::early_rows);
    s.equals.push_back({Effect::time_skew, lagging});
  }
}

}  // namespace furcula::diagnose
