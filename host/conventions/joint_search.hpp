// Signs and units of all columns of a machine's joints at once: where several are wrong, mending one of them alone makes nothing fit.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/conventions/equation.hpp"
#include "host/conventions/trial.hpp"

namespace furcula::conventions {

/// What each joint's columns are multiplied by.
struct JointReadings {
  std::vector<double> position;
  std::vector<InputScale> input;
  std::vector<double> off;  ///< of each joint: RMS of the rest over that of the force
  /// Sets of columns that may have the other sign all together: the recordings would be the same. The smallest sets first.
  std::vector<std::vector<std::string>> same;
};

/// The readings of the joints' positions (sign, and unit of each) and inputs (sign and scale of each) that fit far better together than the
/// columns as named, or those as named with what is the same, where they fit. Nothing where neither fits, or a machine has one joint.
/// All patterns of signs of up to eight positions are tried, of more a descent from several starts.
std::optional<JointReadings> find_joint_readings(const Family& family, std::span<const Columns> recordings);

}  // namespace furcula::conventions
