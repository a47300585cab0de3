// The cases: a rig with a hidden cause drawn from a seed, its recordings, and the model that the diagnosis
// gets, which does not know of the cause.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "host/log/log.hpp"
#include "host/model/model.hpp"
#include "tests/hidden/machine.hpp"
#include "tests/hidden/rig.hpp"

namespace furcula::hidden {

/// How large the planted effect is: see the table at the head of cases.cpp.
enum class Size { small, medium, large };

struct Case {
  std::uint64_t seed = 0;
  Kind kind = Kind::hopper_linear;
  Size size = Size::medium;
  Truth truth;           ///< `truth.planted` is the hidden cause; none in a clean case
  model::Model model;    ///< nominal; some of its parameters free
  bool weighed = false;  ///< hopper: the mass is known and held
  bool ground_pulled = false;
  double resolution = 0.0;     ///< one count of the position sensor, m or rad
  double typical_input = 0.0;  ///< axes: RMS of the command without the effect, N or N m
  double top_speed = 0.0;      ///< axes: 95 % of the samples are slower, m/s or rad/s
  std::vector<log::Log> training, held_out;
  std::vector<Trajectory> held_out_truth;  ///< what really happened while `held_out` was recorded

  /// One line: seed, kind, effect, size and the true values.
  std::string description() const;
};

std::string_view name(Size size);

/// The same case for the same arguments, always. `effect` must apply to `kind`; none: a clean case.
Case draw_case(std::uint64_t seed, Kind kind, std::optional<Effect> effect, Size size = Size::medium);

}  // namespace furcula::hidden
