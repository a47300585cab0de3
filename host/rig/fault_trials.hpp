// The table of what breaks, tried on a board's own program.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/rig/rig.hpp"
#include "host/safety/fault_table.hpp"

namespace furcula::rig {

/// By so many ticks the rig sees later what the controller finds: the board tells its drive to be off on the
/// tick after, and its ticks lie anywhere between the rig's.
inline constexpr std::uint32_t kSeenLaterTicks = 2;

struct FaultTrial {
  safety::Moment moment;
  /// From the tick on which something breaks until the drive is told to be off; absent: it is not.
  std::optional<std::uint32_t> told_off_ticks;
  std::string broken_limit;  ///< in words; empty: none
};

/// A row of the table at each of the moments of the stride, as the simulated rig sees them. `options.moment` and
/// `options.watched_s` are set here. @throws RigError as run() does.
std::vector<FaultTrial> try_on_board(const safety::RigRow& row, std::span<const safety::Moment> moments,
                                     RigOptions options);

}  // namespace furcula::rig
