// Traces of a machine of one joint.
#pragma once

#include <string>
#include <vector>

#include "host/log/log.hpp"
#include "host/model/model.hpp"
#include "host/traces/traces.hpp"

namespace furcula::traces {

struct AxisModel {
  std::string name;  ///< "given", "refitted", "extended", "predicted"
  model::Model model;
};

/// Position, velocity where it was recorded, the leg's angle and the drive's torque where they were: over the windows that predictions are
/// judged on (host/identify/windows.hpp). `starts_from` leaves what the start states are estimated from. A leg's angle is predicted about
/// its mean over each window, since no model has the encoder's zero; a drive's torque from the measured state.
/// @throws core::DataError where a log has too few rows, or nothing moves in any.
Traces of_axis(const std::vector<AxisModel>& models, const model::Model& starts_from,
               const std::vector<log::Log>& training, const std::vector<log::Log>& held_out, double window_s);

}  // namespace furcula::traces
