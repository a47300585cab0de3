#include "host/walk/cma_es.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "host/core/random.hpp"

namespace furcula::walk {

CmaEs::CmaEs(const Eigen::VectorXd& mean, double sigma, std::size_t population, std::uint64_t seed)
    : population_(std::max<std::size_t>(population, 4)), seed_(seed), mean_(mean), sigma_(sigma) {
  const auto n = static_cast<double>(mean.size());
  const Eigen::Index half = static_cast<Eigen::Index>(population_ / 2);
  weights_.resize(half);
  for (Eigen::Index i = 0; i < half; ++i)
    weights_(i) = std::log(0.5 * static_cast<double>(population_ + 1)) - std::log(static_cast<double>(i + 1));
  weights_ /= weights_.sum();
  mu_eff_ = 1.0 / weights_.squaredNorm();
  c_path_ = (4.0 + mu_eff_ / n) / (n + 4.0 + 2.0 * mu_eff_ / n);
  c_sigma_ = (mu_eff_ + 2.0) / (n + mu_eff_ + 5.0);
  c_one_ = 2.0 / ((n + 1.3) * (n + 1.3) + mu_eff_);
  c_mu_ = std::min(1.0 - c_one_, 2.0 * (mu_eff_ - 2.0 + 1.0 / mu_eff_) / ((n + 2.0) * (n + 2.0) + mu_eff_));
  damping_ = 1.0 + 2.0 * std::max(0.0, std::sqrt((mu_eff_ - 1.0) / (n + 1.0)) - 1.0) + c_sigma_;
  expected_ = std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
  path_ = path_sigma_ = Eigen::VectorXd::Zero(mean.size());
  covariance_ = directions_ = Eigen::MatrixXd::Identity(mean.size(), mean.size());
  axes_ = Eigen::VectorXd::Ones(mean.size());
}

/// Not each generation: an eigenvalue takes n^3, and the matrix changes slowly.
void CmaEs::decompose() {
  const double every = 1.0 / (10.0 * static_cast<double>(mean_.size()) * (c_one_ + c_mu_));
  if (static_cast<double>(generation_ - decomposed_) < every) return;
  decomposed_ = generation_;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance_);
  directions_ = solver.eigenvectors();
  axes_ = solver.eigenvalues().cwiseMax(1e-20).cwiseSqrt();
}

const std::vector<Eigen::VectorXd>& CmaEs::ask() {
  decompose();
  core::Random random(seed_, generation_);
  steps_.resize(population_);
  points_.resize(population_);
  for (std::size_t k = 0; k < population_; ++k) {
    Eigen::VectorXd z(mean_.size());
    for (double& x : z) x = random.gaussian();
    steps_[k] = directions_ * axes_.cwiseProduct(z);
    points_[k] = mean_ + sigma_ * steps_[k];
  }
  return points_;
}

void CmaEs::tell(std::span<const double> values) {
  std::vector<std::size_t> order(population_);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto rank = [&](std::size_t i) {
    return std::isnan(values[i]) ? std::numeric_limits<double>::infinity() : values[i];
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });

  Eigen::VectorXd step = Eigen::VectorXd::Zero(mean_.size());
  for (Eigen::Index i = 0; i < weights_.size(); ++i)
    step += weights_(i) * steps_[order[static_cast<std::size_t>(i)]];
  mean_ += sigma_ * step;
  ++generation_;
  const Eigen::VectorXd white =
      directions_ * axes_.cwiseInverse().cwiseProduct(directions_.transpose() * step);
  path_sigma_ = (1.0 - c_sigma_) * path_sigma_ + std::sqrt(c_sigma_ * (2.0 - c_sigma_) * mu_eff_) * white;
  const double length =
      path_sigma_.norm() / std::sqrt(1.0 - std::pow(1.0 - c_sigma_, 2.0 * static_cast<double>(generation_)));
  const double moves =
      length < (1.4 + 2.0 / (static_cast<double>(mean_.size()) + 1.0)) * expected_ ? 1.0 : 0.0;
  path_ = (1.0 - c_path_) * path_ + moves * std::sqrt(c_path_ * (2.0 - c_path_) * mu_eff_) * step;
  covariance_ *= 1.0 - c_one_ - c_mu_ + (1.0 - moves) * c_one_ * c_path_ * (2.0 - c_path_);
  covariance_ += c_one_ * path_ * path_.transpose();
  for (Eigen::Index i = 0; i < weights_.size(); ++i) {
    const Eigen::VectorXd& s = steps_[order[static_cast<std::size_t>(i)]];
    covariance_ += c_mu_ * weights_(i) * s * s.transpose();
  }
  sigma_ *= std::exp(c_sigma_ / damping_ * (path_sigma_.norm() / expected_ - 1.0));
}

}  // namespace furcula::walk
