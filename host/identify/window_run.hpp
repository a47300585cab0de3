// One free run of a window: residuals against what was measured, and their derivatives by the unknowns and the window's start state.
// Each number type is compiled once, as in simulate.hpp.
#pragma once

#include <cstddef>
#include <vector>

#include "host/identify/dual.hpp"
#include "host/identify/recording.hpp"
#include "host/identify/unknowns.hpp"
#include "host/identify/windows.hpp"

namespace furcula::identify {

/// Position and velocity.
inline constexpr int kStartSize = 2;

struct Weights {
  double position = 0.0;
  double velocity = 0.0;  ///< 0: not used
  double contact = 0.0;   ///< 0: not used
  double drive = 0.0;     ///< 0: not used
  double leg = 0.0;       ///< 0: not used
};

struct WindowRun {
  const model::Model& model;
  const std::vector<Unknown>& unknowns;
  const Recording& recording;
  const Window& window;
  Weights weights;

  // Residuals of each kind, in this order.
  std::size_t motion_rows() const { return window.rows() * (weights.velocity > 0.0 ? 2 : 1); }
  std::size_t contact_rows() const { return weights.contact > 0.0 ? 1 : 0; }
  std::size_t drive_rows() const { return weights.drive > 0.0 ? window.rows() - 1 : 0; }
  std::size_t leg_rows() const { return weights.leg > 0.0 ? window.rows() : 0; }
};

/// `blocks`: the unknowns (absent if there are none), then the start state. `jacobians`, one a block and row by row, may be null, and so
/// may each of them. False where the run does not stay finite.
template <class T>
bool run_window(const WindowRun& run, double const* const* blocks, double* residuals, double** jacobians);

/// Of numbers that stand row by row.
void take_off_column_means(double* values, std::size_t rows, std::size_t columns);

}  // namespace furcula::identify
