// A carriage that is thrown or falls along a vertical rail, without a drive.
#pragma once

#include "furcula/dynamics/machine.hpp"

namespace furcula::dynamics {

template <class Parameters, class T>
class Axis;  // furcula/dynamics/axis.hpp

/// Name, unit, lower and upper bound and meaning of each parameter, in the order of the members of RailCarriageParameters.
inline constexpr std::array<ParameterInfo, 3> kRailCarriageParameters{{
    {"mass_kg", "kg", 1e-3, 1e3, "mass of the carriage"},
    {"damping_nspm", "N s/m", 0.0, 1e4, "viscous friction of the rail"},
    {"gravity_mps2", "m/s^2", 0.0, 30.0, "gravity"},
}};

/// Parameters of the carriage.
template <class T>
struct RailCarriageParameters {
  T mass_kg{},         ///< of the carriage
      damping_nspm{},  ///< viscous friction of the rail
      gravity_mps2{};  ///< magnitude; position is positive upwards

  using Self = RailCarriageParameters;  ///< this struct
  /// Pointers to the members, in the order of the table of parameters.
  static constexpr std::array<T Self::*, 3> kMembers{&Self::mass_kg, &Self::damping_nspm,
                                                     &Self::gravity_mps2};
  static_assert(kMembers.size() == kRailCarriageParameters.size());
};

namespace machines {

/// A carriage in free flight on a vertical rail.
struct RailCarriage {
  /// Names, parameters and location types.
  static constexpr MachineInfo kInfo{.name = "rail_carriage",
                                     .rig = "rail_carriage",
                                     .parameters = kRailCarriageParameters,
                                     .location_types = LocationType::axis | LocationType::rail};
  /// Its parameters in scalar T.
  template <class T>
  using Parameters = RailCarriageParameters<T>;
  /// Its plant in scalar T, with all effects that apply to it.
  template <class T>
  using Plant = Axis<Parameters<T>, T>;
  /// Rules for the host, defined in host/machines/rail_carriage.cpp.
  static const furcula::machines::Rules& rules();
};

}  // namespace machines
}  // namespace furcula::dynamics
