// A fault as a robot's log keeps it, and as both buses show it.
#pragma once

#include <cstdint>

namespace furcula::bus {

/// Of a fault that no tick noted, as an exception's.
inline constexpr std::uint32_t kNoTick = 0xffffffffu;
/// That a robot keeps and shows.
inline constexpr std::uint32_t kLoggedFaults = 8;

/// An entry of the fault log.
struct LoggedFault {
  std::uint32_t tick = 0;    ///< since that start, ms
  std::uint16_t fault = 0;   ///< number in the table of faults (control/fault.hpp); 0: there is no such entry
  std::uint16_t starts = 0;  ///< starts since the log was cleared, 1 is the first: which run it was
};

}  // namespace furcula::bus
