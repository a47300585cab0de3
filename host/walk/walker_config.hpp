// The board's configuration for a walk.
#pragma once

#include "furcula/control/walk/walker.hpp"
#include "furcula/dynamics/biped/parameters.hpp"
#include "host/walk/walk_toml.hpp"

namespace furcula::walk {

/// When a drive is told and answers.
enum class DriveTurns {
  each_tick,
  every_second_tick,  ///< (bus/walker_nodes.hpp), in that tick
  over_buses          ///< in every second tick, and what it answers is there a tick later
};

control::WalkerConfig walker_config(const dynamics::biped::Description& robot, const Walk& walk,
                                    double foot_threshold_n, DriveTurns turns);

}  // namespace furcula::walk
