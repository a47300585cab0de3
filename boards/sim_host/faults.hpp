// Faults that a scenario plants in the simulated rig.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace furcula::sim_host {

enum class RigFault : std::uint8_t {
  encoder_frozen,
  encoder_stuck,
  encoder_jumping,
  encoder_reversed,
  encoder_backwards,
  height_nan,
  switch_stuck_open,
  switch_stuck_closed,
  switch_chattering,
  late_tick,
  task_stuck,
  peer_lost,
  coil_open,
  coil_shorted,
  coil_stuck_on,
  key_stuck_caught,
  key_stuck_released,
  supply_sag,
  frame_lost,
  frame_late,
  frame_repeated,
  frame_reordered,
  frame_corrupted,
  bus_off,
  drive_silent,
  drive_error,
  drive_off,
  encoder_drifting,
  switch_vibrating,
  brown_out,
  drive_doubled,
  drive_hot,
  drive_reversed,
  drive_of_other_motor,
  torque_offset,
  torque_offset_hidden,
  supply_high,
};

/// What a rig must have so that it can break.
enum class RigPart : std::uint8_t { any, clutch, bus };

struct RigFaultInfo {
  RigFault fault;
  std::string_view name;
  RigPart part;
  std::string_view meaning;
};

inline constexpr std::array<RigFaultInfo, 37> kRigFaults{{
    {RigFault::encoder_frozen, "encoder_frozen", RigPart::any,
     "the device answers with the same old sample, whose age grows"},
    {RigFault::encoder_stuck, "encoder_stuck", RigPart::any,
     "the height's counter stands still, all else is fresh"},
    {RigFault::encoder_jumping, "encoder_jumping", RigPart::any,
     "the height's counter jumps by 5 cm, and back after 10 ms"},
    {RigFault::encoder_reversed, "encoder_reversed", RigPart::any,
     "the height's counter counts against the motion"},
    {RigFault::encoder_backwards, "encoder_backwards", RigPart::any,
     "the height's counter counts every step down, whichever way the body moves"},
    {RigFault::height_nan, "height_nan", RigPart::any, "the height's reference is lost"},
    {RigFault::switch_stuck_open, "switch_stuck_open", RigPart::any, "the contact switch reads open"},
    {RigFault::switch_stuck_closed, "switch_stuck_closed", RigPart::any, "the contact switch reads closed"},
    {RigFault::switch_chattering, "switch_chattering", RigPart::any,
     "the contact switch reads closed and open in turn, on each tick"},
    {RigFault::late_tick, "late_tick", RigPart::any, "one tick comes late by the fault's duration"},
    {RigFault::task_stuck, "task_stuck", RigPart::any,
     "the controller's task hangs for the fault's duration, longer than the watchdog waits"},
    {RigFault::peer_lost, "peer_lost", RigPart::any, "the device with the sensors does not answer"},
    {RigFault::coil_open, "coil_open", RigPart::clutch, "no current flows in the clutch's coil"},
    {RigFault::coil_shorted, "coil_shorted", RigPart::clutch,
     "the clutch's coil is shorted: its driver switches off and the key is not pulled"},
    {RigFault::coil_stuck_on, "coil_stuck_on", RigPart::clutch,
     "the clutch's coil is on, whatever it is told"},
    {RigFault::key_stuck_caught, "key_stuck_caught", RigPart::clutch,
     "the clutch's key does not come out, whatever the coil pulls"},
    {RigFault::key_stuck_released, "key_stuck_released", RigPart::clutch,
     "the clutch's key, once out, does not fall in again"},
    {RigFault::supply_sag, "supply_sag", RigPart::clutch, "the coil's supply has 0.8 of its voltage"},
    {RigFault::frame_lost, "frame_lost", RigPart::bus, "frames on the bus are lost"},
    {RigFault::frame_late, "frame_late", RigPart::bus, "frames on the bus come 2 ms late"},
    {RigFault::frame_repeated, "frame_repeated", RigPart::bus, "frames on the bus come twice"},
    {RigFault::frame_reordered, "frame_reordered", RigPart::bus,
     "every second frame on the bus comes after its successor"},
    {RigFault::frame_corrupted, "frame_corrupted", RigPart::bus,
     "frames on the bus have wrong check sums: they are dropped, and error frames follow"},
    {RigFault::bus_off, "bus_off", RigPart::bus, "the CAN controller of the robot goes off the bus"},
    {RigFault::drive_silent, "drive_silent", RigPart::bus, "the motor's drive is dead: no torque, no reply"},
    {RigFault::drive_error, "drive_error", RigPart::bus,
     "the motor's drive reports an error and gives no torque"},
    {RigFault::drive_off, "drive_off", RigPart::bus,
     "the motor's drive answers, reports no error, and gives no torque"},
    {RigFault::encoder_drifting, "encoder_drifting", RigPart::any,
     "the height's counter loses 1 cm in each second"},
    {RigFault::switch_vibrating, "switch_vibrating", RigPart::clutch,
     "the contact switch closes for 3 ms in every 10 while the leg flies with its spring released"},
    {RigFault::brown_out, "brown_out", RigPart::any,
     "the board's supply fails for the fault's duration; then the board starts anew"},
    {RigFault::drive_doubled, "drive_doubled", RigPart::bus,
     "a second drive on the bus has the node id of the motor's drive"},
    {RigFault::drive_hot, "drive_hot", RigPart::bus, "the motor's drive reports 110 degrees"},
    {RigFault::drive_reversed, "drive_reversed", RigPart::any,
     "the motor's torque has the other sign, and the drive does not know"},
    {RigFault::drive_of_other_motor, "drive_of_other_motor", RigPart::bus,
     "an AK80-6's drive is on the bus in place of an AK80-9's"},
    {RigFault::torque_offset, "torque_offset", RigPart::bus,
     "the motor gives 1.2 N m more than it is told, and its current shows it"},
    {RigFault::torque_offset_hidden, "torque_offset_hidden", RigPart::any,
     "the motor gives 1.2 N m more than it is told, and its current does not show it"},
    {RigFault::supply_high, "supply_high", RigPart::bus,
     "the drive's supply has 60 V, as when the motor feeds back into one that takes nothing"},
}};

