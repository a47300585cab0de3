#include "host/log/accept_stamps.hpp"

#include "host/core/error.hpp"
#include "host/log/time_stamps.hpp"

namespace furcula::log {

void accept_stamps(Log& log, const ColumnMap* map, double window_s) {
  constexpr double kRows = 5.0;  // of a window
  const TimeStamps stamps = judge(log, map);
  const bool chosen = window_s >= kRows * stamps.median_s;
  if (!stamps.unit.empty() && !chosen) throw core::DataError(stamps.unit);
  if (!stamps.bursts.empty()) throw core::DataError(stamps.bursts);
  log.notes.insert(log.notes.end(), stamps.notes.begin(), stamps.notes.end());
  open_gaps(log, stamps.gaps);
}

}  // namespace furcula::log
