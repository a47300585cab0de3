// What the loop's thread tells of its time and its buses, for any thread to read.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "boards/linux_sbc/histogram.hpp"
#include "host/socketcan/link_watch.hpp"

namespace furcula::linux_sbc {

/// CAN buses that a robot may have.
inline constexpr std::size_t kMostBuses = 3;

struct LoopFigures {
  Histogram lateness;  ///< from when a tick was due to when the loop woke
  Histogram work;      ///< from there to the end of the tick
  std::atomic<std::uint64_t> overruns{0}, ticks{0}, edges{0};
  std::atomic<std::uint64_t> can_refused{0}, can_errors{0};
  std::array<std::atomic<socketcan::CanState>, kMostBuses> can_states{};
};

}  // namespace furcula::linux_sbc
