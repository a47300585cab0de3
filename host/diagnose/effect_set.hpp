// Sets of effects, in the order of the catalogue.
#pragma once

#include <algorithm>
#include <vector>

#include "furcula/dynamics/effects/catalogue.hpp"

namespace furcula::diagnose {

using EffectSet = std::vector<dynamics::Effect>;

inline bool holds(const EffectSet& effects, dynamics::Effect e) {
  return std::find(effects.begin(), effects.end(), e) != effects.end();
}

inline EffectSet with(EffectSet effects, dynamics::Effect more) {
  effects.push_back(more);
  std::sort(effects.begin(), effects.end());
  return effects;
}

inline EffectSet without(EffectSet effects, dynamics::Effect less) {
  effects.erase(std::remove(effects.begin(), effects.end(), less), effects.end());
  return effects;
}

/// True if `larger` with some values of its parameters is `smaller`: then it takes its place rather than
/// stand beside it.
inline bool contains(dynamics::Effect larger, dynamics::Effect smaller) {
  using dynamics::Effect;
  return smaller == Effect::coulomb_friction &&
         (larger == Effect::stribeck_friction || larger == Effect::asymmetric_friction);
}

/// The set with one effect more, less what that effect contains.
inline EffectSet extended(EffectSet effects, dynamics::Effect more) {
  effects.erase(
      std::remove_if(effects.begin(), effects.end(), [&](dynamics::Effect e) { return contains(more, e); }),
      effects.end());
  return with(std::move(effects), more);
}

inline std::size_t parameters_of(const EffectSet& effects) {
  std::size_t count = 0;
  for (const dynamics::Effect e : effects) count += dynamics::info(e).parameter_count;
  return count;
}

}  // namespace furcula::diagnose
