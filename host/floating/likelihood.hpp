// One Gaussian model of all windows: sensor noise, starts and disturbances with variances that are estimated, and what it says of the machine.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "host/floating/linearised.hpp"

namespace furcula::floating {

struct Variances {
  std::array<double, kNoiseGroups> noise{};
  std::array<double, kLocalGroups> local{};
  double tables = 1e-4;  ///< of the tables' numbers, in units of their priors' variances
};
Variances first_variances();

/// Everything that the windows say of theta: information G, score g, and the log-likelihood at theta = 0 (a constant left out).
struct Evidence {
  Eigen::MatrixXd information;
  Eigen::VectorXd score;
  double log_likelihood = 0.0;
};

/// One window's own unknowns, given theta.
struct LocalPosterior {
  Eigen::VectorXd mean;  ///< of LinearWindow::locals
  double weight = 1.0;   ///< of the window: below 1 where it is further off than its model says
};

/// Moves each window's own unknowns to where they are likeliest, the machine held: Levenberg and Marquardt's method from up to three starts.
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

/// One step of expectation-maximisation: variances from what windows and theta (mean, covariance) say. Fills posteriors and weights.
Variances maximised(const std::vector<LinearWindow>& windows, const Variances& variances,
                    const Eigen::VectorXd& theta, std::vector<LocalPosterior>& posteriors, unsigned threads);

}  // namespace furcula::floating
