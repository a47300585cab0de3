// Fits of a tree by simulation, see fit.hpp.
#include "host/trees/fit.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/core/error.hpp"
#include "host/core/parallel.hpp"
#include "host/linear/linear.hpp"
#include "host/trees/linear.hpp"
#include "host/trees/linearised.hpp"

namespace furcula::trees {
namespace {

/// Of what a joint's torque is, a change by which nothing else changes much.
constexpr double kTorque = 1e-3;
/// Derivatives are those of a point no further than so much of what matters, in each unknown.
constexpr double kNear = 0.5;
/// What is not known of an elastic drive's twist at a window's start: of what its torque makes of it.
constexpr double kTwist = 0.3;
/// A motion of so many times the encoder's noise is none.
constexpr double kStill = 10.0;
/// From this correlation on an unknown can stand for another one.
constexpr double kOneForAnother = 0.999;
/// Of the loss, what a change that matters makes less of is not seen at all.
constexpr double kNothing = 1e-9;
/// No fit goes on for less than so much of the loss.
constexpr double kDone = 1e-4;

/// What is known beforehand is one residual more of its unknown: how far that is from 0, in standard deviations.
double of_priors(const Hypothesis& h, const std::vector<Unknown>& unknowns) {
  double out = 0.0;
  for (const Unknown& u : unknowns)
    if (u.prior_sd > 0.0) out += std::pow(value_of(h, u) / u.prior_sd, 2);
  return out;
}
/// Each fold has its share of it.
void add_priors(const Hypothesis& h, const std::vector<Unknown>& unknowns, Products& p) {
  const auto add = [](Eigen::MatrixXd& to, Eigen::Index column, double value, double weight) {
    to(0, 0) += weight * value * value;
    to(0, column) -= weight * value;
    to(column, 0) -= weight * value;
    to(column, column) += weight;
  };
  for (std::size_t k = 0; k < unknowns.size(); ++k) {
    const Unknown& u = unknowns[k];
    if (!(u.prior_sd > 0.0)) continue;
    const auto column = static_cast<Eigen::Index>(k + 1);
    const double value = value_of(h, u), weight = 1.0 / (u.prior_sd * u.prior_sd);
    add(p.all, column, value, weight);
    for (Eigen::MatrixXd& fold : p.fold)
      add(fold, column, value, weight / static_cast<double>(p.fold.size()));
  }
}

/// How damped steps are, and what stands beside a normal matrix. Of bodies, of which something is known beforehand, no direction is without
/// information, and a direction that has little must not be lost beside one that has much.
struct Stepping {
  double damping, least, more, ridge, of_largest;
};
constexpr Stepping kUsual{1e-3, 1e-6, 20.0, 1e-10, 1e-9}, kOfBodies{1e-8, 1e-14, 1e3, 1e-13, 1e-13};

}  // namespace

double variance_of(const Fit& fit, std::size_t unknown) {
  const auto i = static_cast<Eigen::Index>(unknown);
  const Mean mean = weighted_mean(fit.fold_value[unknown], fit.fold_information[unknown]);
  const bool known = fit.fold_value[unknown].size() >= 3 && mean.freedom > 0.25;
  return known ? std::max(fit.covariance(i, i), mean.variance) : fit.covariance(i, i);
}

Interval interval_of(const Fit& fit, std::size_t unknown) {
  const Unknown& u = fit.unknowns[unknown];
  const auto i = static_cast<Eigen::Index>(unknown);
  const double value = value_of(fit.at, u), curved = fit.by_curvature(i, i),
               half = 1.96 * std::sqrt(std::max(variance_of(fit, unknown), curved));
  Interval out{std::max(value - half, std::min(u.lower, value)),
               std::min(value + half, std::max(u.upper, value))};
  for (std::size_t other = 0; other < fit.unknowns.size(); ++other) {
    const auto k = static_cast<Eigen::Index>(other);
    const double shared = fit.by_curvature(i, k), of_other = fit.by_curvature(k, k);
    if (other == unknown || !(std::abs(shared) > kOneForAnother * std::sqrt(curved * of_other))) continue;
    // By how much this one changes with the other one; that has its own bounds.
    const double by = shared / of_other, at = value_of(fit.at, fit.unknowns[other]),
                 down = by * (fit.unknowns[other].lower - at), up = by * (fit.unknowns[other].upper - at),
                 least = 1.96 * std::sqrt(std::max(0.0, curved - by * shared));
    out.lower = std::max(out.lower, value + std::min({down, up, -least}));
    out.upper = std::min(out.upper, value + std::max({down, up, least}));
  }
  return out;
}

Away away_from_none(const TreeModel& model, const Fit& fit, std::size_t cause) {
  std::vector<Eigen::Index> which;
  std::vector<double> away, wider;  // the recordings' own scatter may be larger than the windows'
  const Cause& c = fit.at.causes[cause];
  for (std::size_t k = 0; k < fit.unknowns.size(); ++k) {
    const Unknown& u = fit.unknowns[k];
    if (!u.of_cause || u.cause != cause) continue;
    const double none = neutral_value(model, c.effect, u.parameter, c.sites.front());
    const auto i = static_cast<Eigen::Index>(k);
    if (std::isnan(none) || !(fit.covariance(i, i) > 0.0)) continue;
    which.push_back(i);
    away.push_back(value_of(fit.at, u) - none);
    wider.push_back(std::sqrt(variance_of(fit, k) / fit.covariance(i, i)));
  }
  if (which.empty()) return {};
  const Eigen::Map<const Eigen::VectorXd> d(away.data(), static_cast<Eigen::Index>(away.size()));
  const Eigen::Map<const Eigen::VectorXd> w(wider.data(), d.size());
  const Eigen::MatrixXd windows = fit.covariance(which, which),
                        both = w.asDiagonal() * windows * w.asDiagonal();
  const auto squares = [&d](const Eigen::MatrixXd& covariance) {
    return d.dot(Eigen::VectorXd(ScaledNormal(covariance, 1e-9).solve(d)));
  };
  return {squares(both), squares(windows), which.size()};
}

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

Products Problem::products_of(const std::vector<Eigen::VectorXd>& residuals,
                              const std::vector<Eigen::MatrixXd>& columns) const {
  Products out;
  out.window.resize(windows_.size());
  std::vector<Eigen::MatrixXd> of(windows_.size());
  core::parallel_for(windows_.size(), threads_, [&](std::size_t i) {
    Eigen::MatrixXd c(residuals[i].size(), 1 + columns[i].cols());
    c << residuals[i], columns[i];
    of[i] = product(i, c);
    out.window[i] = of[i].cast<float>();
  });
  const Eigen::Index size = of.front().rows();
  out.all = Eigen::MatrixXd::Zero(size, size);
  out.fold.assign(folds_, Eigen::MatrixXd::Zero(size, size));
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    out.all += of[i];
    out.fold[fold_of(i)] += of[i];
  }
  return out;
}

