// What the windows of a fit start from, and what their residuals weigh, see fit.hpp.
#include <algorithm>
#include <atomic>
#include <cmath>

#include "host/core/parallel.hpp"
#include "host/linear/linear.hpp"
#include "host/trees/disturbance.hpp"
#include "host/trees/fit.hpp"
#include "host/trees/linearised.hpp"

namespace furcula::trees {
namespace {

/// Where the residuals are off a linear function of the start by this share of what is left of them, it moves; at most so often.
constexpr double kBent = 0.01;
constexpr int kMoves = 3;
/// Disturbances are estimated on so many windows; at first a random torque is so much of what acts at its joint.
constexpr std::size_t kMostWindows = 40;
constexpr double kFirst = 0.05;
/// No encoder has less noise.
constexpr double kLeastNoise_rad = 1e-9;
/// Of an encoder's noise, what stays when its readings are averaged.
constexpr double kOfNoise = 0.25;

}  // namespace

Problem::Start Problem::start_of(const Setup& setup, const Window& w) const {
  const std::size_t n = joints();
  std::vector<std::size_t> elastic, caught;  // joints with elastic drives, with switched springs
  for (std::size_t j = 0; j < n; ++j) {
    if (setup.model.laws[j].elastic) elastic.push_back(j);
    if (setup.joints[j].switched) caught.push_back(j);
  }
  const Phase& phase = recordings_[w.recording].phase_at(w.first);
  if (!phase.stance) caught.clear();
  const std::size_t count = 2 * (n + elastic.size()) + caught.size();
  Start s;
  s.precision.resize(static_cast<Eigen::Index>(count));
  s.precision.head(static_cast<Eigen::Index>(2 * n)) = w.start_precision;
  std::vector<Window> moved(count, w);
  std::vector<double> step(count);
  const auto move = [&](std::size_t k, double& number, double by) {
    number += by;
    step[k] = by;
  };
  for (std::size_t k = 0; k < 2 * n; ++k)
    move(k, (k < n ? moved[k].angle_rad : moved[k].velocity_radps)[k % n], k < n ? 1e-5 : 1e-4);
  // What the rotor of an elastic drive does at the start is known from before, but not well: it is a start too.
  for (std::size_t e = 0; e < 2 * elastic.size(); ++e) {
    const std::size_t j = elastic[e / 2], k = 2 * n + e;
    const double precision = rotor_precision(setup, j)(static_cast<Eigen::Index>(e % 2));
    s.precision(static_cast<Eigen::Index>(k)) = precision;
    moved[k].rotor_more.assign(2 * n, 0.0);
    move(k, moved[k].rotor_more[e % 2 == 0 ? j : n + j], 0.1 / std::sqrt(precision));
  }
  // Where a spring caught is known no better than the touch-down.
  for (std::size_t c = 0; c < caught.size(); ++c) {
    const double sd = phase.touchdown_sd_rad[caught[c]];
    const std::size_t k = 2 * (n + elastic.size()) + c;
    s.precision(static_cast<Eigen::Index>(k)) = 1.0 / (sd * sd);
    moved[k].rest_more_rad.assign(n, 0.0);
    move(k, moved[k].rest_more_rad[caught[c]], sd);
  }
  std::vector<Run> runs{run_of(setup, w)};
  for (const Window& m : moved) runs.push_back(run_of(setup, m));
  const Eigen::MatrixXd x = simulated(runs, w);
  s.columns.resize(x.rows(), static_cast<Eigen::Index>(count));
  for (std::size_t k = 0; k < count; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    s.columns.col(column) = (x.col(column + 1) - x.col(0)) / step[k];
  }
  return s;
}

Eigen::MatrixXd Problem::weighted(std::size_t window, const Eigen::MatrixXd& x) const {
  if (root_.empty()) return weight_.asDiagonal() * x;
  return linear::solve_lower(root_[window], x);
}

Eigen::VectorXd Problem::best_start(std::size_t window, const Eigen::VectorXd& left) const {
  const Eigen::MatrixXd s = weighted(window, starts_[window].columns);
  Eigen::MatrixXd normal = s.transpose() * s;
  normal.diagonal() += starts_[window].precision;
  return linear::solve_positive(normal, s.transpose() * weighted(window, left));
}

void Problem::weigh_bins(const std::vector<Eigen::VectorXd>& left) {
  const std::size_t n = joints();
  Eigen::MatrixXd squares(static_cast<Eigen::Index>(bins_ * n), static_cast<Eigen::Index>(windows_.size()));
  for (std::size_t i = 0; i < windows_.size(); ++i)
    squares.col(static_cast<Eigen::Index>(i)) =
        (left[i] - starts_[i].columns * best_start(i, left[i])).cwiseAbs2();
  for (std::size_t j = 0; j < n; ++j) {
    const double noise = std::max(kLeastNoise_rad, noise_rad(j));
    for (std::size_t b = 0; b < bins_; ++b) {
      // Of this bin and its neighbours, the mean without the largest tenth.
      std::vector<double> all;
      for (std::size_t k = b > 2 ? b - 2 : 0; k < std::min(bins_, b + 3); ++k)
        for (Eigen::Index i = 0; i < squares.cols(); ++i)
          all.push_back(squares(static_cast<Eigen::Index>(k * n + j), i));
      std::sort(all.begin(), all.end());
      all.resize(all.size() - all.size() / 10);
      double mean = 0.0;
      for (const double v : all) mean += v / static_cast<double>(all.size());
      weight_(static_cast<Eigen::Index>(b * n + j)) = 1.0 / std::sqrt(mean + noise * noise / 4.0);
    }
  }
}

bool Problem::move_start(const Setup& setup, std::size_t window, const Eigen::VectorXd& left) {
  const auto n = static_cast<Eigen::Index>(joints()), both = 2 * n;
  Window& w = windows_[window];
  Window there = w;
  there.start_more = best_start(window, left).head(both);
  for (Eigen::Index k = 0; k < both; ++k) {
    const double way = there.start_more(k) - (w.start_more.size() > 0 ? w.start_more(k) : 0.0);
    (k < n ? there.angle_rad[static_cast<std::size_t>(k)]
           : there.velocity_radps[static_cast<std::size_t>(k - n)]) += way;
  }
  const Eigen::VectorXd straight = left - starts_[window].columns.leftCols(both) * there.start_more,
                        is = there.measured - simulated(setup, there);
  if (!(weighted(window, straight - is).squaredNorm() > kBent * static_cast<double>(left.size())))
    return false;
  w = std::move(there);
  return true;
}

void Problem::weigh(const Hypothesis& h, const Hypothesis* of_starts) {
  ++weighing_;
  root_.clear();
  const Setup weighed = make(h), setup = make(of_starts != nullptr ? *of_starts : h);
  weight_ = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(bins_ * joints()));
  std::vector<Eigen::VectorXd> left(windows_.size());  // not weighted, as from the starts' measured places
  starts_.assign(windows_.size(), {});
  const auto start_at = [&](std::size_t i) {
    const Window& w = windows_[i];
    starts_[i] = start_of(setup, w);
    left[i] = w.measured - simulated(weighed, w);
    if (w.start_more.size() > 0) left[i] += starts_[i].columns.leftCols(w.start_more.size()) * w.start_more;
  };
  core::parallel_for(windows_.size(), threads_, start_at);
  // Twice, since the weights decide on the starts.
  weigh_bins(left);
  weigh_bins(left);
  for (int round = 0; round < kMoves; ++round) {
    std::atomic<bool> moved = false;
    core::parallel_for(windows_.size(), threads_, [&](std::size_t i) {
      if (!move_start(weighed, i, left[i])) return;
      start_at(i);
      moved = true;
    });
    if (!moved) break;
    weigh_bins(left);
  }
  eliminate_starts(left);
}

