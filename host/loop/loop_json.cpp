// loop.json of a loop, and what it reads of identification.json.
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "host/core/error.hpp"
#include "host/core/strict_toml.hpp"
#include "host/loop/loop.hpp"
#include "host/loop/whole_run.hpp"

namespace furcula::loop {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "furcula-walk-loop/2";

Json number(double v) { return std::isfinite(v) ? Json(v) : Json(nullptr); }
Json number(const std::optional<double>& v) { return v ? number(*v) : Json(nullptr); }

double number_in(const Json& j) {
  return j.is_null() ? std::numeric_limits<double>::quiet_NaN() : j.get<double>();
}

Json errors(const floating::WindowErrors& e) {
  return {{"windows", e.windows},
          {"rms_angle_rad", number(e.angle_rad)},
          {"rms_attitude_rad", number(e.attitude_rad)},
          {"rms_gyro_radps", number(e.gyro_radps)}};
}
floating::WindowErrors errors_in(const Json& j) {
  floating::WindowErrors out;
  out.windows = j.at("windows");
  out.angle_rad = number_in(j.at("rms_angle_rad"));
  out.attitude_rad = number_in(j.at("rms_attitude_rad"));
  out.gyro_radps = number_in(j.at("rms_gyro_radps"));
  return out;
}

Json identification(const std::optional<Identification>& of) {
  const Identification i = of.value_or(Identification{});
  Json causes = Json::array();
  for (const NamedCause& c : i.causes)
    causes.push_back({{"name", c.name},
                      {"unit", c.unit.empty() ? Json(nullptr) : Json(c.unit)},
                      {"deviation", number(c.deviation)},
                      {"confidence", number(c.confidence)}});
  return {{"training",
           of ? Json{{"given", errors(i.given)}, {"identified", errors(i.identified)}} : Json(nullptr)},
          {"whole_run", i.whole_run_rad ? Json{{"start_rad", i.whole_run_rad->first},
                                               {"identified_rad", i.whole_run_rad->second}}
                                        : Json(nullptr)},
          {"causes", causes},
          {"all_numbers_deviate", i.all_numbers_deviate}};
}
/// Its errors alone.
std::optional<Identification> identification_in(const Json& j) {
  if (j.at("training").is_null()) return {};
  Identification out;
  out.given = errors_in(j.at("training").at("given"));
  out.identified = errors_in(j.at("training").at("identified"));
  return out;
}

constexpr const char* kLoopJson = "a loop.json of furcula walk loop";

template <class Text>
Json parsed(Text&& text, const std::string& path, const char* what) {
  try {
    return Json::parse(std::forward<Text>(text));
  } catch (const Json::exception& e) {
    throw core::DataError(path + ": no JSON: " + e.what() + "; expected " + what);
  }
}
/// Of any size: a triangle grows with the square of the rounds.
Json read_loop_json(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw core::DataError(path + ": cannot be read; expected " + kLoopJson);
  Json j = parsed(file, path, kLoopJson);
  if (!j.is_object() || j.value("schema", Json()) != kSchema)
    throw core::DataError(path + ": schema " + (j.is_object() ? j.value("schema", Json()).dump() : "none") +
                          "; expected \"" + kSchema + "\", in another folder a new loop");
  return j;
}

Triangle triangle_of(const Json& j) {
  Triangle out;
  if (!j.contains("triangle")) return out;
  for (const Json& one : j.at("triangle"))
    if (one.contains("whole_run_rad"))  // else it is calculated again
      out[{one.at("model").is_null() ? kGiven : one.at("model").get<int>(), one.at("round"),
           one.at("repetition")}] = {errors_in(one), number_in(one.at("whole_run_rad"))};
  return out;
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
    Json round = {{"walk", r.walk},
                  {"simulated",
                   {{"ending", walk::kEndingNames[static_cast<std::size_t>(r.simulated.ending)]},
                    {"time_s", r.simulated.time_s},
                    {"distance_m", number(r.simulated.distance_m)},
                    {"cot", number(r.simulated.cot)}}},
                  {"asked_m", number(r.asked_m)},
                  {"trials", trials},
                  {"walks", r.walks}};
    round.update(identification(r.identification));
    rounds.push_back(std::move(round));
  }
  Json triangle = Json::array();
  for (const auto& [cell, e] : result.triangle) {
    Json one{{"model", cell.model == kGiven ? Json(nullptr) : Json(cell.model)},
             {"round", cell.round},
             {"repetition", cell.repetition},
             {"training", cell.training()},
             {"rms_angle_attitude_rad", number(model_error_rad(e.windows))},
             {"whole_run_rad", number(e.whole_run_rad)}};
    one.update(errors(e.windows));
    triangle.push_back(std::move(one));
  }
  Json exercise;
  if (!result.exercise.empty()) {
    exercise = {{"log", result.exercise}};
    exercise.update(identification(result.of_exercise));
  }
  Json all = Json::object();
  for (const auto& [name, value] : settings) all[name] = value;
  return Json{{"schema", kSchema},      {"settings", all},
              {"robot", options.robot}, {"exercise", exercise},
              {"rounds", rounds},       {"triangle", triangle},
              {"walks", result.walks},  {"ended", result.ended.empty() ? Json(nullptr) : Json(result.ended)}}
             .dump(1) +
         "\n";
}

