#include "host/walk/cma_es.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "host/core/random.hpp"

namespace furcula::walk {

CmaEs::CmaEs(const Eigen::VectorXd& mean, double sigma, std::size_t population, std::uint64_t seed)
    : CmaEs([&] {
        State s;
        s.population = population;
        s.seed = seed;
        s.sigma = sigma;
        s.mean = mean;
        s.path = s.path_sigma = Eigen::VectorXd::Zero(mean.size());
        s.covariance = s.directions = Eigen::MatrixXd::Identity(mean.size(), mean.size());
        s.axes = Eigen::VectorXd::Ones(mean.size());
        return s;
      }()) {}

CmaEs::CmaEs(State state) : s_(std::move(state)) {
  s_.population = std::max<std::size_t>(s_.population, 4);
  const auto n = static_cast<double>(s_.mean.size());
  const Eigen::Index half = static_cast<Eigen::Index>(s_.population / 2);
  weights_.resize(half);
  for (Eigen::Index i = 0; i < half; ++i)
    weights_(i) =
        std::log(0.5 * static_cast<double>(s_.population + 1)) - std::log(static_cast<double>(i + 1));
  weights_ /= weights_.sum();
  mu_eff_ = 1.0 / weights_.squaredNorm();
  c_path_ = (4.0 + mu_eff_ / n) / (n + 4.0 + 2.0 * mu_eff_ / n);
  c_sigma_ = (mu_eff_ + 2.0) / (n + mu_eff_ + 5.0);
  c_one_ = 2.0 / ((n + 1.3) * (n + 1.3) + mu_eff_);
  c_mu_ = std::min(1.0 - c_one_, 2.0 * (mu_eff_ - 2.0 + 1.0 / mu_eff_) / ((n + 2.0) * (n + 2.0) + mu_eff_));
  damping_ = 1.0 + 2.0 * std::max(0.0, std::sqrt((mu_eff_ - 1.0) / (n + 1.0)) - 1.0) + c_sigma_;
  expected_ = std::sqrt(n) * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
}

/// Not each generation: an eigenvalue takes n^3, and the matrix changes slowly.
void CmaEs::decompose() {
  const double every = 1.0 / (10.0 * static_cast<double>(s_.mean.size()) * (c_one_ + c_mu_));
  if (static_cast<double>(s_.generation - s_.decomposed) < every) return;
  s_.decomposed = s_.generation;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(s_.covariance);
  s_.directions = solver.eigenvectors();
  s_.axes = solver.eigenvalues().cwiseMax(1e-20).cwiseSqrt();
}

const std::vector<Eigen::VectorXd>& CmaEs::ask() {
  decompose();
  core::Random random(s_.seed, s_.generation);
  steps_.resize(s_.population);
  points_.resize(s_.population);
  for (std::size_t k = 0; k < s_.population; ++k) {
    Eigen::VectorXd z(s_.mean.size());
    for (double& x : z) x = random.gaussian();
    steps_[k] = s_.directions * s_.axes.cwiseProduct(z);
    points_[k] = s_.mean + s_.sigma * steps_[k];
  }
  return points_;
}

void CmaEs::tell(std::span<const double> values) {
  std::vector<std::size_t> order(s_.population);
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto rank = [&](std::size_t i) {
    return std::isnan(values[i]) ? std::numeric_limits<double>::infinity() : values[i];
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });

  Eigen::VectorXd step = Eigen::VectorXd::Zero(s_.mean.size());
  for (Eigen::Index i = 0; i < weights_.size(); ++i)
    step += weights_(i) * steps_[order[static_cast<std::size_t>(i)]];
  s_.mean += s_.sigma * step;
  ++s_.generation;
  const Eigen::VectorXd white =
      s_.directions * s_.axes.cwiseInverse().cwiseProduct(s_.directions.transpose() * step);
  s_.path_sigma = (1.0 - c_sigma_) * s_.path_sigma + std::sqrt(c_sigma_ * (2.0 - c_sigma_) * mu_eff_) * white;
  const double length = s_.path_sigma.norm() /
                        std::sqrt(1.0 - std::pow(1.0 - c_sigma_, 2.0 * static_cast<double>(s_.generation)));
  const double moves =
      length < (1.4 + 2.0 / (static_cast<double>(s_.mean.size()) + 1.0)) * expected_ ? 1.0 : 0.0;
  s_.path = (1.0 - c_path_) * s_.path + moves * std::sqrt(c_path_ * (2.0 - c_path_) * mu_eff_) * step;
  s_.covariance *= 1.0 - c_one_ - c_mu_ + (1.0 - moves) * c_one_ * c_path_ * (2.0 - c_path_);
  s_.covariance += c_one_ * s_.path * s_.path.transpose();
  for (Eigen::Index i = 0; i < weights_.size(); ++i) {
    const Eigen::VectorXd& s = steps_[order[static_cast<std::size_t>(i)]];
    s_.covariance += c_mu_ * weights_(i) * s * s.transpose();
  }
  s_.sigma *= std::exp(c_sigma_ / damping_ * (s_.path_sigma.norm() / expected_ - 1.0));
}

}  // namespace furcula::walk
