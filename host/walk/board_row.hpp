// A row of a log that a board writes of itself: what its devices gave, what it told the drives, its attitude and foot switches.
//
// Without memory from the heap: furculad makes rows in its loop.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "furcula/control/walk/walker.hpp"

namespace furcula::walk {

/// Of a joint's columns: "left_hip_yaw" is the first, the left leg's from the hip down come before the right's.
std::string joint_name(std::size_t joint);

/// Time; angle, rate, target and torque of each joint; gyro, accelerometer, attitude; foot switches.
inline constexpr std::size_t kBoardColumns = 1 + 4 * control::kWalkerJoints + 3 + 3 + 3 + 2;
using BoardRow = std::array<double, kBoardColumns>;

/// Columns of `furcula walk sim` but for the base's position, in a row's order.
std::vector<std::string> board_columns();

/// `board` and `told`: after the tick that took the sample. A joint whose drive is not asked in this tick goes on at its rate.
BoardRow board_row(double time_s, const control::WalkerSample& sample, const control::WalkerState& board,
                   const control::WalkerOutputs& told);

}  // namespace furcula::walk
