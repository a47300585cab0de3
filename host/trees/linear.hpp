// Linear problems whose columns are of very different size, and means over recordings.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>

namespace furcula::trees {

/// Of fits and tests on columns of simulated motion: far below what recordings tell, far above rounding.
inline constexpr double kRidge = 1e-7;

/// A normal matrix with its columns scaled to one, and a ridge beside them: what no recording tells apart stays small.
class ScaledNormal {
 public:
  /// A column counts as no shorter than `least` times the longest, squared lengths both.
  ScaledNormal(const Eigen::MatrixXd& normal, double ridge, double least = 0.0);

  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  Eigen::MatrixXd inverse() const { return solve(Eigen::MatrixXd::Identity(unit_.size(), unit_.size())); }

 private:
  Eigen::VectorXd unit_;
  Eigen::MatrixXd scaled_;
};

/// One number, estimated from each of several recordings.
struct Mean {
  double value = 0.0;
  double variance = 0.0;  ///< of the mean, from the scatter of the estimates
  /// How many recordings could contradict it: about their number less one, 0 where one has all of the information.
  double freedom = 0.0;
};
/// Weighed by information, one over each estimate's variance. Without any information all is 0.
Mean weighted_mean(std::span<const double> value, std::span<const double> information);

/// The mean over its standard deviation, over what chance alone may reach. Above 1 the recordings agree that it is not zero.
double steadiness(std::span<const double> value, std::span<const double> information);

}  // namespace furcula::trees
