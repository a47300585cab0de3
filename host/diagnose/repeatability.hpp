// Whether what a model leaves of recordings is no more than what the machine does not repeat.
#pragma once

#include <optional>
#include <vector>

#include "host/diagnose/remainder.hpp"
#include "host/identify/windows.hpp"
#include "host/model/model.hpp"

namespace furcula::diagnose {

/// Times noise alone that an error may be and still be noise.
inline constexpr double kWithinNoise = 2.0;
/// NMSE that the simulator's own discretisation and an input held from row to row are worth: two thousandths
/// of the motion. What is smaller is not called a cause, however fine the sensor.
inline constexpr double kNumerics = 4e-6;

/// Of a belt that teeth catch: whether so small a force as no machine repeats (at most that of Remainder::repeats()) makes each fall end as
/// it did, in nine of ten windows. False of other machines. `starts`: of each window.
bool falls_repeat(const model::Model& m, const std::vector<identify::Recording>& recordings,
                  const std::vector<identify::Window>& windows,
                  const std::vector<identify::StartState>& starts);

/// Nothing is missing in this model but what the machine does not repeat, by the training recordings alone. `left`: remainder_of() these
/// windows, if there is one.
bool random_alone_in_training(const model::Model& m, const std::vector<identify::Recording>& training,
                              const std::vector<identify::Window>& windows,
                              const std::optional<Remainder>& left);

}  // namespace furcula::diagnose
