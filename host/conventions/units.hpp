// Units that logs are written in though SI is expected: what one of them is in SI.
#pragma once

#include <span>
#include <string_view>

namespace furcula::conventions {

enum class Quantity { angle, length, torque, force };

struct Unit {
  std::string_view name;  ///< "degrees"
  double si;              ///< one of it in rad, m, N m or N
  bool rare = false;      ///< in logs of robots
};

/// Of a quantity, without the SI unit itself.
std::span<const Unit> units_of(Quantity quantity);

/// Of time, in s.
std::span<const Unit> units_of_time();

/// Of a model's inertia: of mass where the position is a length.
std::span<const Unit> units_of_inertia(Quantity position);

/// "rad", "m", "N m", "N"
std::string_view si_unit(Quantity quantity);

}  // namespace furcula::conventions
