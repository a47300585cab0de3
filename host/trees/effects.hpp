// The causes that a robot of several joints can have: each a law of the catalogue at a location.
//
// Laws that machines of one joint have too keep their names and their words (effects/catalogue.hpp).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace furcula::trees {

/// The sort of a site: drives, encoders and springs go by their joint's name; `base` and `log` are the only sites of their location types.
enum class LocationType : std::uint8_t { joint, drive, encoder, link, base, log, spring };

/// In the order in which causes are named where the data cannot tell them apart.
enum class Effect : std::uint8_t {
  coulomb_friction,
  stribeck_friction,
  asymmetric_friction,
  quadratic_drag,
  binding_spot,
  damping_error,
  load_friction,
  force_offset,
  mass_error,
  com_error,
  inertia_error,
  payload,
  base_tilt,
  rotor_inertia_error,
  torque_gain_error,
  position_gain_error,
  actuator_delay,
  actuator_lag,
  torque_saturation,
  torque_ripple,
  joint_elasticity,
  encoder_offset,
  time_skew,
  spring_rate_error,
  latch_delay,
  latch_offset,
  second_spring,
  length_error,
};

struct Parameter {
  std::string_view name, unit;                ///< on a revolute joint, a link or the base
  std::string_view linear_name, linear_unit;  ///< on a prismatic joint
  double lower, upper;                        ///< of a model file
};

inline constexpr std::size_t kMostParameters = 4;

struct EffectInfo {
  Effect effect;
  std::string_view name, label;
  LocationType location_type;
  std::string_view law;
  std::array<Parameter, kMostParameters> all_parameters;
  std::size_t parameter_count;
  std::string_view explanation, where_to_look, experiment;

  constexpr std::span<const Parameter> parameters() const { return {all_parameters.data(), parameter_count}; }
};

/// All of them, in the order of Effect.
std::span<const EffectInfo> catalogue();
const EffectInfo& info(Effect effect);
std::optional<Effect> effect_named(std::string_view name);
std::string_view name(LocationType location_type);
/// Laws that published identifications of drives nearly always have: dry and viscous friction, the rotor's inertia, a late command (Swevers,
/// Verdonck, De Schutter, IEEE Control Systems 27(5), 2007; Lee et al., Science Robotics 5, eabc5986, 2020).
constexpr bool is_common(Effect e) {
  return e == Effect::coulomb_friction || e == Effect::damping_error || e == Effect::rotor_inertia_error ||
         e == Effect::actuator_delay;
}
/// Whether its sites are joints, or parts of them.
constexpr bool is_of_joints(LocationType location_type) {
  return location_type == LocationType::joint || location_type == LocationType::drive ||
         location_type == LocationType::encoder || location_type == LocationType::spring;
}

inline std::string_view name_on(const Parameter& p, bool prismatic) {
  return prismatic ? p.linear_name : p.name;
}
inline std::string_view unit_on(const Parameter& p, bool prismatic) {
  return prismatic ? p.linear_unit : p.unit;
}

}  // namespace furcula::trees
