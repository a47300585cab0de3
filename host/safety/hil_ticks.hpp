// The most ticks that `scripts/hil faults` saw on furculad in two runs or more, for docs/safety.md: from the tick on
// which something breaks until the drive is told to be off. That run holds them to the limits of the table.
#pragma once

#include <cstdint>
#include <optional>

#include "boards/sim_host/faults.hpp"

namespace furcula::safety {

struct HilTicks {
  sim_host::RigFault breaks;
  std::uint32_t ticks;
};
inline constexpr HilTicks kHilTicks[] = {
    {sim_host::RigFault::encoder_frozen, 3},
    {sim_host::RigFault::encoder_stuck, 279},
    {sim_host::RigFault::encoder_jumping, 1},
    {sim_host::RigFault::encoder_reversed, 224},
    {sim_host::RigFault::encoder_backwards, 182},
    {sim_host::RigFault::height_nan, 1},
    {sim_host::RigFault::switch_stuck_open, 738},
    {sim_host::RigFault::switch_stuck_closed, 794},
    {sim_host::RigFault::switch_chattering, 633},
    {sim_host::RigFault::late_tick, 5},
    {sim_host::RigFault::task_stuck, 50},
    {sim_host::RigFault::peer_lost, 3},
    {sim_host::RigFault::coil_stuck_on, 2206},
    {sim_host::RigFault::key_stuck_released, 2205},
    {sim_host::RigFault::frame_lost, 3},
    {sim_host::RigFault::frame_late, 3},
    {sim_host::RigFault::frame_reordered, 7},
    {sim_host::RigFault::frame_corrupted, 3},
    {sim_host::RigFault::bus_off, 2},
    {sim_host::RigFault::drive_silent, 3},
    {sim_host::RigFault::drive_error, 2},
    {sim_host::RigFault::drive_off, 187},
    {sim_host::RigFault::encoder_drifting, 3763},
    {sim_host::RigFault::switch_vibrating, 239},
    {sim_host::RigFault::drive_doubled, 4},
    {sim_host::RigFault::drive_hot, 2},
    {sim_host::RigFault::drive_reversed, 134},
    {sim_host::RigFault::drive_of_other_motor, 760},
    {sim_host::RigFault::torque_offset, 283},
    {sim_host::RigFault::supply_high, 1},
};

/// Absent: borne, or not measured.
inline std::optional<std::uint32_t> hil_ticks(sim_host::RigFault fault) {
  for (const HilTicks& row : kHilTicks)
    if (row.breaks == fault) return row.ticks;
  return std::nullopt;
}

/// Whether `scripts/hil faults` tries it: not a brown-out, after which furculad, whose file has the counters'
/// home, is idle without a fault (tests/hil/scenarios/board_killed.toml).
constexpr bool tried_on_hil(sim_host::RigFault fault) { return fault != sim_host::RigFault::brown_out; }

}  // namespace furcula::safety
