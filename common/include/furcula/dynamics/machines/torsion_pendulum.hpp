// A rotary joint on a torsion spring, with a motor and no gravity.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class Parameters, class T>
class Axis;  // furcula/dynamics/axis.hpp

// In the order of the members of TorsionPendulumParameters.
inline constexpr std::array<ParameterInfo, 3> kTorsionPendulumParameters{{
    {"inertia_kgm2", "kg m^2", 1e-9, 1e4, "inertia about the joint, the rotor's included"},
    {"stiffness_nmprad", "N m/rad", 0.0, 1e6, "torsion spring, relaxed at the angle 0"},
    {"damping_nmspr", "N m s/rad", 0.0, 1e4, "viscous friction"},
}};

template <class T>
struct TorsionPendulumParameters {
  T inertia_kgm2{}, stiffness_nmprad{}, damping_nmspr{};

  using Self = TorsionPendulumParameters;
  static constexpr std::array<T Self::*, 3> kMembers{&Self::inertia_kgm2, &Self::stiffness_nmprad,
                                                     &Self::damping_nmspr};
  static_assert(kMembers.size() == kTorsionPendulumParameters.size());
};

namespace machines {

struct TorsionPendulum {
  static constexpr MachineInfo kInfo{.name = "torsion_pendulum",
                                     .rig = "rotary_joint",
                                     .parameters = kTorsionPendulumParameters,
                                     .seats = Seat::axis | Seat::drive | Seat::motor | Seat::swing,
                                     .rotary = true};
  template <class T>
  using Parameters = TorsionPendulumParameters<T>;
  template <class T>
  using Plant = Axis<Parameters<T>, T>;
  static const furcula::machines::Rules& rules();  ///< host/machines/torsion_pendulum.cpp
};

}  // namespace machines
}  // namespace furcula::dynamics
