// Rows of a log that a board writes of itself: what its devices gave, what it told the drives, its attitude and foot switches.
#pragma once

#include "furcula/control/walk/walker.hpp"
#include "host/log/log.hpp"

namespace furcula::walk {

/// Appends a row with the columns of `furcula walk sim` but for the base's position. `board` and `told`: after the tick that took `sample`.
void put_row(log::Log& log, double time_s, const control::WalkerSample& sample,
             const control::WalkerState& board, const control::WalkerOutputs& told);

}  // namespace furcula::walk
