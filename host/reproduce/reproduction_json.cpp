#include "host/reproduce/reproduction_json.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "host/reproduce/rows.hpp"

namespace furcula::reproduce {
namespace {

using Json = nlohmann::ordered_json;

Json estimates(const Estimates& e) {
  Json out{{"phase", e.phase}, {"method", e.method}};
  for (std::size_t i = 0; i < e.names.size(); ++i) {
    Json folds = Json::array();
    for (const auto& fold : e.folds) folds.push_back(fold[i]);
    out["parameters"][e.names[i]] = {{"value", e.values[i]}, {"folds", folds}};
  }
  for (const TrajectoryErrors& t : e.errors)
    out["validation"].push_back({{"nmse_height", t.nmse_height},
                                 {"nmse_velocity", t.nmse_velocity},
                                 {"mae_height_m", t.mae_height_m},
                                 {"mae_velocity_mps", t.mae_velocity_mps},
                                 {"worst_height_m", t.worst_height_m}});
  return out;
}

}  // namespace

std::string to_json_text(const Reproduction& r) {
  Json out{{"schema", "furcula-reproduction/1"}, {"document", "002"}, {"seed", r.options.seed}};
  for (const Outcome o : {Outcome::met, Outcome::smaller, Outcome::explained, Outcome::differs,
                          Outcome::computed, Outcome::by_construction})
    out["count"][name(o)] = count(r.rows, o);
  for (const Row& row : r.rows) {
    Json counterfactuals = Json::array();
    for (const Counterfactual& c : row.counterfactuals)
      counterfactuals.push_back({{"what", c.what},
                                 {"value", c.value},
                                 {"unit", c.unit.empty() ? row.unit : c.unit},
                                 {"guessed", c.guessed}});
    Json out_row = json_of(row);
    out_row["counterfactuals"] = counterfactuals;
    out["rows"].push_back(std::move(out_row));
  }
  for (const Omission& o : r.omissions)
    out["omissions"].push_back(
        {{"where", o.where}, {"published", o.published}, {"because", name(o.because)}, {"why", o.why}});
  const IdentificationStudy& s = r.study;
  Json truth;
  const auto& table = dynamics::info(s.rig.truth.kind).parameters;
  for (std::size_t i = 0; i < table.size(); ++i)
    truth[std::string(table[i].name)] = s.rig.truth.parameters[i];
  for (const auto& [effect, values] : s.rig.truth.effects) {
    const dynamics::EffectInfo& e = dynamics::info(effect);
    for (std::size_t i = 0; i < e.parameter_count; ++i)
      truth[std::string(e.name) + "." + std::string(e.parameter_table[i].name)] = values[i];
  }
  out["rig"] = {{"truth", truth},
                {"weighed_kg", s.rig.weighed_kg},
                {"measured_stiffness_npm", s.rig.stiffness_npm},
                {"measured_rest_height_m", s.rig.rest_height_m}};
  for (const Estimates* e : {&s.stance, &s.stance_by_equation, &s.stance_by_equation_raw, &s.flight,
                             &s.flight_by_equation, &s.strides, &s.nonlinear})
    out["identification"].push_back(estimates(*e));
  for (const PlainStudy& p : s.plain) out["identification"].push_back(estimates(p.estimates));
  for (const auto& v : s.variants)
    out["stance_variants"].push_back({{"identified", v.freed},
                                      {"mass_kg", v.mass_kg},
                                      {"stiffness_npm", v.stiffness_npm},
                                      {"damping_nspm", v.damping_nspm},
                                      {"damped_frequency_radps", v.damped_frequency_radps},
                                      {"nmse", v.nmse}});
  out["recorded_velocity_delay_s"] = s.recorded_delay_s;
  out["effective_stance_mass_kg"] = s.effective_stance_mass_kg;
  out["equivalent_flight_damping_nspm"] = s.equivalent_flight_damping_nspm;
  return out.dump(2) + "\n";
}

}  // namespace furcula::reproduce
