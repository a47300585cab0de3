// One free run of a window: residuals against what was measured, and their derivatives by the unknowns and the window's start state.
//
// Each number type takes a compiler ten seconds and more, so each is compiled in a file of its own (window_run_of.cpp.in).
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

extern template bool run_window<double>(const WindowRun&, double const* const*, double*, double**);
extern template bool run_window<Dual<2>>(const WindowRun&, double const* const*, double*, double**);
extern template bool run_window<Dual<4>>(const WindowRun&, double const* const*, double*, double**);
extern template bool run_window<Dual<6>>(const WindowRun&, double const* const*, double*, double**);
extern template bool run_window<Dual<8>>(const WindowRun&, double const* const*, double*, double**);
extern template bool run_window<Dual<10>>(const WindowRun&, double const* const*, double*, double**);
extern template bool run_window<Dual<12>>(const WindowRun&, double const* const*, double*, double**);
extern template bool run_window<Dual<20>>(const WindowRun&, double const* const*, double*, double**);
extern template bool run_window<Dual<32>>(const WindowRun&, double const* const*, double*, double**);

/// Of numbers that stand row by row.
void take_off_column_means(double* values, std::size_t rows, std::size_t columns);

}  // namespace furcula::identify
