// The machines, in one list. Other code tests what a machine has (its location types, its table, its rules on the host), not
// which machine it is. How one is added: docs/adding_a_machine.md.
#pragma once

#include <optional>
#include <tuple>

#include "furcula/dynamics/machines/clutch_bench.hpp"
#include "furcula/dynamics/machines/hopper_linear.hpp"
#include "furcula/dynamics/machines/hopper_nonlinear.hpp"
#include "furcula/dynamics/machines/motor_axis.hpp"
#include "furcula/dynamics/machines/rail_carriage.hpp"
#include "furcula/dynamics/machines/rotary_joint.hpp"
#include "furcula/dynamics/machines/torsion_pendulum.hpp"

namespace furcula::dynamics {

/// The machines as types.
using Machines =
    std::tuple<machines::HopperLinear, machines::HopperNonlinear, machines::MotorAxis, machines::RotaryJoint,
               machines::RailCarriage, machines::ClutchBench, machines::TorsionPendulum>;

/// Their names, in the same order.
enum class Kind : std::uint8_t {
  hopper_linear,
  hopper_nonlinear,
  motor_axis,
  rotary_joint,
  rail_carriage,
  clutch_bench,
  torsion_pendulum
};

/// Their descriptions, in the order of the list.
inline constexpr auto kMachines = []<class... Machine>(std::tuple<Machine...>*) {
  std::array<MachineInfo, sizeof...(Machine)> all{Machine::kInfo...};
  for (std::size_t i = 0; i < all.size(); ++i) all[i].kind = static_cast<Kind>(i);
  return all;
}(static_cast<Machines*>(nullptr));

/// The description of a machine.
constexpr const MachineInfo& info(Kind kind) { return kMachines[static_cast<std::size_t>(kind)]; }

/// Whether a machine has one of these location types.
constexpr bool has(Kind kind, LocationType location_type) {
  return any_of(info(kind).location_types, location_type);
}

/// The machine of this name in the model file; nothing where there is none.
constexpr std::optional<Kind> kind_named(std::string_view name) {
  for (const MachineInfo& machine : kMachines)
    if (machine.name == name) return machine.kind;
  return std::nullopt;
}

/// The number of a machine in the list, from its type.
template <class Machine>
inline constexpr Kind kKindOf = *kind_named(Machine::kInfo.name);

/// Index of a parameter in the machine's table; nothing where it has none of this name.
constexpr std::optional<std::size_t> parameter_index(Kind kind, std::string_view name) {
  const auto table = info(kind).parameters;
  for (std::size_t i = 0; i < table.size(); ++i)
    if (table[i].name == name) return i;
  return std::nullopt;
}

/// `f.operator()<Machine>()` with the machine of this kind.
template <std::size_t kFrom = 0, class F>
constexpr decltype(auto) with_machine(Kind kind, const F& f) {
  if constexpr (kFrom + 1 < kMachines.size())
    if (static_cast<std::size_t>(kind) != kFrom) return with_machine<kFrom + 1>(kind, f);
  return f.template operator()<std::tuple_element_t<kFrom, Machines>>();
}

}  // namespace furcula::dynamics
