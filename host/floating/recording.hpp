// Recordings of a walking robot: joints, their targets, IMU, attitude and foot switches in rows, and the windows that a fit is made on.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "furcula/dynamics/biped/state.hpp"
#include "host/biped/machine.hpp"
#include "host/log/log.hpp"

namespace furcula::floating {

using biped::kJoints;
using biped::kLegJoints;
using biped::link_name;
using biped::Machine;
using biped::Unknown;

struct Row {
  double time_s = 0.0;
  std::array<double, kJoints> angle_rad{}, rate_radps{}, target_rad{};
  dynamics::biped::Quaternion<double> attitude{1.0, 0.0, 0.0, 0.0};  ///< the IMU's axes to the level's
  dynamics::tree::Vec3<double> gyro_radps{};
  std::array<bool, 2> contact{};
};

struct Recording {
  std::string file;
  std::vector<Row> rows;
  bool passive_hips = false;
  bool held =
      false;  ///< on a stand that holds the pelvis: no foot is loaded in any row, and the gyro is still
  std::optional<double> fall_s;  ///< after the first row of the log; without it the robot does not fall
  std::vector<std::string> notes;
};

/// Columns as `furcula walk sim` writes them (docs/contracts.md, section 1). The rows of a fall are left out: from 0.15 s before roll leaves
/// 0.35 rad or pitch 0.5 rad. @throws core::DataError naming the columns that are missing.
Recording recording_of(const log::Log& log);

/// Rows [first, first + count) of a recording, the first of which is the start.
struct Window {
  std::size_t recording = 0, first = 0, count = 0;
  std::array<bool, 2> stance{};  ///< feet that carry through all of it
  std::size_t foot = 0;          ///< of these the one that has carried longest: flat on the ground, at rest
  std::size_t phase = 0;         ///< windows since the last landing
};

/// Time that is in no window, and why.
struct Unused {
  double landings_s = 0.0;   ///< up to 60 ms after one
  double no_stance_s = 0.0;  ///< no foot carries all the time
  double short_s = 0.0;      ///< less than half a window to the next landing or the end
};

/// Of about `length_s`, one after the other; none has a landing in it or begins within 60 ms of one, and in each a foot carries, or
/// a stand holds the pelvis.
std::vector<Window> windows_of(const Recording& recording, std::size_t index, double length_s,
                               Unused* unused = nullptr);

}  // namespace furcula::floating
