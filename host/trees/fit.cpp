// Fits of a tree by simulation, see fit.hpp.
#include "host/trees/fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "host/core/error.hpp"
#include "host/core/parallel.hpp"
#include "host/linear/linear.hpp"
#include "host/trees/linear.hpp"
#include "host/trees/linearised.hpp"

namespace furcula::trees {
namespace {

/// Of what a joint's torque is, a change by which nothing else changes much.
constexpr double kTorque = 1e-3;
/// What is not known of an elastic drive's twist at a window's start: of what its torque makes of it.
constexpr double kTwist = 0.3;
/// A motion of so many times the encoder's noise is none.
constexpr double kStill = 10.0;

}  // namespace

Problem::Problem(const TreeModel& model, const std::vector<Recording>& recordings,
                 std::vector<Window> windows, unsigned threads)
    : model_(model),
      recordings_(recordings),
      windows_(std::move(windows)),
      threads_(threads),
      maker_(model),
      scales_(scales_of(model, recordings)),
      bins_(windows_.empty() ? 0
                             : static_cast<std::size_t>(windows_.front().measured.size()) / model.joints()),
      folds_(recordings.size() >= 3 ? recordings.size() : 4) {
  if (windows_.empty())
    throw core::DataError(
        "no recording is long enough for a window; expected some tenths of a second without gaps");
  window_weight_.assign(windows_.size(), 1.0);
}

Problem Problem::thinned(std::size_t every) const {
  std::vector<Window> some;
  for (std::size_t i = 0; i < windows_.size(); i += every) some.push_back(windows_[i]);
  Problem out(model_, recordings_, std::move(some), threads_);
  out.work_ = work_;
  return out;
}

std::size_t Problem::fold_of(std::size_t window) const {
  if (recordings_.size() >= 3) return windows_[window].recording;
  return window * folds_ / windows_.size();
}

Eigen::Vector2d Problem::rotor_precision(const Setup& setup, std::size_t joint) const {
  const auto& law = setup.model.laws[joint];
  const double twist = kTwist * scales_.torque_nm[joint] / law.drive_stiffness_nmprad,
               rate = twist * std::sqrt(law.drive_stiffness_nmprad / law.armature_kgm2);
  return {1.0 / (twist * twist), 1.0 / (rate * rate)};
}

Run Problem::run_of(const Setup& setup, const Window& w) {
  return {&setup, w.angle_rad, w.velocity_radps, w.rotor_more, w.rest_more_rad};
}

Eigen::MatrixXd Problem::simulated(std::span<const Run> runs, const Window& w) const {
  const std::size_t n = joints(), rows = w.last - w.first + 1;
  std::vector<double> out(runs.size() * rows * n);
  work_->steps += run(runs, recordings_[w.recording], w.first, w.last, out);
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(w.measured.size(), static_cast<Eigen::Index>(runs.size()));
  std::vector<double> count(bins_, 0.0);
  for (std::size_t k = 0; k < rows; ++k) {
    count[w.bin[k]] += 1.0;
    for (std::size_t one = 0; one < runs.size(); ++one)
      for (std::size_t j = 0; j < n; ++j)
        mean(static_cast<Eigen::Index>(w.bin[k] * n + j), static_cast<Eigen::Index>(one)) +=
            out[(one * rows + k) * n + j];
  }
  for (std::size_t b = 0; b < bins_; ++b)
    if (count[b] > 0.0)
      mean.middleRows(static_cast<Eigen::Index>(b * n), static_cast<Eigen::Index>(n)) /= count[b];
  // A run that has flown apart says no more than that it is far off.
  return mean.unaryExpr([](double x) { return std::isfinite(x) ? std::clamp(x, -1e6, 1e6) : 1e6; });
}

Eigen::VectorXd Problem::simulated(const Setup& setup, const Window& w) const {
  const Run one = run_of(setup, w);
  return simulated(std::span(&one, 1), w);
}

Eigen::VectorXd Problem::residual(const Setup& setup, std::size_t window) const {
  Eigen::VectorXd out = weighted(window, windows_[window].measured - simulated(setup, windows_[window]));
  if (starts_[window].of_more.size() > 0) out += starts_[window].of_more;
  return out;
}

Eigen::MatrixXd Problem::product(std::size_t window, const Eigen::MatrixXd& columns) const {
  const Start& s = starts_[window];
  const Eigen::MatrixXd with_start = s.columns.transpose() * columns;
  return window_weight_[window] *
         (columns.transpose() * columns - with_start.transpose() * (s.inverse * with_start));
}

double Problem::noise_rad(std::size_t joint) const {
  double most = 0.0;
  for (const Recording& r : recordings_) most = std::max(most, r.angle_noise_rad[joint]);
  return most;
}

std::vector<double> Problem::small_torques_nm() const {
  std::vector<double> out = scales_.torque_nm;
  for (double& torque : out) torque *= kTorque;
  return out;
}

double Problem::misfit(const Hypothesis& h) const {
  const std::size_t n = joints();
  const Setup setup = make(h);
  std::vector<std::vector<double>> off(windows_.size()), motion(windows_.size());
  core::parallel_for(windows_.size(), threads_, [&](std::size_t i) {
    const Window& w = windows_[i];
    const Eigen::VectorXd r = w.measured - simulated(setup, w);
    for (std::size_t j = 0; j < n; ++j) {
      const auto of_joint = [&](const Eigen::VectorXd& x) {
        return Eigen::VectorXd(Eigen::Map<const Eigen::VectorXd, 0, Eigen::InnerStride<>>(
            x.data() + j, static_cast<Eigen::Index>(bins_),
            Eigen::InnerStride<>(static_cast<Eigen::Index>(n))));
      };
      const Eigen::VectorXd y = of_joint(w.measured);
      off[i].push_back(of_joint(r).squaredNorm());
      motion[i].push_back((y.array() - y.mean()).matrix().squaredNorm());
    }
  });
  double most = 0.0;
  for (std::size_t j = 0; j < n; ++j) {
    // Where a joint hardly moves, noise is no misfit.
    const double noise = noise_rad(j);
    double squares = 0.0, about_mean = 1e-12 + static_cast<double>(bins_ * windows_.size()) * kStill *
                                                   kStill * noise * noise;
    for (std::size_t i = 0; i < windows_.size(); ++i) {
      squares += off[i][j];
      about_mean += motion[i][j];
    }
    most = std::max(most, squares / about_mean);
  }
  return most;
}

std::vector<Eigen::VectorXd> Problem::residuals(const Hypothesis& h) const {
  const Setup setup = make(h);
  std::vector<Eigen::VectorXd> out(windows_.size());
  core::parallel_for(windows_.size(), threads_, [&](std::size_t i) { out[i] = residual(setup, i); });
  return out;
}

std::vector<Eigen::MatrixXd> Problem::columns(const Hypothesis& h,
                                              const std::vector<Eigen::VectorXd>& residuals,
                                              const std::vector<Unknown>& unknowns,
                                              const std::vector<Hypothesis>& probes,
                                              const std::vector<Hypothesis>& runs,
                                              Eigen::MatrixXd* of_rotors) const {
  const Setup base = make(h);
  std::vector<Setup> setups;
  std::vector<double> step;
  // Of a body: its coordinates to both sides. What the joints' torques do not tell would look as if they did, by what one side is off.
  std::vector<Setup> backward;
  std::vector<std::size_t> to_both;
  for (std::size_t k = 0; k < unknowns.size(); ++k)
    if (unknowns[k].of_body) to_both.push_back(k);
  for (const std::size_t k : to_both) {
    Hypothesis moved = h;
    set_value(moved, unknowns[k], value_of(h, unknowns[k]) - 1e-3 * unknowns[k].scale);
    backward.push_back(make(moved));
  }
  for (const Unknown& u : unknowns) {
    // Inwards at the upper bound.
    double d = 1e-3 * u.scale;
    const double value = value_of(h, u);
    if (value + d > u.upper && !u.of_body) d = -d;
    Hypothesis moved = h;
    set_value(moved, u, value + d);
    step.push_back(d);
    setups.push_back(make(moved));
  }
  for (const Hypothesis& p : probes) setups.push_back(make(p));
  for (const Hypothesis& p : runs) setups.push_back(make(p));
  std::vector<const Setup*> linear;
  std::vector<std::size_t> linear_column, run_column;
  for (std::size_t k = 0; k < setups.size(); ++k) {
    const bool probe =
        k >= unknowns.size() && k < unknowns.size() + probes.size() && setups[k].differs_by_torque(base);
    if (probe) {
      linear.push_back(&setups[k]);
      linear_column.push_back(k);
    } else {
      run_column.push_back(k);
    }
  }
  std::vector<std::pair<std::size_t, std::size_t>> springs;  // number of the setup, joint
  for (const std::size_t k : linear_column)
    for (std::size_t j = 0; j < joints(); ++j)
      if (setups[k].model.laws[j].elastic && !base.model.laws[j].elastic) springs.emplace_back(k, j);
  if (of_rotors != nullptr)
    *of_rotors = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(windows_.size()),
                                       static_cast<Eigen::Index>(setups.size()));
  const std::vector<double> torque_nm = small_torques_nm();
  std::vector<Eigen::MatrixXd> out(windows_.size());
  core::parallel_for(windows_.size(), threads_, [&](std::size_t i) {
    Eigen::MatrixXd& c = out[i];
    c.resize(static_cast<Eigen::Index>(bins_ * joints()), static_cast<Eigen::Index>(setups.size()));
    const Window& w = windows_[i];
    // The simulation's change is minus the residual's.
    for (const std::size_t k : run_column)
      if (k >= unknowns.size()) c.col(static_cast<Eigen::Index>(k)) = residuals[i] - residual(setups[k], i);
    if (!unknowns.empty()) {
      std::vector<Run> beside{run_of(base, w)};
      for (std::size_t k = 0; k < unknowns.size(); ++k) beside.push_back(run_of(setups[k], w));
      for (const Setup& s : backward) beside.push_back(run_of(s, w));
      const Eigen::MatrixXd x = simulated(beside, w);
      Eigen::MatrixXd change(x.rows(), static_cast<Eigen::Index>(unknowns.size()));
      for (Eigen::Index k = 0; k < change.cols(); ++k)
        change.col(k) = (x.col(k + 1) - x.col(0)) / step[static_cast<std::size_t>(k)];
      for (std::size_t b = 0; b < to_both.size(); ++b) {
        const auto k = static_cast<Eigen::Index>(to_both[b]);
        const auto back = change.cols() + 1 + static_cast<Eigen::Index>(b);
        change.col(k) = 0.5 * (change.col(k) + (x.col(0) - x.col(back)) / step[to_both[b]]);
      }
      c.leftCols(change.cols()) = weighted(i, change);
    }
    if (linear.empty()) return;
    const Linearised run(base, recordings_[w.recording], w, torque_nm);
    work_->steps += run.steps();
    const Eigen::MatrixXd change = run.changes(linear);
    const Eigen::MatrixXd columns = weighted(i, change);
    for (std::size_t k = 0; k < linear.size(); ++k)
      c.col(static_cast<Eigen::Index>(linear_column[k])) = columns.col(static_cast<Eigen::Index>(k));
    if (of_rotors == nullptr || springs.empty()) return;
    std::vector<const Setup*> elastic;
    for (const auto& [k, joint] : springs) elastic.push_back(&setups[k]);
    const Eigen::MatrixXd starts = weighted(i, run.rotor_starts(elastic));
    for (std::size_t s = 0; s < springs.size(); ++s) {
      const auto [k, joint] = springs[s];
      const auto column = static_cast<Eigen::Index>(k);
      Eigen::MatrixXd all(c.rows(), 4);  // residual, spring, its rotor's angle and rate at the start
      all << residuals[i], c.col(column), starts.middleCols(static_cast<Eigen::Index>(2 * s), 2);
      const Eigen::Matrix4d products = product(i, all) / window_weight_[i];
      const auto precision = rotor_precision(setups[k], joint);
      Eigen::Matrix2d normal = products.bottomRightCorner<2, 2>();
      normal.diagonal() += precision;
      const Eigen::Matrix2d inverse = normal.inverse();
      const Eigen::Matrix2d taken = inverse * products.bottomRightCorner<2, 2>();
      const Eigen::Vector2d of_residual = products.block<2, 1>(2, 0), of_spring = products.block<2, 1>(2, 1);
      (*of_rotors)(static_cast<Eigen::Index>(i), column) =
          window_weight_[i] * (of_residual.dot(inverse * of_residual) - taken.trace());
      c.col(column) -= all.rightCols<2>() * (inverse * of_spring);
    }
  });
  return out;
}

}  // namespace furcula::trees
