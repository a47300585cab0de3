// run_window() for any number type, to be instantiated.
#pragma once

#include <cmath>
#include <type_traits>

#include "host/identify/simulate_impl.hpp"
#include "host/identify/window_run.hpp"
#include "host/machines/hopper.hpp"

namespace furcula::identify {

template <class T>
bool run_window(const WindowRun& run, double const* const* blocks, double* residuals, double** jacobians) {
  const bool by_start_alone = run.unknowns.empty() || jacobians == nullptr || jacobians[0] == nullptr;
  const std::size_t count = by_start_alone ? 0 : run.unknowns.size();  // that derivatives are asked by
  const double* start = blocks[run.unknowns.empty() ? 0 : 1];
  std::vector<T> values(run.unknowns.size());
  T position(start[0]), velocity(start[1]);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = T(blocks[0][i]);
  if constexpr (!std::is_same_v<T, double>) {
    for (std::size_t i = 0; i < count; ++i) values[i].set(i, 1.0);
    position.set(count, 1.0);
    velocity.set(count + 1, 1.0);
  }
  const PlantSetup<T> setup(run.model, run.unknowns, values.data());
  bool finite = true;
  double* of_unknowns = by_start_alone ? nullptr : jacobians[0];
  double* of_start = jacobians != nullptr ? jacobians[run.unknowns.empty() ? 0 : 1] : nullptr;
  const auto put = [&](std::size_t at, const T& simulated, double measured, double weight) {
    residuals[at] = (dynamics::value_of(simulated) - measured) * weight;
    finite = finite && std::isfinite(residuals[at]);
    if constexpr (!std::is_same_v<T, double>) {
      if (of_unknowns != nullptr)
        for (std::size_t i = 0; i < count; ++i)
          of_unknowns[at * count + i] = simulated.derivative(i) * weight;
      if (of_start != nullptr)
        for (std::size_t i = 0; i < kStartSize; ++i)
          of_start[at * kStartSize + i] = simulated.derivative(count + i) * weight;
    }
  };
  std::size_t motion = 0, drives = run.motion_rows() + run.contact_rows();
  const std::size_t first_leg = drives + run.drive_rows();
  std::size_t legs = first_leg;
  detail::run_through(setup, run.recording, run.window, position, velocity,
                      [&](std::size_t row, const T& x, const T& v, const T& drive, const auto& leg_angle) {
                        put(motion++, x, run.recording.position[row], run.weights.position);
                        if (run.weights.velocity > 0.0)
                          put(motion++, v, run.recording.velocity_smoothed[row], run.weights.velocity);
                        if (run.weights.drive > 0.0 && row < run.window.last)
                          put(drives++, drive, run.recording.drive[row], run.weights.drive);
                        if (run.weights.leg > 0.0)
                          put(legs++, leg_angle(), run.recording.leg_angle[row], run.weights.leg);
                      });
  if (legs > first_leg) {
    const auto about_mean = [&](double* of, std::size_t columns) {
      take_off_column_means(of + first_leg * columns, legs - first_leg, columns);
    };
    about_mean(residuals, 1);
    if (of_unknowns != nullptr) about_mean(of_unknowns, count);
    if (of_start != nullptr) about_mean(of_start, kStartSize);
  }
  if (run.weights.contact > 0.0)
    put(run.motion_rows(),
        report_lag(setup, run.recording, run.window, machines::touchdown_height_m(run.model)),
        run.window.report_lag_s, run.weights.contact);
  return finite;
}

}  // namespace furcula::identify
