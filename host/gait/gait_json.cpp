#include "host/gait/gait_json.hpp"

#include <nlohmann/json.hpp>

namespace furcula::gait {
namespace {

using Json = nlohmann::ordered_json;

Json joints(const Joints2<double>& v) { return {{"hip", v.hip}, {"knee", v.knee}}; }

Json sizes(const std::vector<std::complex<double>>& multipliers) {
  Json out = Json::array();
  for (const auto& m : multipliers) out.push_back(std::abs(m));
  return out;
}

Json text_of(const Stability& s) {
  const BasinOptions box;
  return {{"law",
           {{"kp_nmprad", joints(s.gains.kp_nmprad)},
            {"kd_nmsprad", joints(s.gains.kd_nmsprad)},
            {"most_nm", s.gains.most_nm}}},
          {"multipliers", sizes(s.multipliers)},
          {"basin", s.basin.share()},
          {"basin_without_law", s.open_loop.share()},
          {"starts", s.basin.starts},
          {"strides", box.strides},
          {"spread",
           {{"height_m", box.spread.height},
            {"speed_mps", box.spread.speed},
            {"angle_rad", box.spread.angle.hip},
            {"rate_radps", box.spread.rate.hip}}}};
}

Json text_of(const Disturbed& with, const Disturbed& without) {
  const DisturbedOptions o;
  return {{"strides", with.strides},
          {"ground_m", o.ground_m},
          {"switch_late_s", o.switch_late_s},
          {"falls", with.falls},
          {"falls_without_law", without.falls},
          {"cost_j", with.cost_j},
          {"apex_spread_m", with.apex_spread_m}};
}

Json text_of(const StableGait& s) {
  return {{"landing_speed_mps", s.landing_speed_mps},
          {"cost_j", s.evaluation.cost_j},
          {"cot", s.evaluation.cot ? Json(*s.evaluation.cot) : Json(nullptr)},
          {"multiplier", std::abs(s.stability.multipliers.front())},
          {"basin", s.stability.basin.share()}};
}

Json text_of(const OpenFigures& open, const Gait& gait) {
  const auto ends = [](const Interval& i) { return Json{i.low, i.high}; };
  Json parameters = Json::object();
  for (const OpenParameter& o : gait.machine.open) parameters[o.name] = Json{o.low, o.high};
  return {{"parameters", parameters},
          {"corners", open.corners},
          {"corners_without_gait", open.without},
          {"cost_j", ends(open.cost_j)},
          {"cot", gait.task.speed_mps ? ends(open.cot) : Json(nullptr)},
          {"eta", ends(open.eta)},
          {"touchdown_knee_rad", ends(open.touchdown_knee_rad)},
          {"multiplier", ends(open.multiplier)}};
}

}  // namespace

std::string to_json_text(const Search& search, const Evidence& evidence) {
  const Gait& gait = *search.gait;
  const Evaluation& e = search.evaluation;
  Json optima = Json::array();
  for (const Optimum& o : search.optima)
    optima.push_back({{gait.task.speed_mps ? "cot" : "cost_j", o.cost}, {"starts", o.starts}});
  const Json out{
      {"schema", "furcula-gait/1"},
      {"torque", gait.is_fourier() ? "fourier" : "free"},
      {"spring", dynamics::kLegSpringNames[static_cast<std::size_t>(gait.machine.spring)]},
      {"lift_off", dynamics::kLegLiftOffNames[static_cast<std::size_t>(gait.task.lift_off)]},
      {"cost_j", e.cost_j},
      {"cot", e.cot ? Json(*e.cot) : Json(nullptr)},
      {"speed_mps", gait.task.speed_mps ? e.speed_mps : 0.0},
      {"clearance_m", e.stride.highest_toe},
      {"eta", e.eta},
      {"touchdown_knee_rad", e.stride.touchdown_knee},
      {"stride_s", e.stride_s},
      {"stance_s", e.stride.stance},
      {"closure", e.closure},
      {"multipliers", sizes(e.multipliers)},
      {"stability", text_of(evidence.stability)},
      {"disturbed", evidence.disturbed.strides > 0 ? text_of(evidence.disturbed, evidence.disturbed_open_loop)
                                                   : Json(nullptr)},
      {"cheapest_stable", evidence.stable ? text_of(*evidence.stable) : Json(nullptr)},
      {"open", evidence.open.corners > 0 ? text_of(evidence.open, gait) : Json(nullptr)},
      {"touchdown_speed_mps", e.stride.touchdown_speed_mps},
      {"required_friction", e.stride.friction},
      {"impact_friction", e.stride.impact_friction},
      {"motors",
       {{"voltage_v", e.stride.voltage_v},
        {"current_a", e.stride.current_a},
        {"speed_radps", e.stride.motor_speed_radps}}},
      {"limits", e.limits},
      {"local_optima", optima},
      {"starts_without_gait", search.without},
      {"seconds", search.seconds}};
  return out.dump(2) + "\n";
}

}  // namespace furcula::gait