Products Problem::products(const Hypothesis& h, const std::vector<Unknown>& unknowns,
                           const std::vector<Hypothesis>& probes, const std::vector<Hypothesis>& runs) const {
  const std::vector<Eigen::VectorXd> r = residuals(h);
  Eigen::MatrixXd of_rotors;
  Products out = products_of(r, columns(h, r, unknowns, probes, runs, &of_rotors));
  add_priors(h, unknowns, out);
  out.of_rotors = Eigen::MatrixXd::Zero(of_rotors.rows(), out.all.cols());
  out.of_rotors.rightCols(of_rotors.cols()) = of_rotors;
  return out;
}

void Problem::derive_beside(const Fit& beside, const std::vector<Eigen::VectorXd>& residuals,
                            Fit& out) const {
  const auto same = [&](const Unknown& u, const Unknown& w) {
    if (u.of_cause != w.of_cause || u.of_body != w.of_body || u.of_inputs != w.of_inputs ||
        u.parameter != w.parameter)
      return false;
    if (u.of_inputs) return true;
    if (u.of_body) return u.link == w.link;
    if (!u.of_cause) return u.joint == w.joint;
    const Cause &a = out.at.causes[u.cause], &b = beside.at.causes[w.cause];
    return a.effect == b.effect && a.sites == b.sites;
  };
  std::vector<Unknown> others;
  std::vector<std::size_t> taken;  // of those of `beside`
  std::vector<bool> is_taken;
  for (const Unknown& u : out.unknowns) {
    const auto found = std::find_if(beside.unknowns.begin(), beside.unknowns.end(),
                                    [&](const Unknown& w) { return same(u, w); });
    is_taken.push_back(found != beside.unknowns.end());
    if (is_taken.back()) {
      taken.push_back(static_cast<std::size_t>(found - beside.unknowns.begin()));
      out.derived_at.push_back(beside.derived_at[taken.back()]);
    } else {
      others.push_back(u);
      out.derived_at.push_back(value_of(out.at, u));
    }
  }
  const std::vector<Eigen::MatrixXd> own = columns(out.at, residuals, others, {}, {});
  out.derivatives.resize(windows_.size());
  for (std::size_t i = 0; i < windows_.size(); ++i) {
    Eigen::MatrixXd& d = out.derivatives[i];
    d.resize(residuals[i].size(), static_cast<Eigen::Index>(out.unknowns.size()));
    Eigen::Index next_own = 0;
    std::size_t next_taken = 0;
    for (std::size_t k = 0; k < out.unknowns.size(); ++k)
      d.col(static_cast<Eigen::Index>(k)) =
          is_taken[k] ? beside.derivatives[i].col(static_cast<Eigen::Index>(taken[next_taken++]))
                      : own[i].col(next_own++);
  }
}

