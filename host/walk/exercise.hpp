// An exercise on the stand, simulated with the board's controller: its log.
#pragma once

#include <cstdint>
#include <optional>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/log/log.hpp"
#include "host/walk/walk_toml.hpp"

namespace furcula::walk {

/// For so long an exercise is logged after its time: the robot rests in the posture.
inline constexpr double kExerciseRest_s = 0.5;

/// The log has `walk.exercise_s` and kExerciseRest_s, in rows `row_s` apart. Drives are late by `command_delay_s`. `seed`: sensors err, drawn from
/// it. @throws core::DataError: the board finds a fault; a mode in which it does not walk.
log::Log simulate_exercise(const dynamics::biped::Description& robot, const Walk& walk,
                           double command_delay_s, double row_s, std::optional<std::uint64_t> seed);

}  // namespace furcula::walk
