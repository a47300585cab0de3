// Faults that a scenario plants in the simulated rig.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace furcula::sim_host {

enum class RigFault : std::uint8_t {
  encoder_frozen,
  encoder_stuck,
  height_nan,
  switch_stuck_open,
  switch_stuck_closed,
  late_tick,
  peer_lost,
  coil_open,  // this and the next are the clutch's
  coil_stuck_on,
  supply_sag,
};

struct RigFaultInfo {
  RigFault fault;
  std::string_view name;
  std::string_view meaning;
};

inline constexpr std::array<RigFaultInfo, 10> kRigFaults{{
    {RigFault::encoder_frozen, "encoder_frozen",
     "the device answers with the same old sample, whose age grows"},
    {RigFault::encoder_stuck, "encoder_stuck", "the height's counter stands still, all else is fresh"},
    {RigFault::height_nan, "height_nan", "the height's reference is lost"},
    {RigFault::switch_stuck_open, "switch_stuck_open", "the contact switch reads open"},
    {RigFault::switch_stuck_closed, "switch_stuck_closed", "the contact switch reads closed"},
    {RigFault::late_tick, "late_tick", "one tick comes late by the fault's duration"},
    {RigFault::peer_lost, "peer_lost", "the device with the sensors does not answer"},
    {RigFault::coil_open, "coil_open", "no current flows in the clutch's coil"},
    {RigFault::coil_stuck_on, "coil_stuck_on", "the clutch's coil is on, whatever it is told"},
    {RigFault::supply_sag, "supply_sag", "the coil's supply has 0.8 of its voltage"},
}};

constexpr std::optional<RigFault> rig_fault_named(std::string_view name) {
  for (const RigFaultInfo& f : kRigFaults)
    if (f.name == name) return f.fault;
  return std::nullopt;
}

struct PlannedFault {
  double time_s = 0.0;
  RigFault kind = RigFault::peer_lost;
  double duration_s = 0.0;  ///< of late_tick: by how much
};

}  // namespace furcula::sim_host
