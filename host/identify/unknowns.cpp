#include "host/identify/unknowns.hpp"

#include <cmath>
#include <string>

#include "host/core/error.hpp"

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

std::optional<std::size_t> parameter_meant(dynamics::Kind kind, const dynamics::EffectParameterInfo& p) {
  if (!std::isnan(p.neutral)) return std::nullopt;
  return dynamics::parameter_index(kind, p.model_parameter.empty() ? name_on(p, kind) : p.model_parameter);
}

std::optional<double> neutral_value(const model::Model& model, const dynamics::EffectParameterInfo& p) {
  if (!std::isnan(p.neutral)) return p.neutral;
  if (p.added_on_leg && dynamics::has(model.kind, dynamics::LocationType::leg)) return 0.0;
  if (const auto meant = parameter_meant(model.kind, p)) return model.parameters[*meant];
  if (model.clutch)
    for (std::size_t i = 0; i < model::kClutchMembers.size(); ++i)
      if (dynamics::kClutchParameters[i].name == p.model_parameter)
        return (*model.clutch).*model::kClutchMembers[i];
  return std::nullopt;
}

std::optional<Jumps> jumps(const Unknown& unknown, dynamics::Kind kind) {
  using dynamics::Effect;
  constexpr double kLongestCatch_s = 0.15;
  const bool late = unknown.of_effect && unknown.effect == Effect::late_catch;
  const bool delay =
      !unknown.of_effect && unknown.parameter == dynamics::parameter_index(kind, "catch_delay_s");
  if (late || delay)
    return Jumps{unknown.lower, std::max(unknown.lower, std::min(unknown.upper, kLongestCatch_s)), false};
  if (unknown.of_effect && unknown.effect == Effect::clutch_slip)
    return Jumps{std::max(unknown.lower, 1.0), std::min(unknown.upper, 300.0), true};
  if (!unknown.of_effect && unknown.parameter == dynamics::parameter_index(kind, "tooth_pitch_m"))
    return Jumps{unknown.lower, unknown.upper, true};
  return std::nullopt;
}

void require_room(const std::vector<Unknown>& unknowns) {
  if (unknowns.size() > kMostUnknowns)
    throw core::DataError("the fit: " + std::to_string(unknowns.size()) +
                          " free parameters, those of effects included; expected at most " +
                          std::to_string(kMostUnknowns));
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
    values.push_back(neutral_value(model, p).value_or(0.0));
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
