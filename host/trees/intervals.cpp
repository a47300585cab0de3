// What the windows and the scatter between recordings say of fitted values, see fit.hpp.
#include <algorithm>
#include <cmath>
#include <limits>

#include "host/trees/fit.hpp"
#include "host/trees/linear.hpp"

namespace furcula::trees {
namespace {

/// From this correlation on an unknown can stand for another one.
constexpr double kOneForAnother = 0.999;
/// Of the loss, what a change that matters makes less of is not seen at all.
constexpr double kNothing = 1e-9;

/// Whether it is late by one time with all inputs: it then has the part of a row in it that nobody knows.
bool has_all_inputs(const TreeModel& model, const Cause& cause) {
  if (cause.effect != Effect::time_skew && cause.effect != Effect::actuator_delay) return false;
  Hypothesis alone{{}, model.causes};
  alone.causes.push_back(cause);
  return !inputs_may_be_late(model, alone);
}

/// Whether anything of the loss depends on it. What nothing depends on has no scatter either.
bool is_told(const Fit& fit, const Products& p, std::size_t unknown) {
  const Unknown& u = fit.unknowns[unknown];
  const auto k = static_cast<Eigen::Index>(unknown + 1);
  return u.prior_sd > 0.0 || p.all(k, k) * u.scale * u.scale > kNothing * fit.loss;
}

/// Writes a matrix of some of the unknowns, numbered from 1, into one of all.
void scatter_into(Eigen::MatrixXd& all, const std::vector<Eigen::Index>& some,
                  const Eigen::MatrixXd& of_some) {
  for (std::size_t a = 0; a < some.size(); ++a)
    for (std::size_t b = 0; b < some.size(); ++b)
      all(some[a] - 1, some[b] - 1) = of_some(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b));
}

/// A sandwich: the windows' gradients scatter as their residuals do, whatever these are made of. `inside`: unknowns, numbered from 1, that are
/// told and not at a bound.
void set_covariance(const Products& p, const std::vector<Eigen::Index>& inside, double ridge, Fit& fit) {
  const auto count = static_cast<Eigen::Index>(fit.unknowns.size()),
             m = static_cast<Eigen::Index>(inside.size());
  fit.covariance = Eigen::MatrixXd::Zero(count, count);
  fit.of_prior = Eigen::MatrixXd::Zero(count, count);
  if (m == 0) return;
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(m, m);
  for (const Eigen::MatrixXf& w : p.window) {
    const Eigen::VectorXd g = w(inside, 0).cast<double>();
    scatter += g * g.transpose();
  }
  const double windows = static_cast<double>(p.window.size());
  const Eigen::MatrixXd inverse = ScaledNormal(p.all(inside, inside), ridge).inverse();
  // What is known beforehand scatters by itself, and is one value less that the windows must tell.
  Eigen::VectorXd prior = Eigen::VectorXd::Zero(m);
  double told = static_cast<double>(m);
  for (Eigen::Index a = 0; a < m; ++a) {
    const double sd =
        fit.unknowns[static_cast<std::size_t>(inside[static_cast<std::size_t>(a)] - 1)].prior_sd;
    if (!(sd > 0.0)) continue;
    prior(a) = 1.0 / (sd * sd);
    told -= std::min(1.0, prior(a) * inverse(a, a));
  }
  const Eigen::MatrixXd of_prior = inverse * prior.asDiagonal() * inverse;
  scatter_into(fit.of_prior, inside, of_prior);
  Eigen::MatrixXd both = inverse * scatter * inverse * (windows / std::max(1.0, windows - told));
  both += of_prior;
  scatter_into(fit.covariance, inside, both);
}

/// From the curvature alone, of unknowns at a bound too. A residual's variance is `each`.
void set_by_curvature(const Products& p, double each, Fit& fit) {
  const auto count = static_cast<Eigen::Index>(fit.unknowns.size());
  std::vector<Eigen::Index> told;
  for (Eigen::Index k = 0; k < count; ++k)
    if (is_told(fit, p, static_cast<std::size_t>(k))) told.push_back(k + 1);
  fit.by_curvature = Eigen::MatrixXd::Zero(count, count);
  fit.by_curvature.diagonal().setConstant(std::numeric_limits<double>::infinity());
  if (!told.empty())
    scatter_into(fit.by_curvature, told, each * ScaledNormal(p.all(told, told), 1e-12).inverse());
}

/// What each fold says alone, and how well the others predict it; by the linear problem.
void set_folds(const Products& p, const std::vector<Eigen::Index>& inside, Fit& fit) {
  fit.fold_value.assign(fit.unknowns.size(), {});
  fit.fold_information.assign(fit.unknowns.size(), {});
  for (const Eigen::MatrixXd& fold : p.fold) {
    fit.held_out_loss += fold(0, 0);
    if (inside.empty()) continue;
    const Eigen::MatrixXd normal = fold(inside, inside), rest = p.all(inside, inside) - normal;
    const Eigen::VectorXd right = fold(inside, 0);
    const Eigen::VectorXd without = ScaledNormal(rest, kRidge, 1e-12).solve(p.all(inside, 0) - right);
    fit.held_out_loss += without.dot(normal * without) - 2.0 * without.dot(right);
    const Eigen::MatrixXd inverse = ScaledNormal(normal, kRidge, 1e-12).inverse();
    const Eigen::VectorXd step = inverse * right;
    for (std::size_t a = 0; a < inside.size(); ++a) {
      const auto k = static_cast<std::size_t>(inside[a] - 1);
      const auto i = static_cast<Eigen::Index>(a);
      fit.fold_value[k].push_back(value_of(fit.at, fit.unknowns[k]) + step(i));
      fit.fold_information[k].push_back(1.0 / inverse(i, i));
    }
  }
}

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
  const double value = value_of(fit.at, u), curved = fit.by_curvature(i, i), tick = fit.tick_sd[unknown],
               half = 1.96 * std::sqrt(std::max(variance_of(fit, unknown), curved) + tick * tick);
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

double Problem::timing_doubt(const Cause& cause) const {
  if (has_all_inputs(model_, cause)) return kMostLate_rows / std::sqrt(3.0) * interval_s();
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

void Problem::set_intervals(const Products& p, double ridge, Fit& out) const {
  out.at_bound.assign(out.unknowns.size(), false);
  std::vector<Eigen::Index> inside;
  for (std::size_t k = 0; k < out.unknowns.size(); ++k) {
    const Unknown& u = out.unknowns[k];
    const double value = value_of(out.at, u), near = 1e-6 * std::max(std::abs(u.upper), u.scale);
    out.at_bound[k] = value <= u.lower + 1e-9 * u.scale || value >= u.upper - std::min(near, 1e-3 * u.scale);
    if (!out.at_bound[k] && is_told(out, p, k)) inside.push_back(static_cast<Eigen::Index>(k + 1));
  }
  set_covariance(p, inside, ridge, out);
  out.tick_sd.assign(out.unknowns.size(), 0.0);
  // All inputs, or all touch-downs, may be later, or earlier, by one time: no window tells.
  for (std::size_t k = 0; k < out.unknowns.size(); ++k) {
    const Unknown& u = out.unknowns[k];
    if (!u.of_cause || out.at_bound[k]) continue;
    const Cause& cause = out.at.causes[u.cause];
    if (cause.effect == Effect::actuator_lag ||
        (cause.effect == Effect::actuator_delay && !has_all_inputs(model_, cause)))
      out.tick_sd[k] = kMostLate_rows / std::sqrt(3.0) * interval_s();
    const double sd = timing_doubt(cause);
    out.covariance(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)) += sd * sd;
  }
  set_by_curvature(p, std::max(1.0, out.loss / static_cast<double>(windows_.size() * bins_ * joints())), out);
  set_folds(p, inside, out);
  out.window_loss.resize(p.window.size());
  for (std::size_t i = 0; i < p.window.size(); ++i)
    out.window_loss[i] = static_cast<double>(p.window[i](0, 0));
}

}  // namespace furcula::trees
