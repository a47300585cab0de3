#include "host/identify/unknowns.hpp"

#include <cmath>

namespace furcula::identify {

std::array<double, 3> fitted_from_law(dynamics::Effect effect, std::array<double, 3> law,
                                      const model::Model& model) {
  if (effect == dynamics::Effect::leg_inertia) links_from_law(law, model.parameter("link_length_m"));
  return law;
}

std::array<double, 3> law_from_fitted(dynamics::Effect effect, std::array<double, 3> fitted,
                                      const model::Model& model) {
  if (effect == dynamics::Effect::leg_inertia) links_to_law(fitted, model.parameter("link_length_m"));
  return fitted;
}

std::vector<Unknown> free_unknowns(const model::Model& model) {
  std::vector<Unknown> all;
  const auto table = dynamics::info(model.kind).parameters;
  for (const auto& [index, bounds] : model.free)
    all.push_back({false,
                   {},
                   index,
                   std::string(table[index].name),
                   std::string(table[index].unit),
                   bounds.lower,
                   bounds.upper});
  return all;
}

std::vector<Unknown> effect_unknowns(dynamics::Effect effect, dynamics::Kind kind) {
  std::vector<Unknown> all;
  if (effect == dynamics::Effect::encoder_slip) return all;
  const auto& info = dynamics::info(effect);
  for (std::size_t i = 0; i < info.parameter_count; ++i) {
    const auto& p = info.parameter_table[i];
    all.push_back({true, effect, i, std::string(info.name) + "." + std::string(name_on(p, kind)),
                   std::string(unit_on(p, kind)), p.lower, p.upper});
  }
  return all;
}

std::vector<double> values_in(const model::Model& model, const std::vector<Unknown>& unknowns) {
  std::vector<double> values;
  for (const Unknown& u : unknowns) {
    if (!u.of_effect) {
      values.push_back(model.parameters[u.parameter]);
      continue;
    }
    if (const auto on = model.effects.find(u.effect); on != model.effects.end()) {
      values.push_back(fitted_from_law(u.effect, on->second, model)[u.parameter]);
      continue;
    }
    const auto& p = dynamics::info(u.effect).parameter_table[u.parameter];
    const auto same = dynamics::parameter_index(model.kind, name_on(p, model.kind));
    if (!std::isnan(p.neutral))
      values.push_back(p.neutral);
    else
      values.push_back(same ? model.parameters[*same] : 0.0);
  }
  return values;
}

model::Model with_values(model::Model model, const std::vector<Unknown>& unknowns,
                         const std::vector<double>& values) {
  for (std::size_t i = 0; i < unknowns.size(); ++i) {
    if (unknowns[i].of_effect)
      model.effects[unknowns[i].effect][unknowns[i].parameter] = values[i];
    else
      model.parameters[unknowns[i].parameter] = values[i];
  }
  for (const Unknown& u : unknowns)
    if (u.of_effect && u.parameter == 0)
      model.effects[u.effect] = law_from_fitted(u.effect, model.effects[u.effect], model);
  return model;
}

}  // namespace furcula::identify