void Problem::whiten(const Hypothesis& h) {
  ++weighing_;
  const Setup setup = make(h);
  const auto n = static_cast<Eigen::Index>(joints());
  const double part_s = windows_.front().span_s / static_cast<double>(bins_);
  const std::vector<double> small = small_torques_nm();
  std::vector<Eigen::VectorXd> left(windows_.size());
  std::vector<DisturbedWindow> all(windows_.size());
  core::parallel_for(windows_.size(), threads_, [&](std::size_t i) {
    const Window& w = windows_[i];
    Start& s = starts_[i];
    s.columns = root_.empty() ? Eigen::MatrixXd(weight_.cwiseInverse().asDiagonal() * s.columns)
                              : Eigen::MatrixXd(root_[i] * s.columns);
    left[i] = w.measured - simulated(setup, w);
    if (w.start_more.size() > 0) left[i] += s.columns.leftCols(w.start_more.size()) * w.start_more;
    const Linearised run(setup, recordings_[w.recording], w, small);
    work_->steps += run.steps();
    all[i] = {run.of_torques(bins_),
              s.columns * s.precision.cwiseInverse().asDiagonal() * s.columns.transpose(), left[i]};
  });
  std::vector<DisturbedWindow> some;
  for (std::size_t i = 0; i < all.size(); i += (all.size() + kMostWindows - 1) / kMostWindows)
    some.push_back(all[i]);
  Disturbance start{Eigen::MatrixXd(n, static_cast<Eigen::Index>(Disturbance::kTime_s.size())),
                    Eigen::VectorXd(n)};
  for (Eigen::Index j = 0; j < n; ++j) {
    start.torque.row(j).setConstant(std::pow(kFirst * scales_.torque_nm[static_cast<std::size_t>(j)], 2));
    start.noise(j) = std::pow(std::max(kLeastNoise_rad, noise_rad(static_cast<std::size_t>(j))), 2);
  }
  const Eigen::VectorXd least = kOfNoise * kOfNoise * start.noise;
  const Disturbance d = estimate(std::move(start), some, part_s, least, threads_);
  std::vector<Eigen::MatrixXd> root(windows_.size());
  core::parallel_for(windows_.size(), threads_, [&](std::size_t i) {
    root[i] = linear::root_of_positive(covariance(d, all[i].torques, part_s));
  });
  root_ = std::move(root);
  eliminate_starts(left);
}

void Problem::eliminate_starts(const std::vector<Eigen::VectorXd>& left) {
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    Start& s = starts_[i];
    s.columns = weighted(i, s.columns);
    Eigen::MatrixXd normal = s.columns.transpose() * s.columns;
    normal.diagonal() += s.precision;
    s.inverse = linear::inverse_of_positive(normal);
    const Eigen::VectorXd& more = windows_[i].start_more;
    if (more.size() > 0) s.of_more = s.columns.leftCols(more.size()) * more;
  }
  window_weight_.assign(windows_.size(), 1.0);
  std::vector<double> loss;
  for (std::size_t i = 0; i < windows_.size(); ++i) loss.push_back(product(i, weighted(i, left[i]))(0, 0));
  std::vector<double> sorted = loss;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2),
                   sorted.end());
  const double typical = sorted[sorted.size() / 2];
  for (std::size_t i = 0; i < windows_.size(); ++i)
    window_weight_[i] = std::min(1.0, 25.0 * typical / std::max(loss[i], 1e-300));
}

}  // namespace furcula::trees
