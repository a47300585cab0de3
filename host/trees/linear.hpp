// Linear problems whose columns are of very different size, and means over recordings.
#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>

namespace furcula::trees {

/// Of fits and tests on columns of simulated motion: far below what recordings tell, far above rounding.
inline constexpr double kRidge = 1e-7;

/// A normal matrix with its columns scaled to one, and a ridge beside them: what no recording tells apart stays small.
class ScaledNormal {
 public:
  /// A column counts as no shorter than `least` times the longest, squared lengths both.
  ScaledNormal(const Eigen::MatrixXd& normal, double ridge, double least = 0.0)
      : unit_(normal.diagonal()
                  .cwiseMax(normal.size() == 0 ? 0.0 : least * normal.diagonal().maxCoeff())
                  .cwiseMax(1e-300)
                  .cwiseSqrt()
                  .cwiseInverse()),
        solver_(unit_.asDiagonal() * normal * unit_.asDiagonal() +
                ridge * Eigen::MatrixXd::Identity(normal.rows(), normal.cols())) {}

  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const {
    return unit_.asDiagonal() * solver_.solve(unit_.asDiagonal() * right);
  }
  Eigen::MatrixXd inverse() const { return solve(Eigen::MatrixXd::Identity(unit_.size(), unit_.size())); }

 private:
  Eigen::VectorXd unit_;
  Eigen::LDLT<Eigen::MatrixXd> solver_;
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
