// The release/catch bench of document 002, section 5.1: a weight on the clutch's belt, an encoder on the pulley.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class T>
class SimpleClutchBench;  // furcula/dynamics/simple_clutch_bench.hpp

/// Gravity of the bench's model, which has no such parameter, m/s^2.
inline constexpr double kBenchGravity_mps2 = 9.81;

/// Name, unit, lower and upper bound and meaning of each parameter, in the order of the members of ClutchBenchParameters.
inline constexpr std::array<ParameterInfo, 9> kClutchBenchParameters{{
    {"load_mass_kg", "kg", 1e-3, 1e3, "weight that hangs on the belt"},
    {"pulley_radius_m", "m", 1e-4, 1.0, "of the belt on the pulley"},
    {"pulley_inertia_kgm2", "kg m^2", 0.0, 10.0, "of pulley and encoder"},
    {"damping_nmspr", "N m s/rad", 0.0, 1e3, "viscous friction, about the pulley"},
    {"auxiliary_stiffness_npm", "N/m", 0.0, 1e4, "auxiliary spring on the belt, slack at the angle 0"},
    {"tooth_pitch_m", "m", 1e-4, 0.1, "of the belt"},
    {"tooth_height_m", "m", 0.0, 0.1, "way of the key; its times are in the delays"},
    {"release_delay_s", "s", 0.0, 1.0, "from the coil's switching on until the belt is free"},
    {"catch_delay_s", "s", 0.0, 1.0, "from its switching off until the key presses on the belt"},
}};

/// Parameters of the bench.
template <class T>
struct ClutchBenchParameters {
  T load_mass_kg{},               ///< of the weight on the belt
      pulley_radius_m{},          ///< of the belt on the pulley
      pulley_inertia_kgm2{},      ///< of pulley and encoder
      damping_nmspr{},            ///< viscous friction, about the pulley
      auxiliary_stiffness_npm{};  ///< of the auxiliary spring on the belt, slack at angle 0
  T tooth_pitch_m{},              ///< of the belt
      tooth_height_m{},           ///< stroke of the key; its times are in the delays
      release_delay_s{},          ///< from switching the coil on until the belt is free
      catch_delay_s{};            ///< from switching it off until the key presses on the belt

  using Self = ClutchBenchParameters;  ///< this struct
  /// Pointers to the members, in the order of the table of parameters.
  static constexpr std::array<T Self::*, 9> kMembers{
      &Self::load_mass_kg,   &Self::pulley_radius_m,         &Self::pulley_inertia_kgm2,
      &Self::damping_nmspr,  &Self::auxiliary_stiffness_npm, &Self::tooth_pitch_m,
      &Self::tooth_height_m, &Self::release_delay_s,         &Self::catch_delay_s};
  static_assert(kMembers.size() == kClutchBenchParameters.size());
};

namespace machines {

/// The release/catch bench.
struct ClutchBench {
  /// Names, parameters and location types.
  static constexpr MachineInfo kInfo{.name = "clutch_bench",
                                     .rig = "clutch_bench",
                                     .parameters = kClutchBenchParameters,
                                     .location_types = LocationType::belt,
                                     .rotary = true};
  /// Its parameters in scalar T.
  template <class T>
  using Parameters = ClutchBenchParameters<T>;
  /// Its plant in scalar T, with all effects that apply to it.
  template <class T>
  using Plant = SimpleClutchBench<T>;
  /// Rules for the host, defined in host/machines/clutch_bench.cpp.
  static const furcula::machines::Rules& rules();
};

}  // namespace machines
}  // namespace furcula::dynamics
