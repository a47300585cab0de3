// walk.toml in and out, apart from all that a search needs: furculad reads it too.
#pragma once

#include <string>
#include <string_view>

#include "host/walk/rollout.hpp"

namespace furcula::walk {

struct Walk {
  std::string robot;  ///< its name
  WalkMode mode = WalkMode::active;
  double walk_until_s = 5.0;
  Parameters parameters;
  /// Of the drives that it was searched with: the board's supervisor expects their torques so much later.
  double command_delay_s = 0.0;
  /// Above 0: the legs move on the stand for so long, in place of a walk (furcula/control/walk/exercise.hpp).
  double exercise_s = 0.0;
};

std::string format_walk(const Walk& walk);
/// @throws core::DataError: not a walk, a parameter that is missing or beyond what a joint can do.
Walk read_walk(const std::string& path);
Walk parse_walk(std::string_view text, const std::string& name);
/// @throws core::DataError: an exercise on the stand, of the file `name`.
void require_steps(const Walk& walk, const std::string& name);

}  // namespace furcula::walk
