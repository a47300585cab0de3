// The hopper whose links have inertia.
#pragma once

#include "furcula/dynamics/machines/hopper_linear.hpp"
#include "furcula/dynamics/members.hpp"

namespace furcula::dynamics {

/// Name, unit, bounds and meaning of each parameter, in the order of HopperNonlinearParameters::kMembers: those of the linear
/// hopper, then the links'.
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

/// Parameters of the hopper with link inertia (docs/physics.md). The restitutions of the base multiply the velocities after the
/// plastic impacts at touch-down and on the leg's stop.
template <class T>
struct HopperNonlinearParameters : HopperLinearParameters<T> {
  T inertia_a_kgm2{},   ///< a = sum I + m_L (r_L^2 + L^2) + m_U r_U^2; L, U: lower and upper links
      inertia_b_kgm{},  ///< b = sum m_L r_L
      inertia_e_kgm{};  ///< e = sum m_L (r_L + L) + m_U r_U

  using Self = HopperNonlinearParameters;  ///< this struct
  /// Pointers to the members, in the order of the table of parameters.
  static constexpr auto kMembers =
      joined(HopperLinearParameters<T>::kMembers,
             std::array<T Self::*, 3>{&Self::inertia_a_kgm2, &Self::inertia_b_kgm, &Self::inertia_e_kgm});
  static_assert(kMembers.size() == kHopperNonlinearParameters.size());
};

namespace machines {

/// The hopper with link inertia.
struct HopperNonlinear {
  /// Names, parameters and location types.
  static constexpr MachineInfo kInfo{.name = "hopper_nonlinear",
                                     .rig = "hopper",
                                     .parameters = kHopperNonlinearParameters,
                                     .location_types = LocationType::axis | LocationType::rail |
                                                       LocationType::drive | LocationType::motor |
                                                       LocationType::leg | LocationType::heavy_links};
  /// Its parameters in scalar T.
  template <class T>
  using Parameters = HopperNonlinearParameters<T>;
  /// Its plant in scalar T, with all effects that apply to it.
  template <class T>
  using Plant = Hopper<T>;
  /// Rules for the host, defined in host/machines/hopper.cpp.
  static const furcula::machines::Rules& rules();
};

}  // namespace machines
}  // namespace furcula::dynamics
