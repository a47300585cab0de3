// A body on a leg with a virtual spring; the links have no inertia, and the leg is straight in flight.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class T>
class Hopper;  // furcula/dynamics/hopper.hpp

/// Name, unit, lower and upper bound and meaning of each parameter, in the order of the members of HopperLinearParameters.
inline constexpr std::array<ParameterInfo, 10> kHopperLinearParameters{{
    {"mass_kg", "kg", 1e-3, 1e3, "mass of body and leg"},
    {"stiffness_npm", "N/m", 0.0, 1e6, "virtual spring between hip and toe"},
    {"rest_height_m", "m", 1e-3, 10.0, "height at which the spring is relaxed"},
    {"damping_stance_nspm", "N s/m", 0.0, 1e4, "viscous damping in stance, guide and leg together"},
    {"damping_flight_nspm", "N s/m", 0.0, 1e4, "viscous damping of the guide, in both phases"},
    {"restitution_touchdown", "", 0.0, 1.5, "velocity after touch-down over velocity before"},
    {"restitution_liftoff", "", 0.0, 1.5, "velocity after lift-off over velocity before"},
    {"link_length_m", "m", 1e-3, 5.0, "length of each of the four links"},
    {"touchdown_angle_rad", "rad", 0.0, 1.5, "leg angle from the vertical on the leg's stop"},
    {"gravity_mps2", "m/s^2", 0.0, 30.0, "gravity"},
}};

/// Parameters of the linear hopper.
template <class T>
struct HopperLinearParameters {
  T mass_kg{},                ///< of body and leg
      stiffness_npm{},        ///< of the virtual spring between hip and toe
      rest_height_m{},        ///< height at which the spring is relaxed
      damping_stance_nspm{},  ///< viscous in stance, guide and leg together
      damping_flight_nspm{};  ///< viscous of the guide, in both phases
  T restitution_touchdown{},  ///< velocity after touch-down over velocity before
      restitution_liftoff{},  ///< velocity after lift-off over velocity before
      link_length_m{},        ///< of each of the four links
      touchdown_angle_rad{},  ///< leg angle from the vertical on the leg's stop
      gravity_mps2{};         ///< magnitude

  using Self = HopperLinearParameters;  ///< this struct
  /// Pointers to the members, in the order of the table of parameters.
  static constexpr std::array<T Self::*, 10> kMembers{&Self::mass_kg,
                                                      &Self::stiffness_npm,
                                                      &Self::rest_height_m,
                                                      &Self::damping_stance_nspm,
                                                      &Self::damping_flight_nspm,
                                                      &Self::restitution_touchdown,
                                                      &Self::restitution_liftoff,
                                                      &Self::link_length_m,
                                                      &Self::touchdown_angle_rad,
                                                      &Self::gravity_mps2};
  static_assert(kMembers.size() == kHopperLinearParameters.size());
};

/// Parameters of a hopper's clutch, beside the hopper's table; without a clutch they are all 0, or absent.
inline constexpr std::array<ParameterInfo, 4> kClutchParameters{{
    {"release_delay_s", "s", 0.0, 1.0, "from the coil's switching on until the belt is free"},
    {"catch_delay_s", "s", 0.0, 1.0, "from its switching off until the belt is held"},
    {"auxiliary_stiffness_npm", "N/m", 0.0, 1e4, "auxiliary spring, as seen along the leg"},
    {"tooth_pitch_m", "m", 0.0, 0.1, "of the belt, as seen along the leg; 0: no clutch"},
}};

/// Parameters of a hopper's clutch.
template <class T>
struct HopperClutchParameters {
  T release_delay_s{},            ///< from switching the coil on until the belt is free
      catch_delay_s{},            ///< from switching it off until the belt is held
      auxiliary_stiffness_npm{},  ///< of the auxiliary spring, along the leg
      tooth_pitch_m{};            ///< of the belt, along the leg; 0: no clutch
};

namespace machines {

/// The hopper with massless links.
struct HopperLinear {
  /// Names, parameters and location types.
  static constexpr MachineInfo kInfo{.name = "hopper_linear",
                                     .rig = "hopper",
                                     .parameters = kHopperLinearParameters,
                                     .location_types = LocationType::axis | LocationType::rail |
                                                       LocationType::drive | LocationType::motor |
                                                       LocationType::leg | LocationType::light_leg};
  /// Its parameters in scalar T.
  template <class T>
  using Parameters = HopperLinearParameters<T>;
  /// Its plant in scalar T, with all effects that apply to it.
  template <class T>
  using Plant = Hopper<T>;
  /// Rules for the host, defined in host/machines/hopper.cpp.
  static const furcula::machines::Rules& rules();
};

}  // namespace machines
}  // namespace furcula::dynamics
