// The diagnosis as JSON, in the contract's order of keys.
#include "host/diagnose/diagnosis_json.hpp"

#include <cmath>

#include "host/log/dirt_json.hpp"
#include "host/machines/rules.hpp"

namespace furcula::diagnose {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json pair(double first, double second) { return Json::array({number(first), number(second)}); }

Json pair(const std::optional<Interval>& interval) {
  return interval ? pair(interval->lower, interval->upper) : Json::array({nullptr, nullptr});
}

Json object_of(const std::map<std::string, Estimate>& parameters) {
  Json out = Json::object();
  for (const auto& [name, e] : parameters)
    out[name] = {{"value", number(e.value)}, {"ci95", pair(e.lower, e.upper)}};
  return out;
}

std::string with_suffix(std::string key, std::string_view suffix) {
  return suffix.empty() ? key : key.append("_").append(suffix);
}

Json floor_of(const Errors& errors) {
  Json out = Json::object();
  for (const auto& [channel, e] : errors)
    if (channel != "contact") out["nmse_" + channel] = number(e.nmse);
  return out;
}

Json held_out(const Errors& errors, dynamics::Kind kind) {
  Json out = floor_of(errors);
  for (const auto& [channel, e] : errors)
    out[with_suffix("mae_" + channel, channel_suffix(channel, kind))] = number(e.mae);
  for (const auto& [channel, e] : errors)
    out[with_suffix("rmse_" + channel, channel_suffix(channel, kind))] = number(e.rmse);
  return {{"held_out", out}};
}

Json rivals(const std::vector<Rival>& list, const char* reason) {
  Json out = Json::array();
  for (const Rival& r : list) {
    Json rival = {{"effects", r.names}, {reason, r.why}};
    if (!r.parameters.empty()) rival["parameters"] = object_of(r.parameters);
    out.push_back(rival);
  }
  return out;
}

Json finding(const Finding& f, const Diagnosis& d) {
  const dynamics::EffectInfo& effect = dynamics::info(f.effect);
  const std::string channel = f.channel.empty() ? main_channel(d) : f.channel;
  const std::string mae = with_suffix("held_out_mae_" + channel, channel_suffix(channel, d.kind));
  Json gain = {{"explainable_nmse_removed", number(f.explainable_nmse_removed)},
               {mae, pair(f.held_out_mae_before, f.held_out_mae_after)},
               {"explainable_nmse_removed_ci95", pair(f.removed_interval)},
               {"held_out_mae_gain_ci95", pair(f.mae_gain_interval)}};
  if (!f.channel.empty()) gain["channel"] = f.channel;
  Json out = {{"effect", effect.name}};
  if (dynamics::has(d.kind, dynamics::Seat::leg)) out["phase"] = effect.phase;
  out["parameters"] = object_of(f.parameters);
  out["gain"] = gain;
  out["confidence"] = number(f.confidence);
  out["confidence_lowered_by"] = f.lowered_by;
  const auto add_events = [&](const char* key, const std::vector<Finding::Event>& list) {
    if (list.empty()) return;
    const bool rotary = dynamics::info(d.kind).rotary;
    for (const Finding::Event& e : list)
      out[key].push_back(
          {{"log", e.log}, {"time_s", number(e.time_s)}, {rotary ? "step_rad" : "step_m", number(e.step)}});
  };
  add_events("events", f.events);
  add_events("observed_events", f.observed_events);
  out["alternatives"] = rivals(f.alternatives, "why_not");
  out["indistinguishable_from"] = rivals(f.indistinguishable_from, "why");
  out["explanation"] = f.explanation;
  out["next_experiment"] = f.next_experiment;
  return out;
}

}  // namespace

std::string_view channel_suffix(std::string_view channel, dynamics::Kind kind) {
  const bool rotary = dynamics::info(kind).rotary;
  if (channel.starts_with("height") || channel.starts_with("position")) return "m";
  if (channel == "leg_angle" || channel.starts_with("angle")) return "rad";
  if (channel.starts_with("velocity")) return rotary ? "radps" : "mps";
  if (channel == "contact") return "s";
  if (channel == "torque") return "nm";
  return "";
}

std::string main_channel(const Diagnosis& diagnosis) {
  if (!diagnosis.main_channel.empty()) return diagnosis.main_channel;
  return std::string(machines::rules(diagnosis.kind).channel);
}

