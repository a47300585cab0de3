// Rows as a board logs itself (board_row.hpp), in a log.
#pragma once

#include "furcula/control/walk/walker.hpp"
#include "host/log/log.hpp"

namespace furcula::walk {

/// Appends a board_row.
void put_row(log::Log& log, double time_s, const control::WalkerSample& sample,
             const control::WalkerState& board, const control::WalkerOutputs& told);

}  // namespace furcula::walk
