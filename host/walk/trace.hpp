// What a robot measures of a whole walk, in rows: what document 000's Eq. 3 compares.
#pragma once

#include <array>
#include <vector>

#include "host/walk/member.hpp"

namespace furcula::walk {

struct TraceRow {
  std::array<float, dynamics::biped::kJoints> angle_rad{}, target_rad{};  ///< left then right
  std::array<float, 3> turn_rad{};  ///< roll, pitch, yaw of the attitude filter
};

struct Trace {
  std::vector<TraceRow> rows;  ///< every row_s from the start on, until the walk ended
  Rollout rollout;
};

}  // namespace furcula::walk
