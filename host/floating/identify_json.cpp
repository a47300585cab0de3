// identification.json of a walking robot.
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/floating/identify.hpp"

namespace furcula::floating {
namespace {

using Json = nlohmann::ordered_json;

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }
Json errors(const WindowErrors& e) {
  return {{"windows", e.windows},
          {"rms_angle_rad", number(e.angle_rad)},
          {"rms_attitude_rad", number(e.attitude_rad)},
          {"rms_gyro_radps", number(e.gyro_radps)}};
}

}  // namespace

std::string to_json_text(const Identified& found, const WindowErrors* held_out_before,
                         const WindowErrors* held_out_after) {
  Json parameters = Json::array();
  for (std::size_t i = 0; i < found.unknowns.size(); ++i) {
    const Unknown& u = found.unknowns[i];
    const auto k = static_cast<Eigen::Index>(i);
    parameters.push_back({{"name", u.name()},
                          {"unit", u.unit.empty() ? Json(nullptr) : Json(u.unit)},
                          {"given", number(u.value(found.given))},
                          {"identified", number(u.value(found.machine))},
                          {"prior_sd", number(u.prior_sd)},
                          {"posterior_sd", number(found.sd[k] * u.prior_sd)}});
  }
  Json causes = Json::array();
  for (const Cause& c : found.causes) {
    const Unknown& u = found.unknowns[c.unknown];
    Json correlated = Json::array();
    for (const std::size_t other : c.correlated_with) correlated.push_back(found.unknowns[other].name());
    causes.push_back({{"name", u.name()},
                      {"unit", u.unit.empty() ? Json(nullptr) : Json(u.unit)},
                      {"deviation", number(c.theta * u.prior_sd)},
                      {"deviation_sd", number(c.sd * u.prior_sd)},
                      {"spread_of_windows", number(c.spread * u.prior_sd)},
                      {"confidence", number(c.confidence)},
                      {"correlated_with", correlated}});
  }
  const Json out = {{"schema", "furcula-walk-identification/1"},
                    {"iterations", found.iterations},
                    {"training", {{"given", errors(found.before)}, {"identified", errors(found.after)}}},
                    {"held_out", held_out_before == nullptr ? Json(nullptr)
                                                            : Json{{"given", errors(*held_out_before)},
                                                                   {"identified", errors(*held_out_after)}}},
                    {"causes", causes},
                    {"all_numbers_deviate", found.all_numbers_deviate},
                    {"parameters", parameters}};
  return out.dump(2) + "\n";
}

}  // namespace furcula::floating
