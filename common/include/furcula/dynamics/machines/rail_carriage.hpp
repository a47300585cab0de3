// A carriage that is thrown or falls along a vertical rail. Nothing drives it.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class Parameters, class T>
class Axis;  // furcula/dynamics/axis.hpp

// In the order of the members of RailCarriageParameters.
inline constexpr std::array<ParameterInfo, 3> kRailCarriageParameters{{
    {"mass_kg", "kg", 1e-3, 1e3, "mass of the carriage"},
    {"damping_nspm", "N s/m", 0.0, 1e4, "viscous friction of the rail"},
    {"gravity_mps2", "m/s^2", 0.0, 30.0, "gravity"},
}};

template <class T>
struct RailCarriageParameters {
  T mass_kg{}, damping_nspm{}, gravity_mps2{};

  using Self = RailCarriageParameters;
  static constexpr std::array<T Self::*, 3> kMembers{&Self::mass_kg, &Self::damping_nspm,
                                                     &Self::gravity_mps2};
  static_assert(kMembers.size() == kRailCarriageParameters.size());
};

namespace machines {

struct RailCarriage {
  static constexpr MachineInfo kInfo{.name = "rail_carriage",
                                     .rig = "rail_carriage",
                                     .parameters = kRailCarriageParameters,
                                     .seats = Seat::axis | Seat::rail};
  template <class T>
  using Parameters = RailCarriageParameters<T>;
  template <class T>
  using Plant = Axis<Parameters<T>, T>;
  static const furcula::machines::Rules& rules();  ///< host/machines/rail_carriage.cpp
};

}  // namespace machines
}  // namespace furcula::dynamics
