// What disturbs a robot, see disturbance.hpp.
#include "host/trees/disturbance.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/core/parallel.hpp"
#include "host/linear/linear.hpp"

namespace furcula::trees {
namespace {

using Index = Eigen::Index;

constexpr int kMostSteps = 40;
/// The estimate ends where a step gains less than so much of twice a logarithm of likelihood, a window.
constexpr double kSettled = 0.05;
/// A window whose squares are so many times the median counts less.
constexpr double kUnlike = 25.0;
constexpr auto kParts = static_cast<Index>(Disturbance::kTime_s.size());

/// Of one joint's torque in the parts of a window's time.
Eigen::MatrixXd correlation(Index part, Index times, double part_s) {
  const double time_s = Disturbance::kTime_s[static_cast<std::size_t>(part)];
  Eigen::MatrixXd out = Eigen::MatrixXd::Identity(times, times);
  for (Index a = 0; a < times && time_s > 0.0; ++a)
    for (Index b = 0; b < times; ++b)
      out(a, b) = std::exp(-static_cast<double>(std::abs(a - b)) * part_s / time_s);
  return out;
}

std::vector<Eigen::MatrixXd> correlations(Index times, double part_s) {
  std::vector<Eigen::MatrixXd> out;
  for (Index t = 0; t < kParts; ++t) out.push_back(correlation(t, times, part_s));
  return out;
}

Eigen::MatrixXd covariance(const Disturbance& d, const Eigen::MatrixXd& torques,
                           const std::vector<Eigen::MatrixXd>& correlations) {
  const Index n = d.noise.size(), times = correlations.front().rows();
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(torques.rows(), torques.rows());
  for (Index j = 0; j < n; ++j) {
    Eigen::MatrixXd of_joint = Eigen::MatrixXd::Zero(times, times);
    for (Index t = 0; t < kParts; ++t) of_joint += d.torque(j, t) * correlations[static_cast<std::size_t>(t)];
    const auto by = torques.middleCols(j * times, times);
    out.noalias() += by * of_joint * by.transpose();
  }
  for (Index row = 0; row < out.rows(); ++row) out(row, row) += d.noise(row % n);
  return out;
}

/// By how much each variance should be larger: squares that it accounts for, over what it would if it were right. The noise is last.
struct Parts {
  Eigen::MatrixXd squares, expected;
  double all = 0.0;  ///< of the residuals
};

Parts parts_of(const Disturbance& d, const DisturbedWindow& w,
               const std::vector<Eigen::MatrixXd>& correlations) {
  const Index n = d.noise.size(), times = correlations.front().rows();
  Parts out{Eigen::MatrixXd::Zero(n, kParts + 1), Eigen::MatrixXd::Zero(n, kParts + 1), 0.0};
  bool positive = false;
  const Eigen::MatrixXd inverse =
      linear::inverse_of_positive(w.starts + covariance(d, w.torques, correlations), &positive);
  if (!positive) return out;  // a run that flies apart tells nothing
  const Eigen::VectorXd x = inverse * w.left;
  out.all = x.dot(w.left);
  for (Index j = 0; j < n; ++j) {
    const auto by = w.torques.middleCols(j * times, times);
    const Eigen::VectorXd of_joint = by.transpose() * x;
    const Eigen::MatrixXd expected = by.transpose() * (inverse * by);
    for (Index t = 0; t < kParts; ++t) {
      const Eigen::MatrixXd& c = correlations[static_cast<std::size_t>(t)];
      out.squares(j, t) = of_joint.dot(Eigen::VectorXd(c * of_joint));
      out.expected(j, t) = expected.cwiseProduct(c).sum();
    }
    for (Index row = j; row < x.size(); row += n) {
      out.squares(j, kParts) += x(row) * x(row);
      out.expected(j, kParts) += inverse(row, row);
    }
  }
  return out;
}

/// @return what the step gains, about, of twice the logarithm of likelihood
double step(double& variance, double least, double squares, double expected) {
  if (!(expected > 0.0)) return 0.0;
  const double before = variance;
  variance = std::max(least, before * std::sqrt(squares / expected));
  return std::abs((variance - before) * (squares - expected));
}

}  // namespace

Eigen::MatrixXd covariance(const Disturbance& d, const Eigen::MatrixXd& torques, double part_s) {
  return covariance(d, torques, correlations(torques.cols() / d.noise.size(), part_s));
}

Disturbance estimate(Disturbance d, std::span<const DisturbedWindow> windows, double part_s,
                     const Eigen::VectorXd& least_noise, unsigned threads) {
  const Index n = d.noise.size();
  const std::vector<Eigen::MatrixXd> c = correlations(windows.front().torques.cols() / n, part_s);
  std::vector<Parts> parts(windows.size());
  for (int k = 0; k < kMostSteps; ++k) {
    core::parallel_for(windows.size(), threads,
                       [&](std::size_t i) { parts[i] = parts_of(d, windows[i], c); });
    std::vector<double> all;
    for (const Parts& p : parts) all.push_back(p.all);
    const auto middle = all.begin() + static_cast<std::ptrdiff_t>(all.size() / 2);
    std::nth_element(all.begin(), middle, all.end());
    Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(n, kParts + 1), expected = squares;
    for (const Parts& p : parts) {
      const double weight = std::min(1.0, kUnlike * *middle / std::max(p.all, 1e-300));
      squares += weight * p.squares;
      expected += weight * p.expected;
    }
    double gain = 0.0;
    for (Index j = 0; j < n; ++j) {
      for (Index t = 0; t < kParts; ++t) gain += step(d.torque(j, t), 0.0, squares(j, t), expected(j, t));
      gain += step(d.noise(j), least_noise(j), squares(j, kParts), expected(j, kParts));
    }
    if (gain < kSettled * static_cast<double>(windows.size())) break;
  }
  return d;
}

}  // namespace furcula::trees
