// A model file in memory: a kind of machine, its parameters, what a fit may move, the effects that are on.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "furcula/dynamics/effects/catalogue.hpp"
#include "furcula/dynamics/machines.hpp"

namespace furcula::model {

struct Bounds {
  double lower;
  double upper;
};

/// The clutch of a hopper that has one: dynamics::kClutchParameters.
struct Clutch {
  double release_delay_s = 0.0, catch_delay_s = 0.0, auxiliary_stiffness_npm = 0.0, tooth_pitch_m = 0.0;
};
inline constexpr std::array<double Clutch::*, 4> kClutchMembers{
    &Clutch::release_delay_s, &Clutch::catch_delay_s, &Clutch::auxiliary_stiffness_npm,
    &Clutch::tooth_pitch_m};

struct Model {
  dynamics::Kind kind{};
  std::vector<double> parameters;      ///< in the order of dynamics::info(kind).parameters
  std::optional<Clutch> clutch;        ///< on a hopper that has one
  std::map<std::size_t, Bounds> free;  ///< index of a parameter -> bounds of its fit
  /// Effects switched on, each with its parameters in the order of the catalogue.
  std::map<dynamics::Effect, std::array<double, dynamics::kMaxEffectParameters>> effects;

  double parameter(std::string_view name) const { return parameters[*dynamics::parameter_index(kind, name)]; }
};

/// Whether it has the parameters of a clutch: in its table, or beside it.
inline bool has_clutch(const Model& m) {
  return m.clutch.has_value() || dynamics::has(m.kind, dynamics::LocationType::belt);
}

}  // namespace furcula::model
