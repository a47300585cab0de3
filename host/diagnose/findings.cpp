#include "host/diagnose/findings.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "host/diagnose/bootstrap.hpp"
#include "host/diagnose/candidates.hpp"
#include "host/diagnose/effect_set.hpp"
#include "host/diagnose/estimates.hpp"
#include "host/diagnose/laws.hpp"
#include "host/diagnose/slips.hpp"

namespace furcula::diagnose {
namespace {

using dynamics::Effect;
using identify::ErrorSums;

/// Intervals of what a finding gains, over the held-out recordings, by the sums of their windows without it and with it.
template <class Share>
void fill_intervals(Finding& f, const std::vector<identify::Window>& windows,
                    const std::vector<ErrorSums>& without, const std::vector<ErrorSums>& with,
                    const Share& share) {
  const Units units = units_of(windows);
  std::vector<ErrorSums> before(units.size()), after(units.size());
  for (std::size_t u = 0; u < units.size(); ++u)
    for (const std::size_t i : units[u]) before[u] += without[i], after[u] += with[i];
  const auto drawn = [](const std::vector<ErrorSums>& sums, const std::vector<double>& times) {
    ErrorSums all;
    for (std::size_t u = 0; u < sums.size(); ++u)
      all += {times[u] * sums[u].squares, times[u] * sums[u].absolute, times[u] * sums[u].spread,
              times[u] * sums[u].count};
    return all.errors();
  };
  f.removed_interval = bootstrap(units.size(), [&](const std::vector<double>& times) {
    return share(drawn(before, times), drawn(after, times));
  });
  f.mae_gain_interval = bootstrap(units.size(), [&](const std::vector<double>& times) {
    return drawn(before, times).mae - drawn(after, times).mae;
  });
}

/// What the effect removes of the held-out errors, on the channel that it is judged on. `without`, `with`: the chosen set without it and
/// with it; `errors_without`, `errors_with`: theirs.
void fill_gains(Finding& f, const DataSet& data, const HeldOut& held_out, const model::Model& without,
                const model::Model& with, const Errors& errors_without, const Errors& errors_with,
                double floor) {
  identify::Channel judge = judged_on(f.effect, data.training());
  std::string name = channel_name(judge);
  if (!errors_without.contains(name) || !errors_with.contains(name)) {
    judge = identify::Channel::motion;
    name.clear();
  }
  f.channel = name;
  // The NMSE of the position; of other channels the mean square, and what they resolve as the floor.
  const bool motion = name.empty();
  if (motion) name = identify::channel_names(with.kind).position;
  const double resolution = motion ? 0.0 : held_out.resolution(judge);
  const double nothing_left = motion ? floor : resolution * resolution;
  const auto error = [&](const ChannelErrors& e) { return motion ? e.nmse : e.rmse * e.rmse; };
  const ChannelErrors &before = errors_without.at(name), &after = errors_with.at(name);
  f.explainable_nmse_removed = explained_share(error(before), error(after), nothing_left);
  f.squares_removed = 1.0 - error(after) / std::max(error(before), 1e-300);
  f.held_out_mae_before = before.mae;
  f.held_out_mae_after = after.mae;
  f.helps = motion ? after.nmse < before.nmse : after.rmse < before.rmse;
  f.contradicted = motion ? before.nmse < after.nmse : before.rmse < after.rmse;
  fill_intervals(f, held_out.windows(), held_out.sums(without, judge), held_out.sums(with, judge),
                 [&](const ChannelErrors& b, const ChannelErrors& a) {
                   return explained_share(error(b), error(a), nothing_left);
                 });
}

std::vector<Effect> without_common(const std::vector<Effect>& a, const std::vector<Effect>& b) {
  std::vector<Effect> rest;
  for (Effect e : a)
    if (!holds(b, e)) rest.push_back(e);
  return rest;
}

/// What explains the training recordings as well as the chosen set with this effect, and what does not.
void fill_rivals(Finding& f, const model::Model& model, const Selection& selection) {
  const EffectSet& chosen = selection.chosen.effects;
  for (const auto& rival : selection.equals) {
    if (rival.of != f.effect) continue;
    const bool same = always_same(model, rival.hypothesis.effects, chosen);
    Rival r{names_of(without_common(rival.hypothesis.effects, chosen)),
            same ? "the same law under another name: no recording in motion can tell them apart"
                 : "explains the training recordings equally well",
            parameters_of_effects(rival.hypothesis)};
    r.same_law = same;
    f.undecided = f.undecided || !same;
    f.indistinguishable_from.push_back(std::move(r));
  }
  for (const Tried& t : selection.tried) {
    if (t.round != 0 || !t.against_smaller.significant) continue;
    const Effect other = t.hypothesis.effects.front();
    const std::string name(dynamics::info(other).name);
    const bool equal = std::any_of(f.indistinguishable_from.begin(), f.indistinguishable_from.end(),
                                   [&](const Rival& r) { return r.names == std::vector{name}; });
    if (!equal && !holds(chosen, other)) f.alternatives.push_back({{name}, why_not(t, selection), {}});
  }
}

}  // namespace

std::vector<Finding> findings_of(const model::Model& model, const DataSet& data, const Selection& selection,
                                 const HeldOut& held_out, const Errors& extended, double floor) {
  const Hypothesis& chosen = selection.chosen;
  std::vector<std::pair<double, Finding>> all;
  for (std::size_t i = 0; i < chosen.effects.size(); ++i) {
    const Effect e = chosen.effects[i];
    const model::Model& without = selection.without[i].fitted;
    const Errors errors_without = held_out.errors(without);
    Finding f;
    f.effect = e;
    f.parameters = parameters_of_effect(chosen, model.kind, e);
    fill_gains(f, data, held_out, without, chosen.fitted, errors_without, extended, floor);
    f.explanation = std::string(dynamics::info(e).explanation);
    f.next_experiment = std::string(dynamics::info(e).best_experiment);
    if (e == Effect::encoder_slip) tell_slips(f, model.kind, data.training(), data.held_out());
    fill_rivals(f, model, selection);
    all.emplace_back(held_out.nmse(errors_without) - held_out.nmse(extended), std::move(f));
  }
  std::stable_sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
  std::vector<Finding> findings;
  for (auto& [cost, f] : all) findings.push_back(std::move(f));
  return findings;
}

bool other_channels_alone(const std::vector<Finding>& findings) {
  return std::all_of(findings.begin(), findings.end(), [](const Finding& f) { return !f.channel.empty(); });
}

}  // namespace furcula::diagnose
