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
  /// All that it goes on from.
  struct State {
    std::size_t population = 4;
    std::uint64_t seed = 1, generation = 0, decomposed = 0;
    double sigma = 0.0;
    Eigen::VectorXd mean, path, path_sigma, axes;
    Eigen::MatrixXd covariance, directions;
  };

  /// Of `population` points a generation, at least 4. A seed gives one sequence of points for one sequence of values.
  CmaEs(const Eigen::VectorXd& mean, double sigma, std::size_t population, std::uint64_t seed);
  explicit CmaEs(State state);

  /// The points of the next generation; the same ones until it is told.
  const std::vector<Eigen::VectorXd>& ask();
  /// Their values, the least best; a tie is the earlier point's. What is not a number is the worst.
  void tell(std::span<const double> values);

  const State& state() const { return s_; }
  const Eigen::VectorXd& mean() const { return s_.mean; }
  double sigma() const { return s_.sigma; }
  /// The longest axis of the points' ellipsoid, one standard deviation.
  double spread() const { return s_.sigma * s_.axes.maxCoeff(); }
  std::uint64_t generation() const { return s_.generation; }

 private:
  void decompose();

  State s_;
  Eigen::VectorXd weights_;
  double mu_eff_, c_path_, c_sigma_, c_one_, c_mu_, damping_, expected_;
  std::vector<Eigen::VectorXd> steps_, points_;
};

}  // namespace furcula::walk
