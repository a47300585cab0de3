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

LeavingOut::LeavingOut(const std::vector<WindowShare>& shares, const std::vector<bool>& at_bound)
    : count_(static_cast<Eigen::Index>(at_bound.size())) {
  for (Eigen::Index i = 0; i < count_; ++i)
    if (!at_bound[static_cast<std::size_t>(i)]) moving_.push_back(i);
  const auto free = static_cast<Eigen::Index>(moving_.size());
  if (free == 0) return;
  information_ = Eigen::MatrixXd::Zero(free, free);
  for (const WindowShare& share : shares) information_ += share.information(moving_, moving_);
  // Coordinates in which the information is one: scaled to a unit diagonal first, since the unknowns have different units.
  Eigen::VectorXd scale(free);
  for (Eigen::Index i = 0; i < free; ++i)
    scale(i) = information_(i, i) > 0.0 ? 1.0 / std::sqrt(information_(i, i)) : 0.0;
  const linear::Axes axes = linear::axes(scale.asDiagonal() * information_ * scale.asDiagonal());
  constexpr double kNothing = 1e-13;  // of the largest: a direction of which the windows tell nothing
  const double least = kNothing * axes.values.maxCoeff();
  to_unit_ =
      axes.values.unaryExpr([&](double x) { return x > least ? 1.0 / std::sqrt(x) : 0.0; }).asDiagonal() *
      axes.vectors.transpose() * scale.asDiagonal();
}

Eigen::VectorXd LeavingOut::unit_step(const Eigen::MatrixXd& own, const Eigen::VectorXd& pull,
                                      std::vector<Eigen::VectorXd>* alone) const {
  static constexpr double kMostAlone = 0.95;
  const linear::Axes shares = linear::axes(to_unit_ * own * to_unit_.transpose());
  for (Eigen::Index i = 0; alone != nullptr && i < shares.values.size(); ++i)
    if (shares.values(i) > kMostAlone) alone->push_back(shares.vectors.col(i));
  return shares.vectors *
         shares.values.unaryExpr([](double x) { return 1.0 / (1.0 - std::min(x, kMostAlone)); })
             .asDiagonal() *
         shares.vectors.transpose() * (to_unit_ * pull);
}

namespace {

/// Lets what one window alone tells scatter at least as what several tell does: `alone` are directions, and `scatter` is by coordinates in
/// which the information is one.
void scatter_at_least_as_others(const std::vector<Eigen::VectorXd>& alone, Eigen::MatrixXd& scatter) {
  const auto others = static_cast<double>(scatter.rows()) - static_cast<double>(alone.size());
  if (alone.empty() || others < 1.0) return;
  double of_others = scatter.trace();
  for (const Eigen::VectorXd& direction : alone) of_others -= direction.dot(scatter * direction);
  for (const Eigen::VectorXd& direction : alone) {
    const double missing = of_others / others - direction.dot(scatter * direction);
    if (missing > 0.0) scatter += missing * direction * direction.transpose();
  }
}

}  // namespace

Eigen::VectorXd LeavingOut::step(const Eigen::MatrixXd& others,
                                 const Eigen::VectorXd& gradient_of_others) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(count_);
  if (moving_.empty()) return all;
  const Eigen::MatrixXd own = information_ - others(moving_, moving_);
  all(moving_) = to_unit_.transpose() * unit_step(own, -gradient_of_others(moving_));
  return all;
}

Eigen::MatrixXd jackknife_covariance(const std::vector<WindowShare>& shares,
                                     const std::vector<bool>& at_bound, std::size_t layers) {
  const auto count = static_cast<Eigen::Index>(at_bound.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  const LeavingOut leaving(shares, at_bound);
  const std::vector<Eigen::Index>& moving = leaving.moving();
  const auto free = static_cast<Eigen::Index>(moving.size());
  if (free == 0 || shares.empty()) return covariance;
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(free, free), own = scatter;
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(free), before = Eigen::VectorXd::Zero(free);
  std::vector<Eigen::VectorXd> alone;
  for (std::size_t w = 0; w < shares.size(); ++w) {
    sum += shares[w].gradient(moving);
    own += shares[w].information(moving, moving);
    if ((w + 1) % layers != 0 && w + 1 != shares.size()) continue;
    // By how much the estimate moves without these windows: what they alone tell they also pull to themselves.
    const Eigen::VectorXd moves = leaving.unit_step(own, sum, &alone);
    scatter += moves * moves.transpose();
    if (layers > 1) scatter += 0.5 * (moves * before.transpose() + before * moves.transpose());
    before = moves;
    sum.setZero();
    own.setZero();
  }
  scatter_at_least_as_others(alone, scatter);
  const double windows = independent_windows(shares.size(), layers);
  const Eigen::MatrixXd small = leaving.to_unit().transpose() * scatter * leaving.to_unit() *
                                (std::max(windows - 1.0, 1.0) / std::max(windows, 1.0));
  for (Eigen::Index i = 0; i < free; ++i)
    for (Eigen::Index k = 0; k < free; ++k)
      covariance(moving[static_cast<std::size_t>(i)], moving[static_cast<std::size_t>(k)]) = small(i, k);
  return covariance;
}

}  // namespace furcula::identify
