// A rotary joint under gravity, with a motor: a driven pendulum.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class Parameters, class T>
class Axis;  // furcula/dynamics/axis.hpp

/// Name, unit, lower and upper bound and meaning of each parameter, in the order of the members of RotaryJointParameters.
inline constexpr std::array<ParameterInfo, 3> kRotaryJointParameters{{
    {"inertia_kgm2", "kg m^2", 1e-9, 1e4, "inertia about the joint, the rotor's included"},
    {"gravity_torque_nm", "N m", -1e4, 1e4,
     "m g l: torque = gravity_torque sin(angle), angle 0 hanging down"},
    {"damping_nmspr", "N m s/rad", 0.0, 1e4, "viscous friction"},
}};

/// Parameters of the joint.
template <class T>
struct RotaryJointParameters {
  T inertia_kgm2{},         ///< about the joint, including the rotor
      gravity_torque_nm{},  ///< m g l; load torque gravity_torque sin(angle), angle 0 hanging down
      damping_nmspr{};      ///< viscous friction

  using Self = RotaryJointParameters;  ///< this struct
  /// Pointers to the members, in the order of the table of parameters.
  static constexpr std::array<T Self::*, 3> kMembers{&Self::inertia_kgm2, &Self::gravity_torque_nm,
                                                     &Self::damping_nmspr};
  static_assert(kMembers.size() == kRotaryJointParameters.size());
};

namespace machines {

/// A driven pendulum.
struct RotaryJoint {
  /// Names, parameters and location types.
  static constexpr MachineInfo kInfo{
      .name = "rotary_joint",
      .rig = "rotary_joint",
      .parameters = kRotaryJointParameters,
      .location_types = LocationType::axis | LocationType::drive | LocationType::motor | LocationType::swing,
      .rotary = true};
  /// Its parameters in scalar T.
  template <class T>
  using Parameters = RotaryJointParameters<T>;
  /// Its plant in scalar T, with all effects that apply to it.
  template <class T>
  using Plant = Axis<Parameters<T>, T>;
  /// Rules for the host, defined in host/machines/rotary_joint.cpp.
  static const furcula::machines::Rules& rules();
};

}  // namespace machines
}  // namespace furcula::dynamics
