// Files and summary, see result.hpp.
#include "host/excite/result.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/message.hpp"
#include "host/result/json.hpp"
#include "host/trees/recording.hpp"

namespace furcula::excite {
namespace {

using result::Json, result::number;

std::string file_name(const char* what, std::size_t recording, const char* end) {
  return std::string(what) + "_" + std::to_string(recording + 1) + end;
}

Json extremes_json(const Result& r, const trees::Scenario& s) {
  const std::vector<Extremes> all = extremes(r.model, s, 1.0 / s.sample_rate_hz);
  Json out = Json::object();
  for (std::size_t j = 0; j < r.model.joints(); ++j)
    out[r.model.robot.joints[j].name] = {{"start", number(s.paths[j].at(0.0).q)},
                                         {"lowest", number(all[j].lowest_rad)},
                                         {"highest", number(all[j].highest_rad)},
                                         {"velocity", number(all[j].velocity_radps)},
                                         {"effort", number(all[j].torque_nm)}};
  return out;
}

Json causes_json(const Check& check) {
  Json out = Json::array();
  for (const Check::OfCause& c : check.causes) {
    const trees::EffectInfo& e = trees::info(c.cause.effect);
    Json numbers = Json::object();
    for (const Check::Number& n : c.numbers)
      numbers[n.name] = {
          {"unit", n.unit}, {"size", number(n.size)}, {"ci95_half_width", number(n.half_width)}};
    out.push_back({{"cause", c.name},
                   {"effect", std::string(e.name)},
                   {"location_type", std::string(trees::name(e.location_type))},
                   {"parameters", numbers},
                   {"visible", c.seen},
                   {"visible_in_any_motion", c.ever}});
  }
  return out;
}

}  // namespace

std::string setpoints_csv(const trees::TreeModel& m, const trees::Scenario& s) {
  std::string out = "time_s";
  for (std::size_t j = 0; j < m.joints(); ++j) {
    const std::string &joint = m.robot.joints[j].name, unit = m.prismatic(j) ? "m" : "rad";
    out += "," + trees::column_of(m, j, "angle_cmd") + ",velocity_cmd_" + joint + "_" + unit + "ps";
  }
  out += "\n";
  const auto rows = static_cast<std::size_t>(std::lround(s.duration_s * s.sample_rate_hz));
  for (std::size_t k = 0; k <= rows; ++k) {
    const double t = static_cast<double>(k) / s.sample_rate_hz;
    out += core::rounded(t, 9);
    for (std::size_t j = 0; j < m.joints(); ++j) {
      const trees::Path::Point p = s.paths[j].at(t);
      // To a micro-radian: rounding must not look like motion.
      const auto digits = [](double x) { return core::shortest(std::round(x * 1e6) / 1e6 + 0.0); };
      out += "," + digits(p.q) + "," + digits(p.v);
    }
    out += "\n";
  }
  return out;
}

std::string to_json_text(const Result& r) {
  const trees::TreeModel& m = r.model;
  Json limits = Json::object(), recordings = Json::array(), parameters = Json::object(),
       confused = Json::array(), noise = {{"angle_noise_rad", number(m.angle_noise_rad)}};
  for (std::size_t j = 0; j < r.limits.size(); ++j)
    limits[m.robot.joints[j].name] = {{"lower", number(r.limits[j].lower_rad)},
                                      {"upper", number(r.limits[j].upper_rad)},
                                      {"velocity", number(r.limits[j].velocity_radps)},
                                      {"effort", number(r.limits[j].torque_nm)}};
  for (std::size_t k = 0; k < r.design.scenarios.size(); ++k) {
    const trees::Scenario& s = r.design.scenarios[k];
    recordings.push_back({{"setpoints", file_name("setpoints", k, ".csv")},
                          {"scenario", file_name("scenario", k, ".toml")},
                          {"duration_s", number(s.duration_s)},
                          {"sample_rate_hz", number(s.sample_rate_hz)},
                          {"joints", extremes_json(r, s)}});
    for (std::size_t j = 0; j < m.joints(); ++j)
      noise["torque_noise_nm"][m.robot.joints[j].name] = number(s.torque_noise_nm[j]);
  }
  for (const Check::Parameter& p : r.check.parameters) {
    parameters[p.name] = {{"unit", p.unit},
                          {"given", number(p.given)},
                          {"ci95_half_width", number(p.half_width)},
                          {"verdict", p.verdict}};
    if (!p.with.empty()) parameters[p.name]["correlated_with"] = p.with;
  }
  for (const Check::Confused& c : r.check.confused)
    confused.push_back({{"causes", c.names},
                        {"correlation", number(c.correlation)},
                        {"separable_in_any_motion", c.ever},
                        {"text", sentence(c)}});
  const bool designed = !r.design.scenarios.empty();
  Json out = {{"schema", "furcula-excitation/1"}, {"kind", "tree"}, {"robot", m.robot.name}};
  out["design"] = designed ? Json{{"criterion", r.options.criterion == Criterion::d ? "D" : "A"},
                                  {"seed", r.options.seed},
                                  {"evaluations", r.options.evaluations},
                                  {"of_random", number(r.design.of_random)},
                                  {"of_design", number(r.design.of_design)}}
                           : Json(nullptr);
  out["limits"] = limits;
  out["recordings"] = recordings;
  out["checked_logs"] = r.logs;
  out["noise"] = noise;
  out["windows"] = r.check.windows;
  out["parameters"] = parameters;
  out["causes"] = causes_json(r.check);
  out["indistinguishable"] = confused;
  out["base_parameters"] = r.check.combinations;
  out["notes"] = m.notes;
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::vector<core::NewFile> files(const Result& r, const std::string& folder) {
  std::vector<core::NewFile> out;
  for (std::size_t k = 0; k < r.design.scenarios.size(); ++k) {
    out.push_back(
        {folder + "/" + file_name("setpoints", k, ".csv"), setpoints_csv(r.model, r.design.scenarios[k])});
    out.push_back({folder + "/" + file_name("scenario", k, ".toml"),
                   trees::format_scenario(r.model, r.design.scenarios[k])});
  }
  out.push_back({folder + "/excitation.json", to_json_text(r)});
  return out;
}

std::string summary(const Result& r) {
  std::string out;
  const auto line = [&](const std::string& text) { out += core::printable(text) + "\n"; };
  for (std::size_t k = 0; k < r.design.scenarios.size(); ++k) {
    const trees::Scenario& s = r.design.scenarios[k];
    const std::vector<Extremes> all = extremes(r.model, s, 1.0 / s.sample_rate_hz);
    line(file_name("setpoints", k, ".csv") + ": " + core::shortest(s.duration_s) + " s");
    for (std::size_t j = 0; j < all.size(); ++j) {
      const bool slides = r.model.prismatic(j);
      line("  " + r.model.robot.joints[j].name + " from " + core::rounded(all[j].lowest_rad, 3) + " to " +
           core::rounded(all[j].highest_rad, 3) + (slides ? " m, " : " rad, ") +
           core::rounded(all[j].velocity_radps, 3) + (slides ? " m/s, " : " rad/s, ") +
           core::rounded(all[j].torque_nm, 3) + (slides ? " N" : " N m") + " at most, starts at " +
           core::rounded(s.paths[j].at(0.0).q, 3));
    }
  }
  if (!r.check.parameters.empty()) line("free parameters, expected 95 % intervals:");
  for (const Check::Parameter& p : r.check.parameters)
    line("  " + p.name + " = " + core::rounded(p.given) + " +- " + core::rounded(p.half_width, 3) + " " +
         p.unit + "  " + p.verdict + (p.with.empty() ? "" : " (" + p.with + ")"));
  line("causes, each beside the free parameters, expected 95 % intervals:");
  std::string unseen, never;
  for (const Check::OfCause& c : r.check.causes) {
    if (!c.seen) {
      std::string& to = c.ever ? unseen : never;
      to += (to.empty() ? "" : ", ") + c.name;
      continue;
    }
    std::string text = "  " + c.name;
    for (const Check::Number& n : c.numbers)
      text += "  " + n.name + " +- " + core::rounded(n.half_width, 3) + (n.unit.empty() ? "" : " " + n.unit);
    line(text);
  }
  if (!unseen.empty())
    line("Not visible in these recordings at the size that is looked for: " + unseen + ".");
  if (!never.empty()) line("Not visible in any motion, since the base is fixed: " + never + ".");
  for (const Check::Confused& c : r.check.confused) line(sentence(c));
  return out;
}

}  // namespace furcula::excite