constexpr const RigFaultInfo& info(RigFault fault) { return kRigFaults[static_cast<std::size_t>(fault)]; }

static_assert(
    [] {
      for (std::size_t i = 0; i < kRigFaults.size(); ++i)
        if (static_cast<std::size_t>(kRigFaults[i].fault) != i) return false;
      return true;
    }(),
    "the faults stand in the order of their enumerators");

/// Whether a fault is one of the clock: its duration is the time by which a tick is late.
constexpr bool delays_tick(RigFault fault) {
  return fault == RigFault::late_tick || fault == RigFault::task_stuck || fault == RigFault::brown_out;
}

/// Whether commands may not reach the drive while such a fault lasts.
constexpr bool silences_bus(RigFault fault) {
  return fault == RigFault::frame_lost || fault == RigFault::frame_late ||
         fault == RigFault::frame_reordered || fault == RigFault::frame_corrupted ||
         fault == RigFault::bus_off;
}

inline constexpr double kDriftMps = 0.01;       ///< of encoder_drifting, downwards
inline constexpr double kTorqueOffsetNm = 1.2;  ///< of torque_offset and torque_offset_hidden
inline constexpr double kHotMotorC = 110.0;     ///< of drive_hot
inline constexpr double kSupplyV = 48.0;        ///< as it should be
inline constexpr double kSupplyHighV = 60.0;    ///< of supply_high

constexpr std::optional<RigFault> rig_fault_named(std::string_view name) {
  for (const RigFaultInfo& f : kRigFaults)
    if (f.name == name) return f.fault;
  return std::nullopt;
}

struct PlannedFault {
  double time_s = 0.0;
  RigFault kind = RigFault::peer_lost;
  double duration_s = 0.0;  ///< of late_tick, task_stuck and brown_out: by how much
};

}  // namespace furcula::sim_host
