// A body on a leg with a virtual spring; the links have no inertia, and the leg is straight in flight.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class T>
class Hopper;  // furcula/dynamics/hopper.hpp

// In the order of the members of HopperLinearParameters.
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

template <class T>
struct HopperLinearParameters {
  T mass_kg{}, stiffness_npm{}, rest_height_m{}, damping_stance_nspm{}, damping_flight_nspm{};
  T restitution_touchdown{}, restitution_liftoff{}, link_length_m{}, touchdown_angle_rad{}, gravity_mps2{};

  using Self = HopperLinearParameters;
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

// Of a hopper that has a clutch, beside its table; without one they are all 0, or not there.
inline constexpr std::array<ParameterInfo, 4> kClutchParameters{{
    {"release_delay_s", "s", 0.0, 1.0, "from the coil's switching on until the belt is free"},
    {"catch_delay_s", "s", 0.0, 1.0, "from its switching off until the belt is held"},
    {"auxiliary_stiffness_npm", "N/m", 0.0, 1e4, "auxiliary spring, as seen along the leg"},
    {"tooth_pitch_m", "m", 0.0, 0.1, "of the belt, as seen along the leg; 0: no clutch"},
}};

/// Its pitch is 0 where there is none.
template <class T>
struct HopperClutchParameters {
  T release_delay_s{}, catch_delay_s{}, auxiliary_stiffness_npm{}, tooth_pitch_m{};
};

namespace machines {

struct HopperLinear {
  static constexpr MachineInfo kInfo{
      .name = "hopper_linear",
      .rig = "hopper",
      .parameters = kHopperLinearParameters,
      .seats = Seat::axis | Seat::rail | Seat::drive | Seat::motor | Seat::leg | Seat::light_leg};
  template <class T>
  using Parameters = HopperLinearParameters<T>;
  template <class T>
  using Plant = Hopper<T>;
  static const furcula::machines::Rules& rules();  ///< host/machines/hopper.cpp
};

}  // namespace machines
}  // namespace furcula::dynamics
