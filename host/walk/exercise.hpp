// An exercise on the stand, simulated with the board's controller: its log.
#pragma once

#include <cstdint>
#include <optional>

#include "furcula/dynamics/biped/parameters.hpp"
#include "host/log/log.hpp"
#include "host/walk/walk_toml.hpp"

namespace furcula::walk {

/// For so long a board's exercise is logged after its last move began: it rests in the posture.
inline constexpr double kExerciseRest_s = 0.5;

/// The log has `walk.exercise_s` and kExerciseRest_s, in rows `row_s` apart. `seed`: sensors err, drawn from it.
/// @throws core::DataError: the board finds a fault.
log::Log simulate_exercise(const dynamics::biped::Description& robot, const Walk& walk, double row_s,
                           std::optional<std::uint64_t> seed);

}  // namespace furcula::walk
