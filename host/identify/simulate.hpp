// Runs a model free over a window of a recording, on the recorded input held from row to row.
//
// The plants of every machine in one number type take a compiler ten seconds and more. So each number type is compiled once
// (window_run_of.cpp.in), and who runs a model sees no plant.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <type_traits>
#include <vector>

#include "host/identify/recording.hpp"
#include "host/identify/unknowns.hpp"
#include "host/identify/windows.hpp"

namespace furcula::identify {

/// What would be measured in a row, what the drive's current would show (of the last row: the command), and a function that gives
/// the leg's angle (0 where there is none).
template <class T>
using VisitRow = std::function<void(std::size_t row, const T& position, const T& velocity, const T& drive,
                                    const std::function<T()>& leg_angle)>;
template <class T>
using VisitStep = std::function<void(std::size_t row, const T& position, const T& velocity)>;

/// Starts at the measured (position, velocity) and visits each row of the window.
template <class T>
void simulate(const PlantSetup<T>& setup, const Recording& r, const Window& w,
              const std::type_identity_t<T>& position, const std::type_identity_t<T>& velocity,
              const VisitRow<std::type_identity_t<T>>& visit);

/// From the measured state of each row of the window a step to the next row: visits with what would be measured there, for the
/// rows after the first.
template <class T>
void one_step_each(const PlantSetup<T>& setup, const Recording& r, const Window& w,
                   const VisitStep<std::type_identity_t<T>>& visit);

/// How much later than the measured height falls through the model's touch-down height the contact switch
/// reports, in this model.
template <class T>
T report_lag(const PlantSetup<T>& setup, const Recording& r, const Window& w, double touchdown_height_m);

/// What reaches the plant in each row but the last.
std::vector<double> inputs(const PlantSetup<double>& setup, const Recording& r);

/// The acceleration that would be measured at a measured position and velocity under a held input, read off a step of `probe_s`. By
/// row `row` of the recording slips and a led leg are known.
double acceleration(const PlantSetup<double>& setup, const Recording& r, double position, double velocity,
                    double input, double probe_s, std::optional<std::size_t> row = {});

namespace detail {

/// The last row up to `first` at which the coil has been on for so long that the key is out whatever was before;
/// nothing where there is none.
inline std::optional<std::size_t> surely_out(const Recording& r, std::size_t first, double on_for_s) {
  std::size_t end = first;
  for (std::size_t i = first; i-- > 0;) {
    if (r.solenoid[i] == 0.0)
      end = i;
    else if (r.time_s[end] - r.time_s[i] > on_for_s)
      return end;
  }
  return std::nullopt;
}

/// The last row up to `row` that has an input; the first where there is none.
inline std::size_t last_driven(const Recording& r, std::size_t row) {
  if (r.input[row] != 0.0) return row;
  const auto since = std::lower_bound(r.driven_s.begin(),
                                      r.driven_s.begin() + static_cast<std::ptrdiff_t>(row), r.driven_s[row]);
  return since == r.driven_s.begin() ? 0 : static_cast<std::size_t>(since - r.driven_s.begin()) - 1;
}

}  // namespace detail

}  // namespace furcula::identify
