// See result.hpp.
#include "host/diagnose/result.hpp"

#include <algorithm>

#include "host/diagnose/wording.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

result::Estimate estimate(const std::string& name, const std::string& unit, const Estimate& e) {
  return {name, unit, e.value, e.lower, e.upper};
}

/// Of an effect's parameter on this kind of machine; empty if the effect has no such parameter.
std::string unit_of(const dynamics::EffectInfo& effect, std::string_view parameter, dynamics::Kind kind) {
  for (const dynamics::EffectParameterInfo& p : effect.parameters())
    if (dynamics::name_on(p, kind) == parameter) return std::string(dynamics::unit_on(p, kind));
  return {};
}

result::Cause cause_of(const std::string& name) {
  result::Cause cause;
  (dynamics::effect_named(name) ? cause.effect : cause.model_parameter) = name;
  return cause;
}

/// Parameters are named "effect.parameter". Those of effects that are not in `causes` go to `others`.
void add_parameters(const std::map<std::string, Estimate>& parameters, dynamics::Kind kind,
                    std::vector<result::Cause>& causes, std::vector<result::Cause>& others) {
  for (const auto& [name, e] : parameters) {
    const std::size_t dot = std::min(name.find('.'), name.size());
    const std::string owner = name.substr(0, dot);
    const std::string parameter = dot < name.size() ? name.substr(dot + 1) : name;
    const auto is_owner = [&](const result::Cause& c) {
      return c.effect == owner || c.model_parameter == owner;
    };
    auto* list = &causes;
    auto found = std::find_if(causes.begin(), causes.end(), is_owner);
    if (found == causes.end()) {
      list = &others;
      found = std::find_if(others.begin(), others.end(), is_owner);
    }
    if (found == list->end()) found = others.insert(others.end(), cause_of(owner));
    const auto effect = dynamics::effect_named(owner);
    found->parameters.push_back(
        estimate(parameter, effect ? unit_of(dynamics::info(*effect), parameter, kind) : "", e));
  }
}

std::vector<result::Rival> rivals(const std::vector<Rival>& all, dynamics::Kind kind) {
  std::vector<result::Rival> out;
  for (const Rival& r : all) {
    result::Rival rival;
    for (const std::string& name : r.names) rival.causes.push_back(cause_of(name));
    add_parameters(r.parameters, kind, rival.causes, rival.retained);
    rival.reason = r.why;
    rival.same_law = r.same_law;
    out.push_back(std::move(rival));
  }
  return out;
}

result::Interval interval(const std::optional<Interval>& i) {
  return i ? result::Interval{i->lower, i->upper} : result::Interval{};
}

result::Finding finding(const Finding& f, const Diagnosis& d, const std::string& main_channel) {
  const dynamics::EffectInfo& effect = dynamics::info(f.effect);
  result::Finding out;
  out.cause.effect = effect.name;
  for (const auto& [name, e] : f.parameters)
    out.cause.parameters.push_back(estimate(name, unit_of(effect, name, d.kind), e));
  out.title = effect.title;
  if (dynamics::has(d.kind, dynamics::LocationType::leg)) out.phase = effect.phase;
  out.law = effect.law;
  out.explanation = f.explanation;
  out.where_to_look = effect.where_to_look;
  out.next_experiment = f.next_experiment;
  out.explainable_nmse_removed = f.explainable_nmse_removed;
  out.explainable_nmse_removed_ci95 = interval(f.removed_interval);
  const std::string channel = f.channel.empty() ? main_channel : f.channel;
  out.gains = {
      {channel, std::string(channel_unit(channel, d.kind)), f.held_out_mae_before, f.held_out_mae_after}};
  out.mae_reduction_ci95 = interval(f.mae_gain_interval);
  out.confidence = f.confidence;
  out.confidence_lowered_by = f.lowered_by;
  out.events = f.events;
  out.observed_events = f.observed_events;
  out.undecided = f.undecided;
  out.alternatives = rivals(f.alternatives, d.kind);
  out.indistinguishable_from = rivals(f.indistinguishable_from, d.kind);
  return out;
}

result::Predictable predictable(const Predictable& f, bool counts) {
  return {f.force, f.share, f.deviations, counts};
}

