// A linear axis that a motor drives: a mass with viscous friction.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class Parameters, class T>
class Axis;  // furcula/dynamics/axis.hpp

/// Name, unit, lower and upper bound and meaning of each parameter, in the order of the members of MotorAxisParameters.
inline constexpr std::array<ParameterInfo, 2> kMotorAxisParameters{{
    {"mass_kg", "kg", 1e-6, 1e6, "moving mass, the motor's inertia included"},
    {"damping_nspm", "N s/m", 0.0, 1e6, "viscous friction"},
}};

/// Parameters of the motor axis.
template <class T>
struct MotorAxisParameters {
  T mass_kg{},         ///< moving mass, including the motor's inertia
      damping_nspm{};  ///< viscous friction

  using Self = MotorAxisParameters;  ///< this struct
  /// Pointers to the members, in the order of the table of parameters.
  static constexpr std::array<T Self::*, 2> kMembers{&Self::mass_kg, &Self::damping_nspm};
  static_assert(kMembers.size() == kMotorAxisParameters.size());
};

namespace machines {

/// A linear axis with a drive.
struct MotorAxis {
  /// Names, parameters and location types.
  static constexpr MachineInfo kInfo{.name = "motor_axis",
                                     .rig = "motor_axis",
                                     .parameters = kMotorAxisParameters,
                                     .location_types = LocationType::axis | LocationType::drive};
  /// Its parameters in scalar T.
  template <class T>
  using Parameters = MotorAxisParameters<T>;
  /// Its plant in scalar T, with all effects that apply to it.
  template <class T>
  using Plant = Axis<Parameters<T>, T>;
  /// Rules for the host, defined in host/machines/motor_axis.cpp.
  static const furcula::machines::Rules& rules();
};

}  // namespace machines
}  // namespace furcula::dynamics
