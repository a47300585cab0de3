// One walk in double as a log: what the sensors give, and what nobody measures.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/log/log.hpp"
#include "host/walk/board_row.hpp"
#include "host/walk/rollout.hpp"

namespace furcula::walk {

struct Simulation {
  log::Log log;
  Rollout rollout;
};

/// Rows every `row_s`, a whole number of ticks. With `seed` the sensors err (sensors.hpp). Columns as of a tree on a floating base
/// (docs/contracts.md, section 1).
Simulation simulate_walk(const dynamics::biped::Description& robot, const RolloutOptions& options,
                         const Parameters& walk, double row_s, std::optional<std::uint64_t> seed);

}  // namespace furcula::walk
