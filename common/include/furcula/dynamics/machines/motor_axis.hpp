// A linear axis that a motor drives: a mass with viscous friction.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class Parameters, class T>
class Axis;  // furcula/dynamics/axis.hpp

// In the order of the members of MotorAxisParameters.
inline constexpr std::array<ParameterInfo, 2> kMotorAxisParameters{{
    {"mass_kg", "kg", 1e-6, 1e6, "moving mass, the motor's inertia included"},
    {"damping_nspm", "N s/m", 0.0, 1e6, "viscous friction"},
}};

template <class T>
struct MotorAxisParameters {
  T mass_kg{}, damping_nspm{};

  using Self = MotorAxisParameters;
  static constexpr std::array<T Self::*, 2> kMembers{&Self::mass_kg, &Self::damping_nspm};
  static_assert(kMembers.size() == kMotorAxisParameters.size());
};

namespace machines {

struct MotorAxis {
  static constexpr MachineInfo kInfo{.name = "motor_axis",
                                     .rig = "motor_axis",
                                     .parameters = kMotorAxisParameters,
                                     .seats = Seat::axis | Seat::drive};
  template <class T>
  using Parameters = MotorAxisParameters<T>;
  template <class T>
  using Plant = Axis<Parameters<T>, T>;
  static const furcula::machines::Rules& rules();  ///< host/machines/motor_axis.cpp
};

}  // namespace machines
}  // namespace furcula::dynamics
