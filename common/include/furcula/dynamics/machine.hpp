// The description of a machine: its name, its parameters, where something can be wrong with it. Each machine's
// header is machines/<name>.hpp, the list of them machines.hpp.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace furcula::machines {
/// What the host must know of a machine to simulate, identify and diagnose it: host/machines/rules.hpp.
struct Rules;
}  // namespace furcula::machines

namespace furcula::dynamics {

/// The machine's number in the list (machines.hpp).
enum class Kind : std::uint8_t;

/// One parameter of a machine. `lower` and `upper` are the values that make physical sense at all; a file
/// outside of them is rejected. They are not the bounds of a fit: those stand in the model's [free] table.
struct ParameterInfo {
  std::string_view name;     ///< carries the unit, as in the model file
  std::string_view unit;     ///< SI, for messages; "" where it has none
  double lower;              ///< smallest value that is accepted
  double upper;              ///< largest value that is accepted
  std::string_view meaning;  ///< phrase for documentation and messages
};

/// Type of a location where an effect can act; values can be combined with |. An effect of the catalogue names its location
/// types, and exists on every machine that has one of them.
enum class LocationType : std::uint16_t {
  axis = 1,           ///< a guide or bearing that a body moves in
  rail = 2,           ///< a vertical one, with an encoder of the height
  drive = 4,          ///< follows commands
  motor = 8,          ///< a rotary one, with a rotor
  swing = 16,         ///< an angle whose zero gravity or a spring shows
  leg = 32,           ///< with a spring; stances and flights, touch-down and lift-off
  light_leg = 64,     ///< one whose links have no inertia in the model
  heavy_links = 128,  ///< one whose links have: free in flight, and the clutch's coil and key are simulated
  belt = 256,         ///< that a clutch holds and lets go
};
/// The location types of both.
constexpr LocationType operator|(LocationType a, LocationType b) {
  return static_cast<LocationType>(static_cast<unsigned>(a) | static_cast<unsigned>(b));
}
/// Whether they have one in common.
constexpr bool any_of(LocationType a, LocationType b) {
  return (static_cast<unsigned>(a) & static_cast<unsigned>(b)) != 0;
}

/// The description of a machine.
struct MachineInfo {
  std::string_view name;                      ///< in the model file
  std::string_view rig;                       ///< its machine type in the log
  std::span<const ParameterInfo> parameters;  ///< its table; an index into it is a parameter's index
  LocationType location_types;                ///< location types that it has
  bool rotary = false;                        ///< its position is an angle
  Kind kind{};                                ///< filled in by the list
};

/// The struct of parameters from values in the order of its machine's table; `values` has one for each parameter.
template <class Parameters, class T>
constexpr Parameters from_table(std::span<const T> values) {
  Parameters p{};
  for (std::size_t i = 0; i < Parameters::kMembers.size(); ++i) p.*Parameters::kMembers[i] = values[i];
  return p;
}

}  // namespace furcula::dynamics
