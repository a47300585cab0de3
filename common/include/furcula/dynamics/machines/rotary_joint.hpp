// A rotary joint under gravity, with a motor: a driven pendulum.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class Parameters, class T>
class Axis;  // furcula/dynamics/axis.hpp

// In the order of the members of RotaryJointParameters.
inline constexpr std::array<ParameterInfo, 3> kRotaryJointParameters{{
    {"inertia_kgm2", "kg m^2", 1e-9, 1e4, "inertia about the joint, the rotor's included"},
    {"gravity_torque_nm", "N m", -1e4, 1e4,
     "m g l: torque = gravity_torque sin(angle), angle 0 hanging down"},
    {"damping_nmspr", "N m s/rad", 0.0, 1e4, "viscous friction"},
}};

template <class T>
struct RotaryJointParameters {
  T inertia_kgm2{}, gravity_torque_nm{}, damping_nmspr{};

  using Self = RotaryJointParameters;
  static constexpr std::array<T Self::*, 3> kMembers{&Self::inertia_kgm2, &Self::gravity_torque_nm,
                                                     &Self::damping_nmspr};
  static_assert(kMembers.size() == kRotaryJointParameters.size());
};

namespace machines {

struct RotaryJoint {
  static constexpr MachineInfo kInfo{.name = "rotary_joint",
                                     .rig = "rotary_joint",
                                     .parameters = kRotaryJointParameters,
                                     .seats = Seat::axis | Seat::drive | Seat::motor | Seat::swing,
                                     .rotary = true};
  template <class T>
  using Parameters = RotaryJointParameters<T>;
  template <class T>
  using Plant = Axis<Parameters<T>, T>;
  static const furcula::machines::Rules& rules();  ///< host/machines/rotary_joint.cpp
};

}  // namespace machines
}  // namespace furcula::dynamics