result::Remainder remainder(const Remainder& r) {
  result::Remainder out;
  out.unit = r.unit;
  out.typical_force = r.typical_force;
  out.typical_force_is = r.typical_is;
  out.random_force = r.random_force;
  out.random_force_held_out = r.random_force_held_out;
  out.correlation_s = r.correlation_s;
  out.impact_scatter = r.impact_scatter;
  out.share = r.largest_random_force() / r.typical_force;
  out.held_out = predictable(r.predictable, r.is_structured());
  out.cross_validated = predictable(r.crossed, r.is_structured_in_training());
  out.p_value = r.new_finds.p_value;
  out.chi_square = r.new_finds.statistic;
  out.rows = r.new_finds.rows;
  out.largest_correlation = r.new_finds.correlation;
  out.lags = kLags;
  out.at_lag = r.new_finds.lag;
  out.white = r.new_finds.white();
  return out;
}

void add_tables(const Diagnosis& d, result::Diagnosis& out) {
  for (const Candidate& c : d.candidates) {
    result::Candidate row;
    for (const std::string& name : c.effects) row.causes.push_back(cause_of(name));
    add_parameters(c.parameters, d.kind, row.causes, row.causes);
    row.cross_validated_gain = c.training_gain;
    row.held_out_gain = c.held_out_gain;
    row.posterior = c.weight;
    row.chosen = c.chosen;
    row.outcome = c.outcome;
    out.candidates.push_back(std::move(row));
  }
  for (const Experiment& e : d.experiments)
    out.experiments.push_back({e.what, sim::format_scenario(e.scenario, d.kind), e.apart,
                               std::string(channel_unit(out.main_channel, d.kind)), e.evidence,
                               e.recordings});
}

}  // namespace

std::string_view channel_unit(std::string_view channel, dynamics::Kind kind) {
  const bool rotary = dynamics::info(kind).rotary;
  if (channel.starts_with("height") || channel.starts_with("position")) return "m";
  if (channel == "leg_angle" || channel.starts_with("angle")) return "rad";
  if (channel.starts_with("velocity")) return rotary ? "rad/s" : "m/s";
  if (channel == "contact") return "s";
  if (channel == "torque") return "N m";
  return "";
}

std::vector<result::ChannelError> channel_errors(const Errors& errors, dynamics::Kind kind) {
  std::vector<result::ChannelError> out;
  for (const auto& [channel, e] : errors)
    out.push_back({channel, std::string(channel_unit(channel, kind)), e.nmse, e.mae, e.rmse});
  return out;
}

std::vector<result::ExcludedWindows> excluded_windows(const std::vector<identify::Excluded>& windows) {
  std::vector<result::ExcludedWindows> out;
  for (const identify::Excluded& l : windows) out.push_back({l.why, l.windows, l.share, l.seconds, l.logs});
  return out;
}

result::Diagnosis result_of(const Diagnosis& d) {
  result::Diagnosis out;
  static_cast<result::Summary&>(out) = d;
  out.kind = dynamics::info(d.kind).name;
  out.hops = d.hops;
  out.windows = d.windows;
  out.fitted_windows = d.fitted_windows;
  out.held_out_windows_excluded = d.windows_excluded;
  out.excluded_windows = excluded_windows(d.excluded);
  out.baseline = channel_errors(d.baseline, d.kind);
  out.refitted = channel_errors(d.refitted, d.kind);
  out.extended = channel_errors(d.extended, d.kind);
  out.noise_floor = channel_errors(d.noise_floor, d.kind);
  out.main_channel = d.main_channel.empty() ? machines::rules(d.kind).channel : d.main_channel;
  out.main_unit = d.main_unit;
  for (const Finding& f : d.findings) out.findings.push_back(finding(f, d, out.main_channel));
  out.unexplained_fraction_of_nmse = d.unexplained_fraction;
  out.white = d.residual_white;
  out.only_noise_left = d.nothing_left;
  if (!d.findings.empty()) out.none_of_catalogue = d.none_of_catalogue;
  out.correlated_with = d.correlated_with;
  if (d.remainder) out.remainder = remainder(*d.remainder);
  add_tables(d, out);
  out.parameters = d.parameters;
  out.traces = d.traces;
  out.residual = d.residual;
  return out;
}

}  // namespace furcula::diagnose
