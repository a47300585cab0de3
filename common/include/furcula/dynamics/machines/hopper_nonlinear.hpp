// The hopper whose links have an inertia.
#pragma once

#include "furcula/dynamics/machines/hopper_linear.hpp"
#include "furcula/dynamics/members.hpp"

namespace furcula::dynamics {

// In the order of the members of HopperNonlinearParameters: those of the linear hopper, then the links'.
inline constexpr std::array<ParameterInfo, 13> kHopperNonlinearParameters{{
    kHopperLinearParameters[0],
    kHopperLinearParameters[1],
    kHopperLinearParameters[2],
    kHopperLinearParameters[3],
    kHopperLinearParameters[4],
    {"restitution_touchdown", "", 0.0, 1.5, "speeds after touch-down over what the plastic impact leaves"},
    {"restitution_liftoff", "", 0.0, 1.5, "speeds after lift-off over what the leg's stop leaves"},
    kHopperLinearParameters[7],
    kHopperLinearParameters[8],
    kHopperLinearParameters[9],
    {"inertia_a_kgm2", "kg m^2", 0.0, 10.0, "links: sum I + m_L (r_L^2 + L^2) + m_U r_U^2"},
    {"inertia_b_kgm", "kg m", 0.0, 10.0, "links: sum m_L r_L"},
    {"inertia_e_kgm", "kg m", 0.0, 10.0, "links: sum m_L (r_L + L) + m_U r_U"},
}};

template <class T>
struct HopperNonlinearParameters : HopperLinearParameters<T> {
  T inertia_a_kgm2{}, inertia_b_kgm{}, inertia_e_kgm{};

  using Self = HopperNonlinearParameters;
  static constexpr auto kMembers =
      joined(HopperLinearParameters<T>::kMembers,
             std::array<T Self::*, 3>{&Self::inertia_a_kgm2, &Self::inertia_b_kgm, &Self::inertia_e_kgm});
  static_assert(kMembers.size() == kHopperNonlinearParameters.size());
};

namespace machines {

struct HopperNonlinear {
  static constexpr MachineInfo kInfo{
      .name = "hopper_nonlinear",
      .rig = "hopper",
      .parameters = kHopperNonlinearParameters,
      .seats = Seat::axis | Seat::rail | Seat::drive | Seat::motor | Seat::leg | Seat::heavy_links};
  template <class T>
  using Parameters = HopperNonlinearParameters<T>;
  template <class T>
  using Plant = Hopper<T>;
  static const furcula::machines::Rules& rules();  ///< host/machines/hopper.cpp
};

}  // namespace machines
}  // namespace furcula::dynamics
