// See result.hpp.
#include "host/trees/result.hpp"

#include <algorithm>

#include "host/trees/next_experiment.hpp"

namespace furcula::trees {
namespace {

result::Finding finding(const Finding& f, const Diagnosis& d) {
  const EffectInfo& e = info(f.cause.effect);
  result::Finding out;
  out.cause = {std::string(e.name), {}, std::string(name(e.location_type)), f.at, f.parameters};
  out.title = e.label;
  out.law = e.law;
  out.explanation = f.explanation;
  out.where_to_look = f.where_to_look;
  out.next_experiment = f.next_experiment;
  out.explainable_training_loss_removed = f.explainable_removed;
  for (std::size_t j = 0; j < f.without.size(); ++j)
    out.gains.push_back({channel_name(d.model, j), std::string(channel_unit(d.model, j)), f.without[j].mae,
                         d.extended_error[j].mae, f.without[j].nmse, d.extended_error[j].nmse});
  out.confidence = f.confidence;
  out.confidence_lowered_by = f.lowered_by;
  out.undecided = std::any_of(f.indistinguishable_from.begin(), f.indistinguishable_from.end(),
                              [](const result::Rival& r) { return !r.same_law; });
  out.alternatives = f.alternatives;
  out.indistinguishable_from = f.indistinguishable_from;
  return out;
}

void add_missing_force(const Diagnosis& d, std::size_t joint, result::Diagnosis& out) {
  const MissingTorque& m = d.missing[joint];
  const bool slides = d.model.prismatic(joint);
  const std::string& name = d.model.robot.joints[joint].name;
  result::MissingForce force;
  force.location = name;
  force.unit = slides ? "N" : "N m";
  force.velocity_unit = slides ? "m/s" : "rad/s";
  force.position_unit = slides ? "m" : "rad";
  force.time_s = m.time_s;
  force.velocity = m.velocity_radps;
  force.position = m.angle_rad;
  force.before = m.before_nm;
  force.after = m.after_nm;
  force.rms_before = m.rms_before_nm;
  force.rms_after = m.rms_after_nm;
  force.rms_joint = m.rms_torque_nm;
  force.rms_drive = m.rms_drive_nm;
  force.persistent_after = m.persistent_after_nm;
  force.predictable_before = m.predictable_before;
  force.predictable_after = m.predictable_after;
  force.correlated_with = m.correlated_with;
  if (!m.correlated_with.empty())
    out.correlated_with.push_back(
        {name, m.correlated_with, m.predictable_after,
         "the torque missing at " + name + " is correlated with " + m.correlated_with});
  out.missing_force.push_back(std::move(force));
}

}  // namespace

result::Cause named(const TreeModel& model, const Cause& cause) {
  const EffectInfo& e = info(cause.effect);
  result::Cause out{std::string(e.name), {}, std::string(name(e.location_type)), {}, {}};
  for (const std::size_t site : cause.sites) out.locations.push_back(site_name(model, e.location_type, site));
  return out;
}

std::vector<result::ChannelError> channel_errors(const TreeModel& model,
                                                 const std::vector<ChannelError>& errors) {
  std::vector<result::ChannelError> out;
  for (std::size_t j = 0; j < errors.size(); ++j)
    out.push_back({channel_name(model, j), std::string(channel_unit(model, j)), errors[j].nmse, errors[j].mae,
                   errors[j].rmse, model.robot.joints[j].name});
  return out;
}

result::Diagnosis result_of(const Diagnosis& d) {
  result::Diagnosis out;
  static_cast<result::Summary&>(out) = d;
  out.kind = "tree";
  out.robot = d.model.robot.name;
  out.joints = d.model.joints();
  out.fitted_windows = d.windows;
  out.window_s = d.window_s;
  out.baseline = channel_errors(d.model, d.as_given_error);
  out.refitted = channel_errors(d.model, d.refitted_error);
  out.extended = channel_errors(d.model, d.extended_error);
  for (std::size_t j = 0; j < d.noise_floor.size(); ++j)
    out.noise_floor.push_back({channel_name(d.model, j), std::string(channel_unit(d.model, j)),
                               d.noise_floor[j], result::kUnknown, result::kUnknown,
                               d.model.robot.joints[j].name});
  // The headline's figures are of the channel that the re-fitted model gets most wrong.
  const auto worst = std::max_element(out.refitted.begin(), out.refitted.end(),
                                      [](const auto& a, const auto& b) { return a.nmse < b.nmse; });
  if (worst != out.refitted.end()) {
    out.main_channel = worst->channel;
    out.main_unit = worst->unit;
  }
  for (const Finding& f : d.findings) out.findings.push_back(finding(f, d));
  out.unexplained_fraction_of_force = d.unexplained_share;
  for (std::size_t j = 0; j < d.missing.size(); ++j) add_missing_force(d, j, out);
  for (const Experiment& e : d.experiments)
    out.experiments.push_back({e.what, scenario_of(d.model, e), e.apart_rad, "rad", result::kUnknown, {}});
  out.parameters = d.parameters;
  for (const BaseParameter& b : d.base_parameters)
    out.base_parameters.push_back({b.combination, b.unit, b.value, b.extended, b.sd,
                                   d.model.robot.joints[b.joint].name, b.torque_rms_nm,
                                   d.model.prismatic(b.joint) ? "N" : "N m", b.shown});
  out.candidates = d.candidates;
  out.traces = d.traces;
  return out;
}

}  // namespace furcula::trees
