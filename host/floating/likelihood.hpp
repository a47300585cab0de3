// One Gaussian model of all windows: sensor noise, starts and disturbances with given variances, and what it says of the machine.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "host/floating/linearised.hpp"

namespace furcula::floating {

struct Variances {
  std::array<double, kNoiseGroups> noise{};
  std::array<double, kLocalGroups> local{};
};
Variances first_variances();

/// Those with which the windows are most likely with the machine as it is, by expectation and maximisation from `from` on. They hold what
/// the machine does not explain, so that what is found beyond them stands out of the windows' own scatter.
Variances estimated(const std::vector<LinearWindow>& windows, const Variances& from, unsigned threads);

/// What the windows say of theta: information and score.
struct Evidence {
  Eigen::MatrixXd information;
  Eigen::VectorXd score;
};

/// Moves each window's own unknowns to where they are likeliest, the machine held: Levenberg and Marquardt's method from the attitude filter and from a flat stance foot, or from where they are.
/// @returns per window the sum of squares there, rows and unknowns in their standard deviations.
std::vector<double> fit_locals(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                               const Variances& variances, bool from_scratch, Point& point,
                               const Settings& settings, int steps = 12);

/// Where the windows' own unknowns are likeliest at another theta, by the linear model.
std::vector<Local> locals_at(const std::vector<LinearWindow>& windows, const Variances& variances,
                             const Eigen::VectorXd& theta, const std::vector<Local>& from);

/// @param weights of the windows
Evidence evidence(const std::vector<LinearWindow>& windows, const Variances& variances,
                  const std::vector<double>& weights, unsigned threads);

}  // namespace furcula::floating
