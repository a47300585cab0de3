// What disturbs a robot, by the likelihood of its windows.
//
// A window's residuals are the sum of what a random torque at each joint makes of its motion, of the encoders' noise, and of what is not
// known of its start. A random torque is a sum of parts, each with a correlation time of its own: they take the place of a spectrum.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

namespace furcula::trees {

struct Disturbance {
  /// Correlation times of the parts of a random torque, s; the first is shorter than anything that counts, the last longer than a window.
  static constexpr std::array kTime_s{0.0, 0.05, 0.5};

  Eigen::MatrixXd torque;  ///< variance, N^2 m^2: a row each joint, a column each part
  Eigen::VectorXd noise;   ///< variance of each joint's angle, rad^2
};

/// Residuals are joint by joint in each part of the window's time, as in Window::measured; torques are part by part at each joint.
struct DisturbedWindow {
  Eigen::MatrixXd torques;  ///< what a torque of 1 N m changes of the angles (Linearised::of_torques)
  Eigen::MatrixXd starts;   ///< covariance of the angles by what is not known of the start
  Eigen::VectorXd left;     ///< residuals, rad
};

/// Covariance of a window's angles by the disturbance, without its start. `part_s`: length of one part of its time.
Eigen::MatrixXd covariance(const Disturbance& d, const Eigen::MatrixXd& torques, double part_s);

/// The disturbance with the largest likelihood, by minorisation and maximisation (Zhou, Hu, Zhou, Lange, Journal of Computational and
/// Graphical Statistics 28(2), 2019) from `start`. `least_noise`: variances that the noise does not go below.
Disturbance estimate(Disturbance start, std::span<const DisturbedWindow> windows, double part_s,
                     const Eigen::VectorXd& least_noise, unsigned threads);

}  // namespace furcula::trees
