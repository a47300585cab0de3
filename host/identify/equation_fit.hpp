// Equation-error least squares: the unknowns that make one step of the model, from each measured state, meet
// the next measured state.
#pragma once

#include <vector>

#include "host/identify/simulation_fit.hpp"

namespace furcula::identify {

/// Fits the unknowns from `start` on the rows inside the windows, each step from the measured position and
/// the smoothed velocity; positions and velocities weighted by the window's spread as in 002 eq. 4.4. Noise
/// in the states biases this estimator (002 section 4.2 reports both): it is quick, needs no good start, and
/// is reported beside the other. `layers`: in how many of the windows each row lies.
Fit fit_by_equation(const model::Model& model, const std::vector<Unknown>& unknowns,
                    const std::vector<double>& start, const std::vector<Recording>& recordings,
                    const std::vector<Window>& windows, std::size_t layers = 1);

}  // namespace furcula::identify
