// One Gaussian model of all windows: sensor noise, starts and disturbances with given variances, and what it says of the machine.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <vector>

#include "host/floating/linearised.hpp"

namespace furcula::floating {

/// Those with which the windows are most likely with the machine as it is, by expectation and maximisation from `from` on, for each window. They
/// hold what the machine does not explain, so that what is found beyond them stands out of the windows' own scatter. Variances of a window's
/// disturbances are drawn from a scaled inverse chi-squared distribution (Student's t over windows): a landing disturbs more than standing.
std::vector<Variances> estimated(const std::vector<LinearWindow>& windows, const Variances& from,
                                 unsigned threads);

/// A window's own unknowns integrated out: the part that does not depend on the point it was linearised about.
struct Marginal {
  Eigen::VectorXd row_sd, local_sd;  ///< of `y`, of `locals`
  Eigen::MatrixXd c;                 ///< of the window, rows and columns in these
  Eigen::LLT<Eigen::MatrixXd> m;     ///< 1 + c' c
  Eigen::MatrixXd information, ca;   ///< of theta, the lower half; L^-1 c' a, where L L' is m
};
/// Of one window, but for `information` and `ca`.
Marginal scaled(const LinearWindow& window, const Variances& variances);
std::vector<Marginal> marginals(const std::vector<LinearWindow>& windows, const Variances& variances,
                                unsigned threads);

/// Degrees of freedom of Student's t: of a window, of its disturbances' variances, and of its own value of a number.
inline constexpr double kFreedom = 4.0;

/// What the windows say of theta: information and score.
struct Evidence {
  Eigen::MatrixXd information;
  Eigen::VectorXd score;
};

/// Moves each window's own unknowns to where they are likeliest, the machine held: Levenberg and Marquardt's method from the attitude filter and from a
/// flat stance foot, whichever ends likelier; linearised at most so many times from the better start. @returns per window the sum of squares there, rows and unknowns in their standard deviations.
std::vector<double> fit_locals(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                               const Variances& variances, Point& point, const Settings& settings,
                               int derivatives = 15);

/// The same from where they are.
std::vector<double> refit_locals(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                                 const Variances& variances, Point& point, const Settings& settings);

/// Windows linearised in their own unknowns alone, and these integrated out.
struct Refitted {
  std::vector<LinearWindow> linear;
  std::vector<Marginal> own;
};
/// As refit_locals, from `also` where that is likelier; with what the windows are about there.
Refitted refit_linear(const std::vector<Recording>& recordings, const std::vector<Window>& windows,
                      const Variances& variances, const std::vector<Local>& also, Point& point,
                      const Settings& settings);

/// A window whose own unknowns were moved.
struct Moved {
  Eigen::VectorXd residual;
  double cost = 0.0;  ///< sum of squares, as of fit_locals
};
/// As refit_locals, along derivatives of a machine nearby; along new ones where a window's sum of squares is not below `before`.
std::vector<Moved> fit_locals_along(const std::vector<Recording>& recordings,
                                    const std::vector<Window>& windows,
                                    const std::vector<LinearWindow>& nearby,
                                    const std::vector<Marginal>& marginals, const std::vector<double>& before,
                                    const Variances& variances, Point& point, const Settings& settings);

/// Where the windows' own unknowns are likeliest at another theta, by the linear model.
std::vector<Local> locals_at(const std::vector<LinearWindow>& windows, const std::vector<Marginal>& marginals,
                             const Eigen::VectorXd& theta, const std::vector<Local>& from);

/// @param weights of the windows
Evidence evidence(const std::vector<LinearWindow>& windows, const std::vector<Marginal>& marginals,
                  const std::vector<double>& weights);

}  // namespace furcula::floating
