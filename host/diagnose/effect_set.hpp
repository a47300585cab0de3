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

/// Two effects of one parameter each that are one law under two names, on some kind of machine
/// (docs/contracts.md, section 3; on which kinds whatever the recordings, always_same() in laws.hpp knows).
inline bool twins(dynamics::Effect a, dynamics::Effect b) {
  using dynamics::Effect;
  const auto are = [&](Effect one, Effect other) {
    return (a == one && b == other) || (a == other && b == one);
  };
  return are(Effect::force_offset, Effect::guide_tilt) ||
         are(Effect::rest_height_error, Effect::spring_preload) ||
         are(Effect::actuator_delay, Effect::time_skew) ||
         are(Effect::force_offset, Effect::encoder_offset) ||
         are(Effect::incomplete_release, Effect::auxiliary_spring);
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
