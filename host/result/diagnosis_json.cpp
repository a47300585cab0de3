// The diagnosis as JSON, in the contract's order of keys.
#include "host/result/diagnosis_json.hpp"

#include <string_view>

namespace furcula::result {
namespace {

Json pair(double first, double second) { return Json::array({number(first), number(second)}); }
Json pair(const Interval& i) { return pair(i.lower, i.upper); }

Json parameters_json(const std::vector<Estimate>& parameters) {
  Json out = Json::object();
  for (const Estimate& e : parameters)
    out[e.name] = {{"unit", e.unit}, {"value", number(e.value)}, {"ci95", pair(e.lower, e.upper)}};
  return out;
}

Json cause_json(const Cause& c) {
  if (c.effect.empty())
    return {{"model_parameter", c.model_parameter}, {"parameters", parameters_json(c.parameters)}};
  return {{"effect", c.effect},
          {"location_type", or_null(c.location_type)},
          {"locations", c.locations},
          {"parameters", parameters_json(c.parameters)}};
}

Json causes_json(const std::vector<Cause>& causes) {
  Json out = Json::array();
  for (const Cause& c : causes) out.push_back(cause_json(c));
  return out;
}

Json rivals_json(const std::vector<Rival>& rivals) {
  Json out = Json::array();
  for (const Rival& r : rivals)
    out.push_back({{"causes", causes_json(r.causes)},
                   {"retained_causes", causes_json(r.retained)},
                   {"reason", r.reason},
                   {"same_law", r.same_law}});
  return out;
}

Json events_json(const std::vector<Event>& events) {
  Json out = Json::array();
  for (const Event& e : events)
    out.push_back(
        {{"log", e.log}, {"time_s", number(e.time_s)}, {key_with_unit("step", e.unit), number(e.step)}});
  return out;
}

Json finding_json(const Finding& f) {
  Json gain = {{"explainable_nmse_removed", number(f.explainable_nmse_removed)},
               {"explainable_nmse_removed_ci95", pair(f.explainable_nmse_removed_ci95)},
               {"explainable_training_loss_removed", number(f.explainable_training_loss_removed)},
               {"channel", f.gains.size() == 1 ? Json(f.gains.front().channel) : Json(nullptr)}};
  for (const ChannelGain& g : f.gains)
    gain[key_with_unit("held_out_mae_" + g.channel, g.unit)] = pair(g.mae_without, g.mae_with);
  gain["held_out_mae_reduction_ci95"] = pair(f.mae_reduction_ci95);
  Json out = cause_json(f.cause);
  out["phase"] = or_null(f.phase);
  out["gain"] = gain;
  out["confidence"] = number(f.confidence);
  out["confidence_lowered_by"] = f.confidence_lowered_by;
  out["events"] = events_json(f.events);
  out["observed_events"] = events_json(f.observed_events);
  out["alternatives"] = rivals_json(f.alternatives);
  out["indistinguishable_from"] = rivals_json(f.indistinguishable_from);
  out["explanation"] = f.explanation;
  out["where_to_look"] = f.where_to_look;
  out["next_experiment"] = f.next_experiment;
  return out;
}

std::string force_or_torque(const std::string& unit) { return unit == "N" ? "force" : "torque"; }

Json predictable_json(const Predictable& p, const std::string& unit) {
  return {{key_with_unit(force_or_torque(unit), unit), number(p.force)},
          {"share_of_squares", number(p.share_of_squares)},
          {"standard_errors", number(p.standard_errors)},
          {"significant", p.significant}};
}

Json unexplained_json(const Diagnosis& d) {
  Json correlated = Json::array();
  for (const Association& a : d.correlated_with)
    correlated.push_back({{"location", or_null(a.location)},
                          {"signal", a.signal},
                          {"strength", number(a.strength)},
                          {"description", a.description}});
  Json out = {{"fraction_of_nmse", number(d.unexplained_fraction_of_nmse)},
              {"fraction_of_missing_force", number(d.unexplained_fraction_of_force)},
              {"white", or_null(d.white)},
              {"only_noise_left", or_null(d.only_noise_left)},
              {"none_of_catalogue", number(d.none_of_catalogue)},
              {"correlated_with", correlated},
              {"repeatability", nullptr},
              {"predictable", nullptr},
              {"whiteness", nullptr}};
  if (!d.remainder) return out;
  const Remainder& r = *d.remainder;
  const std::string force = force_or_torque(r.unit);
  out["repeatability"] = {
      {key_with_unit("random_" + force, r.unit), number(r.random_force)},
      {key_with_unit("random_held_out_" + force, r.unit), number(r.random_force_held_out)},
      {"correlation_s", number(r.correlation_s)},
      {"impact_scatter", number(r.impact_scatter)},
      {"share_of", r.typical_force_is},
      {"share", number(r.share)}};
  out["predictable"] = predictable_json(r.held_out, r.unit);
  out["predictable"]["cross_validated"] = predictable_json(r.cross_validated, r.unit);
  out["whiteness"] = {{"p_value", number(r.p_value)},
                      {"chi_square", number(r.chi_square)},
                      {"lags", r.lags},
                      {"rows", number(r.rows)},
                      {"largest_correlation", number(r.largest_correlation)},
                      {"at_lag", r.at_lag}};
  return out;
}

Json missing_force_json(const std::vector<MissingForce>& missing) {
  Json out = Json::array();
  for (const MissingForce& m : missing)
    out.push_back({{"location", m.location},
                   {key_with_unit("rms_refitted", m.unit), number(m.rms_before)},
                   {key_with_unit("rms_extended", m.unit), number(m.rms_after)},
                   {key_with_unit("persistent_extended", m.unit), number(m.persistent_after)},
                   {key_with_unit("rms_drive", m.unit), number(m.rms_drive)},
                   {"predictable_share_refitted", number(m.predictable_before)},
                   {"predictable_share_extended", number(m.predictable_after)}});
  return out;
}

Json experiments_json(const std::vector<Experiment>& experiments) {
  Json out = Json::array();
  for (const Experiment& e : experiments)
    out.push_back({{"description", e.description},
                   {"recordings", or_null(e.recordings)},
                   {"deviance", number(e.deviance)},
                   {key_with_unit("rms_difference", e.unit), number(e.rms_difference)},
                   {"scenario", or_null(e.scenario)}});
  return out;
}

Json model_parameters_json(const std::vector<Parameter>& parameters) {
  Json out = Json::object();
  for (const Parameter& p : parameters)
    out[p.name] = {{"unit", p.unit},
                   {"free", p.free},
                   {"baseline", number(p.baseline)},
                   {"refitted", number(p.refitted.value)},
                   {"refitted_ci95", pair(p.refitted.lower, p.refitted.upper)},
                   {"extended", number(p.extended.value)},
                   {"extended_ci95", pair(p.extended.lower, p.extended.upper)},
                   {"verdict", or_null(p.verdict)}};
  return out;
}

Json base_parameters_json(const std::vector<BaseParameter>& parameters) {
  Json out = Json::array();
  for (const BaseParameter& b : parameters)
    out.push_back({{"combination", b.combination},
                   {"unit", b.unit},
                   {"baseline", number(b.baseline)},
                   {"extended", number(b.extended)},
                   {"sd", number(b.sd)},
                   {"location", b.location},
                   {key_with_unit("torque_rms", b.torque_unit), number(b.torque_rms)},
                   {"identified", b.identified}});
  return out;
}

Json candidates_json(const std::vector<Candidate>& candidates) {
  Json out = Json::array();
  for (const Candidate& c : candidates)
    out.push_back({{"causes", causes_json(c.causes)},
                   {"cross_validated_gain", number(c.cross_validated_gain)},
                   {"score_test_gain", number(c.score_test_gain)},
                   {"held_out_gain", number(c.held_out_gain)},
                   {"posterior", number(c.posterior)},
                   {"chosen", c.chosen},
                   {"outcome", or_null(c.outcome)}});
  return out;
}

Json data_json(const Diagnosis& d) {
  Json out = {{"logs", d.logs},
              {"held_out_logs", d.held_out_logs},
              {"samples", d.samples},
              {"hops", or_null(d.hops)},
              {"windows", or_null(d.windows)},
              {"fitted_windows", d.fitted_windows},
              {"window_s", number(d.window_s)},
              {"held_out_windows_excluded", d.held_out_windows_excluded},
              {"excluded_windows", excluded_windows_json(d.excluded_windows)}};
  add_data_quality(out, d.data_quality);
  return out;
}

}  // namespace

Json to_json(const Diagnosis& d) {
  Json findings = Json::array(), floor = Json::object();
  for (const Finding& f : d.findings) findings.push_back(finding_json(f));
  for (const ChannelError& e : d.noise_floor)
    if (e.unit != "s") floor["nmse_" + e.channel] = number(e.nmse);
  return {{"schema", "furcula-diagnosis/2"},
          {"kind", d.kind},
          {"verdict", name(d.verdict)},
          {"summary", d.summary},
          {"data", data_json(d)},
          {"baseline", {{"held_out", errors_json(d.baseline)}}},
          {"refitted", {{"held_out", errors_json(d.refitted)}}},
          {"extended", {{"held_out", errors_json(d.extended)}}},
          {"noise_floor", floor},
          {"findings", findings},
          {"unexplained", unexplained_json(d)},
          {"missing_force", missing_force_json(d.missing_force)},
          {"next_experiment", d.next_experiment},
          {"experiments", experiments_json(d.experiments)},
          {"parameters", model_parameters_json(d.parameters)},
          {"base_parameters", base_parameters_json(d.base_parameters)},
          {"candidates", candidates_json(d.candidates)},
          {"notes", d.notes},
          {"files", {{"training", d.training_files}, {"held_out", d.held_out_files}}}};
}

std::string to_json_text(const Diagnosis& diagnosis) {
  return to_json(diagnosis).dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace furcula::result
