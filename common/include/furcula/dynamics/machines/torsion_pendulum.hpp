// A rotary joint on a torsion spring, with a motor and no gravity.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class Parameters, class T>
class Axis;  // furcula/dynamics/axis.hpp

/// Name, unit, lower and upper bound and meaning of each parameter, in the order of the members of TorsionPendulumParameters.
inline constexpr std::array<ParameterInfo, 3> kTorsionPendulumParameters{{
    {"inertia_kgm2", "kg m^2", 1e-9, 1e4, "inertia about the joint, the rotor's included"},
    {"stiffness_nmprad", "N m/rad", 0.0, 1e6, "torsion spring, relaxed at the angle 0"},
    {"damping_nmspr", "N m s/rad", 0.0, 1e4, "viscous friction"},
}};

/// Parameters of the pendulum.
template <class T>
struct TorsionPendulumParameters {
  T inertia_kgm2{},        ///< about the joint, including the rotor
      stiffness_nmprad{},  ///< of the torsion spring, relaxed at angle 0
      damping_nmspr{};     ///< viscous friction

  using Self = TorsionPendulumParameters;  ///< this struct
  /// Pointers to the members, in the order of the table of parameters.
  static constexpr std::array<T Self::*, 3> kMembers{&Self::inertia_kgm2, &Self::stiffness_nmprad,
                                                     &Self::damping_nmspr};
  static_assert(kMembers.size() == kTorsionPendulumParameters.size());
};

namespace machines {

/// A driven joint on a torsion spring, without gravity.
struct TorsionPendulum {
  /// Names, parameters and location types.
  static constexpr MachineInfo kInfo{
      .name = "torsion_pendulum",
      .rig = "rotary_joint",
      .parameters = kTorsionPendulumParameters,
      .location_types = LocationType::axis | LocationType::drive | LocationType::motor | LocationType::swing,
      .rotary = true};
  /// Its parameters in scalar T.
  template <class T>
  using Parameters = TorsionPendulumParameters<T>;
  /// Its plant in scalar T, with all effects that apply to it.
  template <class T>
  using Plant = Axis<Parameters<T>, T>;
  /// Rules for the host, defined in host/machines/torsion_pendulum.cpp.
  static const furcula::machines::Rules& rules();
};

}  // namespace machines
}  // namespace furcula::dynamics
