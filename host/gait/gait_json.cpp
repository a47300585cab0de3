#include "host/gait/gait_json.hpp"

#include <nlohmann/json.hpp>

namespace furcula::gait {

std::string to_json_text(const Search& search) {
  using Json = nlohmann::ordered_json;
  const Gait& gait = *search.gait;
  const Evaluation& e = search.evaluation;
  Json multipliers = Json::array();
  for (const auto& m : e.multipliers) multipliers.push_back(std::abs(m));
  Json optima = Json::array();
  for (const Optimum& o : search.optima)
    optima.push_back({{gait.task.speed_mps ? "cot" : "cost_j", o.cost}, {"starts", o.starts}});
  const Json out{{"schema", "furcula-gait/1"},
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
                 {"multipliers", multipliers},
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
