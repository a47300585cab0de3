// Which sets of effects are one law under several names, whatever the recordings (docs/contracts.md, section 3).
#pragma once

#include <array>
#include <optional>
#include <set>
#include <vector>

#include "host/diagnose/effect_set.hpp"
#include "host/model/model.hpp"

namespace furcula::diagnose {

/// The same for two sets that are one law: each name's first one, and of a friction of two sizes the friction
/// and the constant force that it is made of.
std::set<dynamics::Effect> laws_of(const model::Model& model, const EffectSet& effects);

bool always_same(const model::Model& model, const EffectSet& a, const EffectSet& b);

/// Whether a set holds an effect, or its law under another name.
bool stands_for_a_member(const model::Model& model, const EffectSet& members, dynamics::Effect e);
/// Whether a set holds one law under two names.
bool names_twice(const model::Model& model, const EffectSet& effects);

/// The set in other words that need no more parameters, each with effects of `usable` in the place of one
/// member, or of a friction and a constant force.
std::vector<EffectSet> in_other_names(const model::Model& model, const EffectSet& effects,
                                      const EffectSet& usable);

/// The values of `other` that make of the fitted model what its effect `e` makes of it, where that has a
/// closed form: both are the rate of a released leg, k k_aux / (k + k_aux) or more (dynamics/hopper.hpp).
std::optional<std::array<double, dynamics::kMaxEffectParameters>> in_other_words(const model::Model& fitted,
                                                                                 dynamics::Effect e,
                                                                                 dynamics::Effect other);

}  // namespace furcula::diagnose
