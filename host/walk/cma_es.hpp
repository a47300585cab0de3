// Evolution strategy with covariance matrix adaptation (Hansen, "The CMA Evolution Strategy: A Tutorial", arXiv:1604.00772, 2016), asked
// for points and told their values, so that a whole generation runs at once.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace furcula::walk {

class CmaEs {
 public:
  /// Of `population` points a generation, at least 4. A seed gives one sequence of points for one sequence of values.
  CmaEs(const Eigen::VectorXd& mean, double sigma, std::size_t population, std::uint64_t seed);

  /// The points of the next generation.
  const std::vector<Eigen::VectorXd>& ask();
  /// Their values, the least best; a tie is the earlier point's. What is not a number is the worst.
  void tell(std::span<const double> values);

  const Eigen::VectorXd& mean() const { return mean_; }
  double sigma() const { return sigma_; }
  /// The longest axis of the points' ellipsoid, one standard deviation.
  double spread() const { return sigma_ * axes_.maxCoeff(); }
  std::uint64_t generation() const { return generation_; }

 private:
  void decompose();

  std::size_t population_;
  std::uint64_t seed_, generation_ = 0, decomposed_ = 0;
  Eigen::VectorXd weights_;
  double mu_eff_, c_path_, c_sigma_, c_one_, c_mu_, damping_, expected_;
  Eigen::VectorXd mean_, path_, path_sigma_, axes_;
  Eigen::MatrixXd covariance_, directions_;
  double sigma_;
  std::vector<Eigen::VectorXd> steps_, points_;
};

}  // namespace furcula::walk