nlohmann::ordered_json to_json(const Diagnosis& d) {
  Json findings = Json::array();
  for (const Finding& f : d.findings) findings.push_back(finding(f, d));

  Json goes_along_with = Json::array();
  for (const Association& a : d.goes_along_with)
    goes_along_with.push_back({{"signal", a.signal}, {"strength", number(a.strength)}, {"how", a.how}});

  Json candidates = Json::array();
  for (const Candidate& c : d.candidates)
    candidates.push_back({{"effects", c.effects},
                          {"parameters", object_of(c.parameters)},
                          {"training_gain", number(c.training_gain)},
                          {"held_out_gain", number(c.held_out_gain)},
                          {"chosen", c.chosen},
                          {"weight", number(c.weight)},
                          {"outcome", c.outcome}});

  Json experiments = Json::array();
  for (const Experiment& e : d.experiments)
    experiments.push_back({{"what", e.what},
                           {"recordings", e.recordings},
                           {"evidence", number(e.evidence)},
                           {with_suffix("apart", channel_suffix(main_channel(d), d.kind)), number(e.apart)},
                           {"scenario", sim::format_scenario(e.scenario, d.kind)}});

  Json parameters = Json::object();
  for (const Diagnosis::ParameterRow& p : d.parameters)
    parameters[p.name] = {{"unit", p.unit},
                          {"free", p.free},
                          {"given", number(p.given)},
                          {"refitted", number(p.refitted.value)},
                          {"refitted_ci95", pair(p.refitted.lower, p.refitted.upper)},
                          {"extended", number(p.extended.value)},
                          {"extended_ci95", pair(p.extended.lower, p.extended.upper)},
                          {"verdict", p.verdict}};

  Json unexplained{{"fraction_of_nmse", number(d.unexplained_fraction)},
                   {"white", d.residual_white},
                   {"nothing_left", d.nothing_left},
                   {"goes_along_with", goes_along_with}};
  if (!d.findings.empty()) unexplained["none_of_catalogue"] = number(d.none_of_catalogue);
  if (d.remainder) {
    const Remainder& left = *d.remainder;
    unexplained["whiteness"] = {{"p_value", number(left.new_finds.p_value)},
                                {"chi_square", number(left.new_finds.statistic)},
                                {"lags", kLags},
                                {"rows", number(left.new_finds.rows)},
                                {"largest_correlation", number(left.new_finds.correlation)},
                                {"at_lag", left.new_finds.lag}};
    const std::string force = left.unit == "N" ? "force_n" : "torque_nm";
    unexplained["repeatability"] = {{"random_" + force, number(left.random_force)},
                                    {"random_" + force + "_held_out", number(left.random_force_held_out)},
                                    {"correlation_s", number(left.correlation_s)},
                                    {"impact_scatter", number(left.impact_scatter)},
                                    {"share_of", left.typical_is},
                                    {"share", number(left.largest_random_force() / left.typical_force)}};
    unexplained["foretold"] = {{force, number(left.foretold.force)},
                               {"share_of_squares", number(left.foretold.share)},
                               {"standard_errors", number(left.foretold.deviations)},
                               {"counts", left.is_structured()},
                               {"crossed",
                                {{force, number(left.crossed.force)},
                                 {"share_of_squares", number(left.crossed.share)},
                                 {"standard_errors", number(left.crossed.deviations)},
                                 {"counts", left.is_structured_in_training()}}}};
  }

  Json data = {{"logs", d.logs},
               {"hops", d.hops},
               {"samples", d.samples},
               {"held_out_logs", d.held_out_logs},
               {"held_out_windows_left_out", d.windows_left_out}};
  log::add_dirt(data, d.dirt);
  if (!d.left_out.empty()) {
    Json& left = data["left_out"] = Json::array();
    for (const identify::LeftOut& l : d.left_out)
      left.push_back({{"why", l.why},
                      {"windows", l.windows},
                      {"share", number(l.share)},
                      {"seconds", number(l.seconds)},
                      {"logs", l.logs}});
  }

  if (d.fitted_windows < d.windows) {
    data["windows"] = d.fitted_windows;
    data["of_windows"] = d.windows;
  }

  return {{"schema", "furcula-diagnosis/1"},
          {"kind", dynamics::info(d.kind).name},
          {"data", data},
          {"verdict", name(d.verdict)},
          {"summary", d.summary},
          {"baseline", held_out(d.baseline, d.kind)},
          {"refitted", held_out(d.refitted, d.kind)},
          {"extended", held_out(d.extended, d.kind)},
          {"noise_floor", floor_of(d.noise_floor)},
          {"findings", findings},
          {"unexplained", unexplained},
          {"next_experiment", d.next_experiment},
          {"experiments", experiments},
          {"parameters", parameters},
          {"candidates", candidates},
          {"files", {{"training", d.training_files}, {"held_out", d.held_out_files}}}};
}

std::string to_json_text(const Diagnosis& diagnosis) {
  return to_json(diagnosis).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace furcula::diagnose
