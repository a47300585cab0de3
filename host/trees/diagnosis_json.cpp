// A tree's diagnosis as JSON, see diagnosis_json.hpp.
#include "host/trees/diagnosis_json.hpp"

#include "host/log/dirt_json.hpp"
#include "host/trees/json.hpp"
#include "host/trees/next_experiment.hpp"

namespace furcula::trees {
namespace {

Json pair(double first, double second) { return Json::array({number(first), number(second)}); }

Json parameters_of(const std::vector<Estimate>& all) {
  Json out = Json::object();
  for (const Estimate& e : all) out[e.name] = {{"value", number(e.value)}, {"ci95", pair(e.lower, e.upper)}};
  return out;
}

Json in_held_out(const TreeModel& m, const std::vector<ChannelError>& errors) {
  return {{"held_out", held_out(m, errors)}};
}

Json rivals(const std::vector<RivalText>& all, const char* reason) {
  Json out = Json::array();
  for (const RivalText& r : all)
    out.push_back({{"effects", r.causes}, {reason, r.why}, {"parameters", parameters_of(r.parameters)}});
  return out;
}

Json finding(const Finding& f, const Diagnosis& d) {
  Json gain = {{"explainable_nmse_removed", number(f.explainable_removed)}};
  for (std::size_t j = 0; j < f.without.size(); ++j)
    gain["held_out_mae_" + channel_name(d.model, j) + "_" + std::string(channel_unit(d.model, j))] =
        pair(f.without[j].mae, d.extended_error[j].mae);
  return {{"effect", info(f.cause.effect).name},
          {"at", f.at},
          {"seat", name(info(f.cause.effect).seat)},
          {"parameters", parameters_of(f.parameters)},
          {"gain", gain},
          {"confidence", number(f.confidence)},
          {"alternatives", rivals(f.alternatives, "why_not")},
          {"indistinguishable_from", rivals(f.indistinguishable_from, "why")},
          {"explanation", f.explanation},
          {"next_experiment", f.next_experiment}};
}

}  // namespace

std::string to_json_text(const Diagnosis& d) {
  Json findings = Json::array(), missing = Json::object(), tried = Json::array(), floor = Json::object(),
       along = Json::array(), parameters = Json::object();
  for (const Finding& f : d.findings) findings.push_back(finding(f, d));
  bool white = true;
  for (std::size_t j = 0; j < d.missing.size(); ++j) {
    const MissingTorque& m = d.missing[j];
    const std::string& joint = d.model.robot.joints[j].name;
    const std::string unit = d.model.prismatic(j) ? "n" : "nm";
    missing[joint] = {{"rms_before_" + unit, number(m.rms_before_nm)},
                      {"rms_after_" + unit, number(m.rms_after_nm)},
                      {"lasting_after_" + unit, number(m.lasting_after_nm)},
                      {"rms_of_drive_" + unit, number(m.rms_drive_nm)},
                      {"foretold_before", number(m.predictable_before)},
                      {"foretold_after", number(m.predictable_after)}};
    if (m.goes_along_with.empty()) continue;
    white = false;
    along.push_back({{"signal", channel_name(d.model, j)},
                     {"strength", number(m.predictable_after)},
                     {"how", "the torque missing at " + joint + " goes along with " + m.goes_along_with}});
  }
  for (std::size_t j = 0; j < d.noise_floor.size(); ++j)
    floor["nmse_" + channel_name(d.model, j)] = number(d.noise_floor[j]);
  for (const auto& t : d.tried)
    tried.push_back({{"effects", {t.cause}}, {"training_gain", number(t.gain)}, {"chosen", t.chosen}});
  for (const auto& p : d.parameters)
    parameters[p.name] = {{"unit", p.unit},
                          {"given", number(p.given)},
                          {"refitted", number(p.refitted.value)},
                          {"refitted_ci95", pair(p.refitted.lower, p.refitted.upper)},
                          {"extended", number(p.extended.value)},
                          {"extended_ci95", pair(p.extended.lower, p.extended.upper)},
                          {"verdict", p.verdict}};
  Json experiments = Json::array();
  for (const Experiment& e : d.experiments)
    experiments.push_back(
        {{"what", e.what}, {"apart_rad", number(e.apart_rad)}, {"scenario", scenario_of(d.model, e)}});
  Json base = Json::array();
  for (const BaseParameter& b : d.base_parameters)
    base.push_back({{"combination", b.combination},
                    {"unit", b.unit},
                    {"value", number(b.value)},
                    {"extended", number(b.extended)},
                    {"sd", number(b.sd)},
                    {"joint", d.model.robot.joints[b.joint].name},
                    {d.model.prismatic(b.joint) ? "torque_rms_n" : "torque_rms_nm", number(b.torque_rms_nm)},
                    {"shown", b.shown}});
  Json data = {{"logs", d.logs},
               {"samples", d.samples},
               {"windows", d.windows},
               {"window_s", d.window_s},
               {"held_out_logs", d.held_out_logs}};
  log::add_dirt(data, d.dirt);
  const Json out = {
      {"schema", "furcula-diagnosis/1"},
      {"kind", "tree"},
      {"data", data},
      {"verdict", name(d.verdict)},
      {"summary", d.summary},
      {"baseline", in_held_out(d.model, d.as_given_error)},
      {"refitted", in_held_out(d.model, d.refitted_error)},
      {"extended", in_held_out(d.model, d.extended_error)},
      {"noise_floor", floor},
      {"findings", findings},
      {"unexplained",
       {{"fraction_of_nmse", number(d.unexplained_share)}, {"white", white}, {"goes_along_with", along}}},
      {"missing_torque", missing},
      {"next_experiment", d.next_experiment},
      {"experiments", experiments},
      {"parameters", parameters},
      {"base_parameters", base},
      {"candidates", tried},
      {"notes", d.notes},
      {"files", {{"training", d.training_files}, {"held_out", d.held_out_files}}}};
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace furcula::trees
