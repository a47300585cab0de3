#include "host/diagnose/laws.hpp"

#include "host/machines/rules.hpp"

namespace furcula::diagnose {

using dynamics::Effect;

std::set<Effect> laws_of(const model::Model& model, const EffectSet& effects) {
  const auto is_free = [&](const char* name) {
    const auto index = dynamics::parameter_index(model.kind, name);
    return index && model.free.contains(*index);
  };
  const bool leg = dynamics::has(model.kind, dynamics::LocationType::leg);
  std::set<Effect> laws;
  for (const Effect e : effects) switch (e) {
      case Effect::asymmetric_friction:
        laws.insert({Effect::coulomb_friction, Effect::force_offset});
        break;
      case Effect::guide_tilt:  // on a vertical rail an upward force
        laws.insert(Effect::force_offset);
        break;
      case Effect::height_scale_error:
        // So is a wrong scale in free flight, where the other forces' sizes take it in too, as long as the
        // model holds none.
        laws.insert(machines::rules(model.kind).cut == machines::Cut::flights && model.effects.empty()
                        ? Effect::force_offset
                        : e);
        break;
      case Effect::spring_preload:
        laws.insert(Effect::rest_height_error);
        break;
      case Effect::auxiliary_spring:  // each is another rate of the released leg
        laws.insert(leg ? Effect::incomplete_release : e);
        break;
      case Effect::time_skew:  // an axis has no third channel whose clock would tell which of the two is late
        laws.insert(leg ? e : Effect::actuator_delay);
        break;
      case Effect::encoder_offset:  // of a spring that is linear, a constant torque (gravity's sine is not)
        laws.insert(dynamics::parameter_index(model.kind, "stiffness_nmprad") ? Effect::force_offset : e);
        break;
      case Effect::torque_gain_error:
        // With mass and damping free, a torque gain and a spring rate divided by it are the same equation.
        laws.insert(is_free("mass_kg") && is_free("damping_stance_nspm") && is_free("damping_flight_nspm")
                        ? Effect::stiffness_error
                        : e);
        break;
      default:
        laws.insert(e);
    }
  return laws;
}

bool always_same(const model::Model& model, const EffectSet& a, const EffectSet& b) {
  return laws_of(model, a) == laws_of(model, b);
}

bool stands_for_a_member(const model::Model& model, const EffectSet& members, Effect e) {
  return std::any_of(members.begin(), members.end(), [&](Effect m) { return always_same(model, {m}, {e}); });
}

bool names_twice(const model::Model& model, const EffectSet& effects) {
  return std::any_of(effects.begin(), effects.end(),
                     [&](Effect e) { return stands_for_a_member(model, without(effects, e), e); });
}

std::vector<EffectSet> in_other_names(const model::Model& model, const EffectSet& effects,
                                      const EffectSet& usable) {
  std::vector<EffectSet> all;
  const auto laws = laws_of(model, effects);
  const auto add = [&](EffectSet set) {
    if (set.size() <= effects.size() + 1 && parameters_of(set) <= parameters_of(effects) &&
        laws_of(model, set) == laws && std::find(all.begin(), all.end(), set) == all.end())
      all.push_back(std::move(set));
  };
  const auto may = [&](Effect e) { return holds(usable, e) && !holds(effects, e); };
  for (const Effect e : effects)
    for (const Effect other : usable)
      if (may(other)) add(with(without(effects, e), other));
  if (holds(effects, Effect::asymmetric_friction) && may(Effect::coulomb_friction) &&
      may(Effect::force_offset))
    add(with(with(without(effects, Effect::asymmetric_friction), Effect::coulomb_friction),
             Effect::force_offset));
  if (holds(effects, Effect::coulomb_friction) && may(Effect::asymmetric_friction))
    for (const Effect pull : effects)
      if (pull != Effect::coulomb_friction)
        add(with(without(without(effects, Effect::coulomb_friction), pull), Effect::asymmetric_friction));
  return all;
}

std::optional<std::array<double, dynamics::kMaxEffectParameters>> in_other_words(const model::Model& fitted,
                                                                                 Effect e, Effect other) {
  if (!fitted.clutch || !dynamics::needs_clutch(e) || !dynamics::needs_clutch(other)) return std::nullopt;
  const auto wrong = fitted.effects.find(Effect::stiffness_error);
  const double k = wrong == fitted.effects.end() ? fitted.parameter("stiffness_npm") : wrong->second[0];
  const auto released = [&](double auxiliary) { return k * auxiliary / (k + auxiliary); };
  const double modelled = released(fitted.clutch->auxiliary_stiffness_npm);
  const double value = fitted.effects.at(e)[0];
  if (other == Effect::incomplete_release)
    return {{std::clamp((released(value) - modelled) / (k - modelled), 0.0, 1.0)}};
  const double rate = modelled + value * (k - modelled);
  return {{k * rate / std::max(k - rate, 1e-6 * k)}};
}

}  // namespace furcula::diagnose
