// The legs of document 001 for tests.
#pragma once

#include "host/gait/gait.hpp"
#include "host/gait/search.hpp"

namespace furcula::test {

inline gait::Task in_place(double clearance_m) {
  gait::Task task;
  task.clearance_m = clearance_m;
  return task;
}
inline gait::Task forward(double speed_mps) {
  gait::Task task;
  task.speed_mps = speed_mps;
  return task;
}
/// One start from the plain hop.
inline gait::Search found(gait::LegSpring spring, const gait::Task& task, bool fourier = false) {
  gait::Query query;
  query.machine = gait::spear(spring);
  query.task = task;
  query.fourier = fourier;
  query.starts = 1;
  return gait::find_gait(query);
}

}  // namespace furcula::test
