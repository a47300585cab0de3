// A log's time stamps, accepted or refused before anything is learnt from it.
#pragma once

#include "host/log/column_map.hpp"
#include "host/log/log.hpp"

namespace furcula::log {

/// What the time stamps imply is among the log's notes, and intervals that contradict the motion are gaps. A slow log whose windows were
/// chosen for it (`window_s`, 0: they were not) is not in a wrong unit.
/// @throws core::DataError: stamps from which nothing can be learnt.
void accept_stamps(Log& log, const ColumnMap* map, double window_s);

}  // namespace furcula::log
