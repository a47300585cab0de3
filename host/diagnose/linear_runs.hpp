// Free runs over windows, linearised: what a small force at any instant does to the positions after it.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

#include "host/identify/recording.hpp"
#include "host/identify/windows.hpp"
#include "host/model/model.hpp"

namespace furcula::diagnose {

/// What a force may hang on, in one row of a free run. SI units.
struct RunSample {
  double position = 0, velocity = 0, acceleration = 0, input = 0, input_rate = 0, input_before = 0,
         time_s = 0;
  double since_touchdown_s = -1, since_liftoff_s = -1;  ///< below 0: not since then
  /// Means over the past of the position, of a hopper of its leg's compression; the last with the longest memory.
  std::array<double, 3> remembered{};
};

/// A free run over a window, and what small changes do to it: state i + 1 is by[i] times state i and force[i] times a force in between.
struct LinearRun {
  std::size_t recording = 0;  ///< index of the window's
  double interval_s = 0;      ///< mean time from row to row
  double noise = 0;           ///< standard deviation of the measured position
  std::vector<double> left;   ///< measured less run
  std::vector<Eigen::Matrix2d> by;
  std::vector<Eigen::Vector2d> force;
  std::vector<double> impact_speed;  ///< speed before an impact between row i and the next; 0: none
  std::vector<RunSample> samples;
};

/// From the start state that fits best, up to where the machine is stuck. Nothing where that leaves too few rows.
std::optional<LinearRun> linearised(const model::Model& model, const identify::Recording& r,
                                    const identify::Window& w);

/// Of all windows that have one.
std::vector<LinearRun> linearised(const model::Model& model,
                                  const std::vector<identify::Recording>& recordings,
                                  const std::vector<identify::Window>& windows);

/// The weight, or the input's root mean square; of what is thrown, what gives it its acceleration. With what it is, in words. N or N m.
std::pair<double, const char*> typical_force(const model::Model& model, const std::vector<LinearRun>& runs);

}  // namespace furcula::diagnose