walk::Settings settings_in(const std::string& path) {
  const Json j = read_loop_json(path);
  try {
    walk::Settings out;
    for (const auto& [name, value] : j.at("settings").items()) out.emplace_back(name, value);
    return out;
  } catch (const Json::exception& e) {
    throw core::DataError(path + ": " + e.what() + "; expected " + kLoopJson);
  }
}

Triangle triangle_in(const std::string& path) {
  const Json j = read_loop_json(path);
  try {
    return triangle_of(j);
  } catch (const Json::exception& e) {
    throw core::DataError(path + ": " + e.what() + "; expected " + kLoopJson);
  }
}

LoopResult loop_in(const std::string& path) {
  const Json j = read_loop_json(path);
  LoopResult out;
  try {
    out.triangle = triangle_of(j);
    out.walks = j.at("walks");
    if (const Json& exercise = j.at("exercise"); !exercise.is_null())
      out.exercise = exercise.at("log"), out.of_exercise = identification_in(exercise);
    if (!j.at("ended").is_null()) out.ended = j.at("ended");
    for (const Json& r : j.at("rounds")) {
      Round& round = out.rounds.emplace_back();
      round.walk = r.at("walk");
      round.walks = r.at("walks");
      round.asked_m = number_in(r.at("asked_m"));
      round.identification = identification_in(r);
      for (const Json& t : r.at("trials")) {
        TrialResult& trial = round.trials.emplace_back();
        trial.log = t.at("log");
        if (!t.at("fall_s").is_null()) trial.outcome.fall_s = t.at("fall_s");
        trial.outcome.time_s = t.at("time_s");
        trial.outcome.way_m = number_in(t.at("distance_m"));
        trial.outcome.stands = t.at("stands");
        trial.walks = t.at("walks");
      }
    }
  } catch (const Json::exception& e) {
    throw core::DataError(path + ": " + e.what() + "; expected " + kLoopJson);
  }
  return out;
}

std::string to_json_text(const WholeRunFit& found, const floating::Machine& given,
                         const floating::WindowErrors& before, const floating::WindowErrors& after) {
  floating::Identified all;
  all.unknowns = found.unknowns;
  all.sd = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(found.unknowns.size()),
                                     std::numeric_limits<double>::quiet_NaN());
  all.given = given;
  all.machine = found.machine;
  all.before = before;
  all.after = after;
  Json out = Json::parse(floating::to_json_text(all, nullptr, nullptr));
  out["whole_run"] = {{"start_rad", number(found.start_rad)},
                      {"identified_rad", number(found.error_rad)},
                      {"simulations", found.simulations}};
  return out.dump(2) + "\n";
}

Identification read_identification(const std::string& path) {
  constexpr const char* kWhat = "an identification.json of furcula walk identify";
  const Json j = parsed(core::read_small_file(path, kWhat), path, kWhat);
  Identification out;
  try {
    out.given = errors_in(j.at("training").at("given"));
    out.identified = errors_in(j.at("training").at("identified"));
    if (j.contains("whole_run"))
      out.whole_run_rad = {number_in(j.at("whole_run").at("start_rad")),
                           number_in(j.at("whole_run").at("identified_rad"))};
    out.all_numbers_deviate = j.value("all_numbers_deviate", false);
    for (const Json& c : j.at("causes"))
      out.causes.push_back({c.at("name"), c.at("unit").is_null() ? std::string() : std::string(c.at("unit")),
                            c.at("deviation"), c.at("confidence")});
  } catch (const Json::exception& e) {
    throw core::DataError(path + ": " + e.what() + "; expected " + kWhat);
  }
  return out;
}

}  // namespace furcula::loop
