#include "host/walk/gait_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/core/message.hpp"

namespace furcula::walk {

std::string to_json_text(const GaitResult& found, const GaitTask& task, const Model& model,
                         const GaitWalk* walk, const Rollout* rollout) {
  using Json = nlohmann::ordered_json;
  const auto number = [](double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); };
  const GaitFigures& f = found.figures;
  const WalkLimits& m = task.limits;
  const auto limited = [&](double is, double limit) { return Json{{"is", number(is)}, {"limit", limit}}; };
  Json out = {{"schema", "furcula-walk-gait/1"},
              {"robot", model.name},
              {"mode", kModeNames[static_cast<std::size_t>(task.mode)]},
              {"target_speed_mps", task.speed_mps ? Json(*task.speed_mps) : Json(nullptr)},
              {"hip_yaw", !task.yaw_held},
              {"found", found.found},
              {"ipopt", found.status},
              {"iterations", found.iterations},
              {"cpu_s", found.cpu_s}};
  if (!found.found) {
    out["limiting_constraint"] = against_gait(found, task);
    return out.dump(2) + "\n";
  }
  Json phases = Json::array();
  for (const GaitPhase& p : found.gait.phases)
    phases.push_back({{"feet", p.both ? 2 : 1}, {"duration_s", p.duration_s}});
  const double duration_s = found.gait.duration_s();
  out["cot"] = f.cot;
  out["speed_mps"] = found.gait.step_m / duration_s;
  out["step_m"] = found.gait.step_m;
  out["step_width_m"] = found.gait.step_width_m;
  out["duration_s"] = duration_s;
  out["phases"] = phases;
  out["energy_j"] = {{"total", f.energy_j},
                     {"copper", f.copper_j},
                     {"work", f.work_j},
                     {"positive_work", f.positive_work_j},
                     {"constant", f.constant_j}};
  out["max"] = {{"torque_nm", limited(f.torque_nm, m.torque_nm)},
                {"speed_radps", limited(f.speed_radps, m.speed_radps)},
                {"moment_nm", limited(f.moment_nm, m.moment_nm)},
                {"range_rad", limited(f.range_rad, m.range_rad)},
                {"friction", limited(f.friction, model.robot.ground.friction)}};
  if (task.mode == WalkMode::semi_passive) out["max"]["spring_off_nm"] = number(f.spring_off_nm);
  out["min"] = {{"height_m", limited(f.height_m, m.height_m)},
                {"apart_m", limited(f.apart_m, m.apart_m)},
                {"knee_rad", limited(f.least_knee_rad, task.least_knee_rad)},
                {"load_n", number(f.load_n)},
                {"pressure_inside_sole_m", number(f.pressure_m)}};
  if (walk != nullptr && rollout != nullptr)
    out["walk"] = {{"targets_off_rad", walk->error_rad},
                   {"ending", kEndingNames[static_cast<std::size_t>(rollout->ending)]},
                   {"time_s", rollout->time_s},
                   {"keeps_limits", rollout->keeps_limits()},
                   {"distance_m", number(rollout->distance_m)}};
  return out.dump(2) + "\n";
}

std::string against_gait(const GaitResult& found, const GaitTask& task) {
  std::string out = "no gait was found";
  if (task.speed_mps) out += " at " + core::shortest(*task.speed_mps) + " m/s";
  if (found.status == "too long")
    out += " in " + core::shortest(task.cpu_s) + " s of processor time";
  else
    out += " (Ipopt: " + found.status + ")";
  if (!found.against.empty()) out += "; limiting constraint: " + found.against;
  return out;
}

}  // namespace furcula::walk
