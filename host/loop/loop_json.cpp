// loop.json of a loop, and what it reads of identification.json.
#include <cmath>
#include <nlohmann/json.hpp>

#include "host/core/error.hpp"
#include "host/core/strict_toml.hpp"
#include "host/loop/loop.hpp"

namespace furcula::loop {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "furcula-walk-loop/1";

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }
Json number(const std::optional<double>& v) { return v ? number(*v) : Json(nullptr); }

Json errors(const floating::WindowErrors& e) {
  return {{"windows", e.windows},
          {"rms_angle_rad", number(e.angle_rad)},
          {"rms_attitude_rad", number(e.attitude_rad)},
          {"rms_gyro_radps", number(e.gyro_radps)}};
}
floating::WindowErrors errors_in(const Json& j) {
  floating::WindowErrors out;
  out.windows = j.at("windows");
  out.angle_rad = j.at("rms_angle_rad");
  out.attitude_rad = j.at("rms_attitude_rad");
  out.gyro_radps = j.at("rms_gyro_radps");
  return out;
}

Json read(const std::string& path, const char* what) {
  try {
    return Json::parse(core::read_small_file(path, what));
  } catch (const Json::exception& e) {
    throw core::DataError(path + ": no JSON: " + e.what() + "; expected " + what);
  }
}

}  // namespace

std::string to_json_text(const walk::Settings& settings, const LoopOptions& options,
                         const LoopResult& result) {
  Json rounds = Json::array();
  for (const Round& r : result.rounds) {
    Json trials = Json::array();
    for (const TrialResult& t : r.trials)
      trials.push_back({{"log", t.log},
                        {"fall_s", number(t.outcome.fall_s)},
                        {"time_s", t.outcome.time_s},
                        {"distance_m", number(t.outcome.way_m)},
                        {"stands", t.outcome.stands},
                        {"walks", t.walks}});
    Json causes = Json::array();
    for (const NamedCause& c : r.causes)
      causes.push_back({{"name", c.name},
                        {"unit", c.unit.empty() ? Json(nullptr) : Json(c.unit)},
                        {"deviation", number(c.deviation)},
                        {"confidence", number(c.confidence)}});
    rounds.push_back(
        {{"walk", r.walk},
         {"simulated",
          {{"ending", walk::kEndingNames[static_cast<std::size_t>(r.simulated.ending)]},
           {"time_s", r.simulated.time_s},
           {"distance_m", number(r.simulated.distance_m)},
           {"cot", number(r.simulated.cot)}}},
         {"asked_m", number(r.asked_m)},
         {"trials", trials},
         {"walks", r.walks},
         {"training",
          r.given ? Json{{"given", errors(*r.given)}, {"identified", errors(*r.identified)}} : Json(nullptr)},
         {"causes", causes}});
  }
  Json all = Json::object();
  for (const auto& [name, value] : settings) all[name] = value;
  return Json{{"schema", kSchema},      {"settings", all},
              {"robot", options.robot}, {"rounds", rounds},
              {"walks", result.walks},  {"ended", result.ended.empty() ? Json(nullptr) : Json(result.ended)}}
             .dump(1) +
         "\n";
}

walk::Settings settings_in(const std::string& path) {
  const Json j = read(path, "a loop.json of furcula walk loop");
  try {
    if (j.at("schema") != kSchema)
      throw core::DataError(path + ": schema " + j.at("schema").dump() + "; expected \"" + kSchema + "\"");
    walk::Settings out;
    for (const auto& [name, value] : j.at("settings").items()) out.emplace_back(name, value);
    return out;
  } catch (const Json::exception& e) {
    throw core::DataError(path + ": " + e.what() + "; expected a loop.json of furcula walk loop");
  }
}

void read_identification(const std::string& path, Round& round) {
  const Json j = read(path, "an identification.json of furcula walk identify");
  try {
    round.given = errors_in(j.at("training").at("given"));
    round.identified = errors_in(j.at("training").at("identified"));
    for (const Json& c : j.at("causes"))
      round.causes.push_back({c.at("name"),
                              c.at("unit").is_null() ? std::string() : std::string(c.at("unit")),
                              c.at("deviation"), c.at("confidence")});
  } catch (const Json::exception& e) {
    throw core::DataError(path + ": " + e.what() +
                          "; expected an identification.json of furcula walk identify");
  }
}

}  // namespace furcula::loop
