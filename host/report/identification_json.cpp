#include "host/report/identification_json.hpp"

#include "host/diagnose/result.hpp"
#include "host/result/json.hpp"

namespace furcula::report {
namespace {

using identify::Estimation;
using identify::Identification;
using result::Json;
using result::number;

Json numbers(const std::vector<double>& values) {
  Json list = Json::array();
  for (double v : values) list.push_back(number(v));
  return list;
}

Json errors(const identify::Errors& all, dynamics::Kind kind) {
  return result::errors_json(diagnose::channel_errors(all, kind));
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
      columns[result::key_with_unit("mae_" + channel, diagnose::channel_unit(channel, id.kind))].push_back(
          figures.mae);
    }
  for (const auto& [name, values] : columns) cv[name] = numbers(values);
  out["cross_validation"] = cv;
  if (e.held_out) out["held_out"] = errors(*e.held_out, id.kind);
  return out;
}

}  // namespace

std::string to_json_text(const Identification& id) {
  Json out = {{"schema", "furcula-identification/2"}, {"kind", dynamics::info(id.kind).name}};
  out.update(body(id.estimations.front(), id));
  if (id.estimations.size() > 1) out["equation_error"] = body(id.estimations[1], id);
  out["data"] = {{"logs", id.logs},
                 {"windows", id.windows},
                 {"samples", id.samples},
                 {"held_out_logs", id.held_out_logs}};
  out["data"]["excluded_windows"] = result::excluded_windows_json(diagnose::excluded_windows(id.excluded));
  result::add_data_quality(out["data"], id.data_quality);
  out["notes"] = Json::array();
  if (id.as_given) out["as_given"] = errors(*id.as_given, id.kind);
  return out.dump(2) + "\n";
}

}  // namespace furcula::report
