#include "host/report/identification_json.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "host/diagnose/diagnosis_json.hpp"
#include "host/log/dirt_json.hpp"

namespace furcula::report {
namespace {

using Json = nlohmann::ordered_json;
using identify::Estimation;
using identify::Identification;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (double v : values) list.push_back(number(v));
  return list;
}

std::string key(const char* figure, const std::string& channel, dynamics::Kind kind) {
  const std::string suffix(diagnose::channel_suffix(channel, kind));
  return std::string(figure) + "_" + channel + (suffix.empty() ? "" : "_" + suffix);
}

Json errors(const identify::Errors& all, dynamics::Kind kind) {
  Json out = Json::object();
  for (const auto& [channel, e] : all) out["nmse_" + channel] = number(e.nmse);
  for (const auto& [channel, e] : all) out[key("mae", channel, kind)] = number(e.mae);
  for (const auto& [channel, e] : all) out[key("rmse", channel, kind)] = number(e.rmse);
  return out;
}

Json body(const Estimation& e, const Identification& id) {
  Json out;
  out["method"] = identify::name(e.method);
  out["parameters"] = Json::object();
  for (const auto& p : e.parameters) {
    Json row = {{"value", number(p.value)},
                {"ci95", {number(p.lower), number(p.upper)}},
                {"folds", numbers(p.folds)},
                {"verdict", p.verdict},
                {"unit", p.unit},
                {"given", number(p.given)}};
    if (!p.with.empty()) row[p.verdict == "correlated" ? "correlated_with" : "bound"] = p.with;
    out["parameters"][p.name] = row;
  }
  out["derived"] = Json::object();
  for (const auto& d : e.derived)
    out["derived"][d.name] = {{"value", number(d.value)}, {"folds", numbers(d.folds)}};
  Json cv = {{"folds", id.folds}};
  std::map<std::string, std::vector<double>> columns;
  for (const auto& fold : e.folds)
    for (const auto& [channel, figures] : fold) {
      columns["nmse_" + channel].push_back(figures.nmse);
      columns[key("mae", channel, id.kind)].push_back(figures.mae);
    }
  for (const auto& [name, values] : columns) cv[name] = numbers(values);
  out["cross_validation"] = cv;
  if (e.held_out) out["held_out"] = errors(*e.held_out, id.kind);
  return out;
}

}  // namespace

std::string to_json_text(const Identification& id) {
  Json out = {{"schema", "furcula-identification/1"}};
  out.update(body(id.estimations.front(), id));
  if (id.estimations.size() > 1) out["equation_error"] = body(id.estimations[1], id);
  out["data"] = {{"logs", id.logs},
                 {"windows", id.windows},
                 {"samples", id.samples},
                 {"held_out_logs", id.held_out_logs}};
  log::add_dirt(out["data"], id.dirt);
  if (!id.left_out.empty()) {
    Json& left = out["data"]["left_out"] = Json::array();
    for (const identify::LeftOut& l : id.left_out)
      left.push_back({{"why", l.why},
                      {"windows", l.windows},
                      {"share", l.share},
                      {"seconds", l.seconds},
                      {"logs", l.logs}});
  }
  if (id.as_given) out["as_given"] = errors(*id.as_given, id.kind);
  return out.dump(2) + "\n";
}

}  // namespace furcula::report
