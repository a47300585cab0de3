// How large a planted law is: values by size, on a machine that is about to be recorded.
#pragma once

#include <optional>
#include <string_view>

#include "host/model/model.hpp"
#include "tests/hidden/cases.hpp"
#include "tests/hidden/laws.hpp"
#include "tests/hidden/random.hpp"

namespace furcula::hidden {

/// What an axis is used to without the effect.
struct AxisHabits {
  double input = 1.0;  ///< RMS of the command, N or N m
  double peak = 1.0;   ///< 99 % of the commands are smaller
  double speed = 1.0;  ///< 95 % of the samples are slower
  double reach = 1.0;  ///< 90 % of the samples are nearer to 0
};

Planted hopper_law(std::string_view law, Size size, const model::Model& model, Random& random);
/// Of a hopper's clutch; nothing for another law.
std::optional<Planted> clutch_law(std::string_view law, Size size, const model::Model& model, Random& random);
Planted bench_law(std::string_view law, Size size, const model::Model& model, Random& random);
Planted axis_law(std::string_view law, Size size, const model::Model& model, const AxisHabits& habits,
                 Random& random);

}  // namespace furcula::hidden
