#include "host/identify/statistics.hpp"

#include <algorithm>
#include <cmath>

#include "host/linear/linear.hpp"

namespace furcula::identify {

double effective_count(const Eigen::Ref<const Eigen::VectorXd>& residual) {
  const auto rows = residual.size();
  const double variance = residual.squaredNorm();
  if (!(variance > 0.0)) return static_cast<double>(rows);
  double time = 1.0;
  // Of long windows not at each lag: by a thirty-second part further each time, so that it is no matter of the rows' square.
  constexpr Eigen::Index kEachLag = 2048, kPart = 32;
  for (Eigen::Index lag = 1, step = 1; lag < rows / 2; lag += step) {
    const double correlation = residual.head(rows - lag).dot(residual.tail(rows - lag)) / variance;
    if (correlation < 0.05) break;
    if (rows > kEachLag) step = std::max<Eigen::Index>(1, lag / kPart);
    time += 2.0 * correlation * static_cast<double>(step);
  }
  return static_cast<double>(rows) / time;
}

double independent_windows(std::size_t windows, std::size_t layers) {
  return static_cast<double>(windows) / static_cast<double>(layers);
}

Eigen::MatrixXd jackknife_covariance(const std::vector<WindowShare>& shares,
                                     const std::vector<bool>& at_bound, std::size_t layers) {
  const auto count = static_cast<Eigen::Index>(at_bound.size());
  std::vector<Eigen::Index> moving;
  for (Eigen::Index i = 0; i < count; ++i)
    if (!at_bound[static_cast<std::size_t>(i)]) moving.push_back(i);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  const auto free = static_cast<Eigen::Index>(moving.size());
  if (free == 0 || shares.empty()) return covariance;
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(free, free);
  for (const WindowShare& share : shares) information += share.information(moving, moving);
  // Coordinates in which the information is one: scaled to a unit diagonal first, since the unknowns have different units.
  Eigen::VectorXd scale(free);
  for (Eigen::Index i = 0; i < free; ++i)
    scale(i) = information(i, i) > 0.0 ? 1.0 / std::sqrt(information(i, i)) : 0.0;
  const linear::Axes axes = linear::axes(scale.asDiagonal() * information * scale.asDiagonal());
  static constexpr double kMostAlone = 0.95;
  constexpr double kNothing = 1e-13;  // of the largest: a direction of which the windows tell nothing
  const double least = kNothing * axes.values.maxCoeff();
  const Eigen::MatrixXd to_unit =
      axes.values.unaryExpr([&](double x) { return x > least ? 1.0 / std::sqrt(x) : 0.0; }).asDiagonal() *
      axes.vectors.transpose() * scale.asDiagonal();
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(free, free), own = scatter;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(free), before = Eigen::VectorXd::Zero(free);
  for (std::size_t w = 0; w < shares.size(); ++w) {
    sum += shares[w].gradient(moving);
    own += shares[w].information(moving, moving);
    if ((w + 1) % layers != 0 && w + 1 != shares.size()) continue;
    // By how much the estimate moves without these windows: what they alone tell they also pull to themselves.
    const linear::Axes alone = linear::axes(to_unit * own * to_unit.transpose());
    const Eigen::VectorXd moves =
        alone.vectors *
        alone.values.unaryExpr([](double x) { return 1.0 / (1.0 - std::min(x, kMostAlone)); }).asDiagonal() *
        alone.vectors.transpose() * (to_unit * sum);
    scatter += moves * moves.transpose();
    if (layers > 1) scatter += 0.5 * (moves * before.transpose() + before * moves.transpose());
    before = moves;
    sum.setZero();
    own.setZero();
  }
  const double windows = independent_windows(shares.size(), layers);
  const Eigen::MatrixXd small =
      to_unit.transpose() * scatter * to_unit * (std::max(windows - 1.0, 1.0) / std::max(windows, 1.0));
  for (Eigen::Index i = 0; i < free; ++i)
    for (Eigen::Index k = 0; k < free; ++k)
      covariance(moving[static_cast<std::size_t>(i)], moving[static_cast<std::size_t>(k)]) = small(i, k);
  return covariance;
}

}  // namespace furcula::identify