double Problem::timing_doubt(const Cause& cause) const {
  // One that has all drives has the part of a row in it that nobody knows.
  if (cause.effect == Effect::time_skew || cause.effect == Effect::actuator_delay) {
    Hypothesis alone{{}, model_.causes};
    alone.causes.push_back(cause);
    return inputs_may_be_late(model_, alone) ? 0.0 : kMostLate_rows / std::sqrt(3.0) * interval_s();
  }
  if (cause.effect != Effect::latch_delay && cause.effect != Effect::latch_offset) return 0.0;
  double sd_s = 0.0, rates = 0.0, stances = 0.0;
  for (const Recording& r : recordings_) {
    sd_s = std::max(sd_s, r.switch_late_sd_s);
    for (const Phase& p : r.phases) {
      if (!p.stance || !p.whole) continue;
      rates += std::abs(velocity_after_touchdown(r, p, cause.sites.front()));
      stances += 1.0;
    }
  }
  return cause.effect == Effect::latch_delay ? sd_s : sd_s * rates / std::max(1.0, stances);
}

Fit Problem::fit(Hypothesis from, int iterations, const Fit* beside) const {
  Fit out;
  out.at = std::move(from);
  if (!inputs_may_be_late(model_, out.at)) out.at.inputs_late_rows = 0.0;
  out.unknowns = unknowns_of(model_, scales_, out.at);
  const auto count = static_cast<Eigen::Index>(out.unknowns.size());
  for (const Unknown& u : out.unknowns)
    set_value(out.at, u, std::clamp(value_of(out.at, u), u.lower, u.upper));
  const bool bodies =
      std::any_of(out.unknowns.begin(), out.unknowns.end(), [](const Unknown& u) { return u.of_body; });
  const Stepping& stepping = bodies ? kOfBodies : kUsual;
  double damping = stepping.damping;
  std::vector<Eigen::VectorXd> left = residuals(out.at);
  const auto derive = [&] {
    out.derivatives = columns(out.at, left, out.unknowns, {}, {});
    out.derived_at.clear();
    for (const Unknown& u : out.unknowns) out.derived_at.push_back(value_of(out.at, u));
  };
  if (beside != nullptr && beside->weighing == weighing_)
    derive_beside(*beside, left, out);
  else
    derive();
  out.weighing = weighing_;
  // The derivatives of a point near by serve as well.
  const auto way = [&] {
    double most = 0.0;
    for (std::size_t k = 0; k < out.unknowns.size(); ++k)
      most = std::max(
          most, std::abs(value_of(out.at, out.unknowns[k]) - out.derived_at[k]) / out.unknowns[k].scale);
    return most;
  };
  const auto products_here = [&] {
    Products here = products_of(left, out.derivatives);
    add_priors(out.at, out.unknowns, here);
    return here;
  };
  Products p = products_here();
  out.loss = p.all(0, 0);
  for (int iteration = 0; iteration < iterations && count > 0 && !spent(); ++iteration) {
    bool better = false;
    double gained = 0.0;
    for (int attempt = 0; attempt < 4 && !better; ++attempt) {
      // Unknowns at a bound that the gradient pushes against stay there.
      std::vector<Eigen::Index> moving;
      for (Eigen::Index k = 0; k < count; ++k) {
        const Unknown& u = out.unknowns[static_cast<std::size_t>(k)];
        const double value = value_of(out.at, u), push = p.all(0, k + 1);
        if (!((value <= u.lower && push < 0.0) || (value >= u.upper && push > 0.0))) moving.push_back(k);
      }
      const auto m = static_cast<Eigen::Index>(moving.size());
      Eigen::MatrixXd normal(m, m);
      Eigen::VectorXd right(m);
      for (Eigen::Index a = 0; a < m; ++a) {
        const double sa = out.unknowns[static_cast<std::size_t>(moving[static_cast<std::size_t>(a)])].scale;
        right(a) = sa * p.all(0, moving[static_cast<std::size_t>(a)] + 1);
        for (Eigen::Index b = 0; b < m; ++b)
          normal(a, b) =
              sa * out.unknowns[static_cast<std::size_t>(moving[static_cast<std::size_t>(b)])].scale *
              p.all(moving[static_cast<std::size_t>(a)] + 1, moving[static_cast<std::size_t>(b)] + 1);
      }
      normal.diagonal() *= 1.0 + damping;
      normal.diagonal().array() += stepping.of_largest * std::max(1e-12, normal.diagonal().maxCoeff());
      const Eigen::VectorXd step = linear::solve_symmetric(normal, right);
      // The linear problem's own gain; with damping this is a little too much.
      if (!(right.dot(step) > kDone * out.loss)) break;
      Hypothesis trial = out.at;
      for (Eigen::Index a = 0; a < m; ++a) {
        const Unknown& u = out.unknowns[static_cast<std::size_t>(moving[static_cast<std::size_t>(a)])];
        // No step of more than ten times what matters: far out the columns say nothing.
        const double moved = value_of(out.at, u) + u.scale * std::clamp(step(a), -10.0, 10.0);
        set_value(trial, u, std::clamp(moved, u.lower, u.upper));
      }
      std::vector<Eigen::VectorXd> of_trial = residuals(trial);
      double loss = of_priors(trial, out.unknowns);
      for (std::size_t i = 0; i < windows_.size(); ++i) loss += product(i, of_trial[i])(0, 0);
      if (loss < out.loss) {
        better = true;
        gained = out.loss - loss;
        out.at = trial;
        out.loss = loss;
        left = std::move(of_trial);
        damping = std::max(stepping.least, damping * 0.2);
      } else if (way() > 0.0) {
        derive();
        p = products_here();
      } else {
        damping = std::min(1e6, damping * stepping.more);
      }
    }
    if (!better) break;
    if (way() > kNear) derive();
    p = products_here();
    if (gained < kDone * out.loss) break;
  }
  // A sandwich: the windows' gradients scatter as their residuals do, whatever these are made of.
  out.at_bound.assign(out.unknowns.size(), false);
  std::vector<Eigen::Index> inside;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Unknown& u = out.unknowns[static_cast<std::size_t>(k)];
    const double value = value_of(out.at, u), near = 1e-6 * std::max(std::abs(u.upper), u.scale);
    out.at_bound[static_cast<std::size_t>(k)] =
        value <= u.lower + 1e-9 * u.scale || value >= u.upper - std::min(near, 1e-3 * u.scale);
    // What nothing depends on has no scatter either.
    if (!out.at_bound[static_cast<std::size_t>(k)] &&
        (u.prior_sd > 0.0 || p.all(k + 1, k + 1) * u.scale * u.scale > kNothing * out.loss))
      inside.push_back(k + 1);
  }
  const auto m = static_cast<Eigen::Index>(inside.size());
  out.covariance = Eigen::MatrixXd::Zero(count, count);
  out.of_prior = Eigen::MatrixXd::Zero(count, count);
  if (m > 0) {
    const Eigen::MatrixXd information = p.all(inside, inside);
    Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(m, m);
    for (const Eigen::MatrixXf& w : p.window) {
      const Eigen::VectorXd g = w(inside, 0).cast<double>();
      scatter += g * g.transpose();
    }
    const double windows = static_cast<double>(p.window.size());
    const Eigen::MatrixXd inverse = ScaledNormal(information, stepping.ridge).inverse();
    // What is known beforehand scatters by itself, and is one value less that the windows must tell.
    Eigen::VectorXd prior = Eigen::VectorXd::Zero(m);
    double told = static_cast<double>(m);
    for (Eigen::Index a = 0; a < m; ++a) {
      const double sd =
          out.unknowns[static_cast<std::size_t>(inside[static_cast<std::size_t>(a)] - 1)].prior_sd;
      if (!(sd > 0.0)) continue;
      prior(a) = 1.0 / (sd * sd);
      told -= std::min(1.0, prior(a) * inverse(a, a));
    }
    Eigen::MatrixXd c = inverse * scatter * inverse * (windows / std::max(1.0, windows - told));
    const Eigen::MatrixXd of_prior = inverse * prior.asDiagonal() * inverse;
    c += of_prior;
    for (Eigen::Index a = 0; a < m; ++a)
      for (Eigen::Index b = 0; b < m; ++b)
        out.of_prior(inside[static_cast<std::size_t>(a)] - 1, inside[static_cast<std::size_t>(b)] - 1) =
            of_prior(a, b);
    for (Eigen::Index a = 0; a < m; ++a)
      for (Eigen::Index b = 0; b < m; ++b)
        out.covariance(inside[static_cast<std::size_t>(a)] - 1, inside[static_cast<std::size_t>(b)] - 1) =
            c(a, b);
  }
  // All inputs, or all touch-downs, may be later, or earlier, by one time: no window tells.
  for (std::size_t k = 0; k < out.unknowns.size(); ++k) {
    const Unknown& u = out.unknowns[k];
    if (!u.of_cause || out.at_bound[k]) continue;
    const double sd = timing_doubt(out.at.causes[u.cause]);
    out.covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)) += sd * sd;
  }
  // The curvature alone, of unknowns at a bound too; of what nothing depends on, nothing is known.
  std::vector<Eigen::Index> told;
  for (Eigen::Index k = 0; k < count; ++k) {
    const Unknown& u = out.unknowns[static_cast<std::size_t>(k)];
    if (u.prior_sd > 0.0 || p.all(k + 1, k + 1) * u.scale * u.scale > kNothing * out.loss)
      told.push_back(k + 1);
  }
  out.by_curvature = Eigen::MatrixXd::Zero(count, count);
  out.by_curvature.diagonal().setConstant(std::numeric_limits<double>::infinity());
  if (!told.empty()) {
    const double each = std::max(1.0, out.loss / static_cast<double>(windows_.size() * bins_ * joints()));
    const Eigen::MatrixXd inverse = each * ScaledNormal(p.all(told, told), 1e-12).inverse();
    for (std::size_t a = 0; a < told.size(); ++a)
      for (std::size_t b = 0; b < told.size(); ++b)
        out.by_curvature(told[a] - 1, told[b] - 1) =
            inverse(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
  }
  out.fold_value.assign(out.unknowns.size(), {});
  out.fold_information.assign(out.unknowns.size(), {});
  for (const Eigen::MatrixXd& fold : p.fold) {
    out.held_out_loss += fold(0, 0);
    if (m == 0) continue;
    const Eigen::MatrixXd normal = fold(inside, inside), rest = p.all(inside, inside) - normal;
    const Eigen::VectorXd right = fold(inside, 0);
    const Eigen::VectorXd without = ScaledNormal(rest, kRidge, 1e-12).solve(p.all(inside, 0) - right);
    out.held_out_loss += without.dot(normal * without) - 2.0 * without.dot(right);
    const Eigen::MatrixXd inverse = ScaledNormal(normal, kRidge, 1e-12).inverse();
    const Eigen::VectorXd step = inverse * right;
    for (Eigen::Index a = 0; a < m; ++a) {
      const auto k = static_cast<std::size_t>(inside[static_cast<std::size_t>(a)] - 1);
      out.fold_value[k].push_back(value_of(out.at, out.unknowns[k]) + step(a));
      out.fold_information[k].push_back(1.0 / inverse(a, a));
    }
  }
  out.window_loss.resize(p.window.size());
  for (std::size_t i = 0; i < p.window.size(); ++i)
    out.window_loss[i] = static_cast<double>(p.window[i](0, 0));
  return out;
}

}  // namespace furcula::trees
