// Signs and units of all columns of a machine's joints at once: where several are wrong, mending one of them alone makes nothing fit.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/conventions/trial.hpp"

namespace furcula::conventions {

/// What a column is multiplied by.
struct ColumnReading {
  double scale = 1.0;
  bool estimated = false;  ///< no unit explains it
  std::string what;        ///< "in degrees, of the other sign"
};

/// How each joint's columns are read.
struct JointReadings {
  std::vector<ColumnReading> position, input;
  std::vector<double> off;  ///< of each joint: RMS of the rest over that of the force
  /// Sets of columns that may have the other sign all together: the recordings would be the same. The smallest sets first.
  std::vector<std::vector<std::string>> same;
  bool sure =
      true;  ///< as named, with friction and constant forces of any size, the columns do not fit as well
};

/// The readings of the joints' positions (sign, and unit of each) and inputs (sign and scale of each) that fit far better together than the
/// columns as named, or those as named with what is the same, where they fit. Nothing where neither fits, or a machine has one joint.
/// All patterns of signs of up to eight positions are tried, of more a descent from several starts.
std::optional<JointReadings> find_joint_readings(const Family& family, std::span<const Columns> recordings);

}  // namespace furcula::conventions
