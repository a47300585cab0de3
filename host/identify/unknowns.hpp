// What a fit moves: parameters of the model and of effects, in one vector.
#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "furcula/dynamics/effects/effects.hpp"
#include "furcula/dynamics/machines.hpp"
#include "host/model/model.hpp"

namespace furcula::identify {

/// The links' inertias (a, b, e of leg_inertia) are fitted as p, q, r >= 0 with a = L (q + 2 r), b = r,
/// e = p + q + 2 r: all that links can have, and nothing else (docs/physics.md, what links can have). Takes
/// the one for the other, in place.
template <class T>
void links_to_law(std::array<T, 3>& of, double length_m) {
  const T p = of[0], q = of[1], r = of[2];
  of = {(q + 2.0 * r) * length_m, r, p + q + 2.0 * r};
}
inline void links_from_law(std::array<double, 3>& of, double length_m) {
  const auto [a, b, e] = of;
  of = {e - a / length_m, a / length_m - 2.0 * b, b};
}

/// An effect's parameters as they are fitted, from the law's; the links' are not the same.
std::array<double, 3> fitted_from_law(dynamics::Effect effect, std::array<double, 3> law,
                                      const model::Model& model);
std::array<double, 3> law_from_fitted(dynamics::Effect effect, std::array<double, 3> fitted,
                                      const model::Model& model);

/// One entry of the vector of unknowns. Those of leg_inertia, by its parameters' names, are p, q and r.
struct Unknown {
  bool of_effect = false;
  dynamics::Effect effect{};  ///< where of_effect
  std::size_t parameter = 0;  ///< index in the kind's table, or in the effect's
  std::string name;           ///< "mass_kg", "coulomb_friction.force_n"
  std::string unit;
  double lower = 0.0;
  double upper = 0.0;
};

/// The model's free parameters.
std::vector<Unknown> free_unknowns(const model::Model& model);

/// The parameters of an effect, with the bounds of the catalogue; none of encoder_slip, which is an event of
/// each recording (Recording::slips).
std::vector<Unknown> effect_unknowns(dynamics::Effect effect, dynamics::Kind kind);

/// The value of an effect's parameter with which the effect is not there; nothing where it is any.
std::optional<double> neutral_value(const model::Model& model, const dynamics::EffectParameterInfo& p);

/// The index of the free parameter whose true value the effect's parameter is; nothing where there is none.
std::optional<std::size_t> parameter_meant(dynamics::Kind kind, const dynamics::EffectParameterInfo& p);

/// The range in which a fit looks for an unknown value by value, since the runs jump with it: which tooth a
/// catch ends on. Nothing for all others.
struct Jumps {
  double lower, upper;
  bool by_ratio;  ///< the values looked at are a ratio apart, not a distance
};
std::optional<Jumps> jumps(const Unknown& unknown, dynamics::Kind kind);

/// The values of the unknowns in a model (of an effect that is off: its neutral value, 0 where it has none).
std::vector<double> values_in(const model::Model& model, const std::vector<Unknown>& unknowns);

/// The model with the unknowns at these values; effects among them are switched on.
model::Model with_values(model::Model model, const std::vector<Unknown>& unknowns,
                         const std::vector<double>& values);

/// The most that a kind's table has.
inline constexpr std::size_t kMostParameters = [] {
  std::size_t most = 0;
  for (const dynamics::MachineInfo& kind : dynamics::kMachines) most = std::max(most, kind.parameters.size());
  return most;
}();

/// The most that a fit can move: its numbers carry derivatives by as many, and by a start state's two.
inline constexpr std::size_t kMostUnknowns = 30;
/// All of a kind's parameters, and four effects (a diagnosis tries one more for a moment).
static_assert(kMostParameters + 5 * dynamics::kMaxEffectParameters <= kMostUnknowns);

/// @throws core::DataError where there are more.
void require_room(const std::vector<Unknown>& unknowns);

/// A plant's parameters and effects, with the unknowns at `values` (unknowns.size() of them) in the scalar T.
template <class T>
struct PlantSetup {
  std::array<T, kMostParameters> parameters{};
  dynamics::HopperClutchParameters<T> clutch{};  ///< of a hopper that has one
  dynamics::Effects<T> effects;

  PlantSetup(const model::Model& model, const std::vector<Unknown>& unknowns, const T* values) {
    for (std::size_t i = 0; i < model.parameters.size(); ++i) parameters[i] = T(model.parameters[i]);
    if (model.clutch)
      clutch = {T(model.clutch->release_delay_s), T(model.clutch->catch_delay_s),
                T(model.clutch->auxiliary_stiffness_npm), T(model.clutch->tooth_pitch_m)};
    for (const auto& [effect, numbers] : model.effects)
      for (std::size_t k = 0; k < numbers.size(); ++k) effects.set(effect, k, T(numbers[k]));
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      if (unknowns[i].of_effect)
        effects.set(unknowns[i].effect, unknowns[i].parameter, values[i]);
      else
        parameters[unknowns[i].parameter] = values[i];
    }
    constexpr auto kLinks = dynamics::Effect::leg_inertia;
    if (std::any_of(unknowns.begin(), unknowns.end(),
                    [](const Unknown& u) { return u.of_effect && u.effect == kLinks; })) {
      auto links = dynamics::EffectsOf<T, dynamics::Stage::mechanism>(effects).values(kLinks);
      links_to_law(links, model.parameter("link_length_m"));
      effects.set(kLinks, links);
    }
  }
};

}  // namespace furcula::identify
