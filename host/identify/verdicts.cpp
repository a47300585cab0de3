#include "host/identify/verdicts.hpp"

#include <algorithm>
#include <cmath>

#include "host/core/quantile.hpp"
#include "host/linear/linear.hpp"

namespace furcula::identify {
namespace {

/// Above this correlation of two estimates only a combination of them is known: one of them fixed, the
/// other's interval would shrink more than three-fold.
constexpr double kCorrelated = 0.95;
constexpr double kSingular = 1e-12;  ///< what keeps a direction without information from dividing by zero
constexpr double kUnknown = 1e6;     ///< variance inflation above which a value is not known at all
/// What the simulator's own discretisation and an input held from row to row are worth, of a value (standard
/// deviation): no recording makes an estimate more certain than that.
constexpr double kNumerics = 1.5e-3;
constexpr double kNotExcited = 1.0;  ///< half width of the interval over the value

}  // namespace

std::vector<ParameterVerdict> parameter_verdicts(const Fit& fit, const std::vector<Unknown>& unknowns) {
  const std::size_t count = unknowns.size();
  std::vector<ParameterVerdict> all(count);
  Eigen::MatrixXd information =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(count), static_cast<Eigen::Index>(count));
  for (const WindowShare& s : fit.shares) information += s.information;
  // Correlations of the estimates, over the parameters that are not at a bound.
  std::vector<Eigen::Index> moving;
  for (std::size_t i = 0; i < count; ++i)
    if (!fit.at_bound[i] && information(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) > 0.0)
      moving.push_back(static_cast<Eigen::Index>(i));
  const auto free = static_cast<Eigen::Index>(moving.size());
  Eigen::MatrixXd scaled(free, free);
  for (Eigen::Index i = 0; i < free; ++i)
    for (Eigen::Index k = 0; k < free; ++k) {
      const Eigen::Index a = moving[static_cast<std::size_t>(i)], b = moving[static_cast<std::size_t>(k)];
      scaled(i, k) = information(a, b) / std::sqrt(information(a, a) * information(b, b));
    }
  const Eigen::MatrixXd inverse =
      free > 0 ? linear::inverse(scaled + kSingular * Eigen::MatrixXd::Identity(free, free))
               : Eigen::MatrixXd();
  const double windows = independent_windows(fit.shares.size(), fit.layers);
  const double t = core::student_t_within(0.95, std::max(1.0, windows - static_cast<double>(count)));
  for (std::size_t i = 0; i < count; ++i) {
    ParameterVerdict& v = all[i];
    v.value = fit.values[i];
    const double variance = fit.covariance(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i));
    const double half = t * std::hypot(std::sqrt(std::max(0.0, variance)), kNumerics * v.value);
    v.lower = v.value - half;
    v.upper = v.value + half;
    // A value near zero may be known well: it is measured by a hundredth of its bounds' distance too.
    const double scale = std::max(std::abs(v.value), 0.01 * (unknowns[i].upper - unknowns[i].lower));
    v.verdict = half > kNotExcited * scale ? "not_excited" : "identified";
    if (!(information(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i)) > 0.0)) {
      v.verdict = "not_excited";
      v.lower = unknowns[i].lower;
      v.upper = unknowns[i].upper;
    }
    if (i < fit.ranges.size() && fit.ranges[i].first < fit.ranges[i].second) {
      // Known to a range, all of which explains the windows as well, and to what the numerics are worth.
      v.lower = fit.ranges[i].first - kNumerics * v.value;
      v.upper = fit.ranges[i].second + kNumerics * v.value;
      v.verdict = v.upper - v.lower > kNotExcited * 0.5 * (unknowns[i].upper - unknowns[i].lower)
                      ? "not_excited"
                      : "identified";
    }
    if (fit.at_bound[i]) {
      const bool lower = v.value - unknowns[i].lower < unknowns[i].upper - v.value;
      v.verdict = "at_bound";
      v.with = lower ? "lower" : "upper";
    }
  }
  for (Eigen::Index i = 0; i < free; ++i) {
    const auto own = static_cast<std::size_t>(moving[static_cast<std::size_t>(i)]);
    if (inverse(i, i) > kUnknown) {
      all[own].lower = unknowns[own].lower;
      all[own].upper = unknowns[own].upper;
    }
    double strongest = kCorrelated;
    for (Eigen::Index k = 0; k < free; ++k) {
      const double product = inverse(i, i) * inverse(k, k);
      const double correlation =
          i == k || !(product > 0.0) ? 0.0 : std::abs(inverse(i, k)) / std::sqrt(product);
      if (correlation <= strongest) continue;
      strongest = correlation;
      ParameterVerdict& v = all[own];
      v.verdict = "correlated";
      v.with = unknowns[static_cast<std::size_t>(moving[static_cast<std::size_t>(k)])].name;
    }
  }
  // A law with one of its parameters held by a bound has the others in its place: they may be anything.
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < count; ++k)
      if (i != k && unknowns[i].of_effect && unknowns[k].of_effect &&
          unknowns[i].effect == unknowns[k].effect && fit.at_bound[k]) {
        all[i].lower = unknowns[i].lower;
        all[i].upper = unknowns[i].upper;
      }
  return all;
}

}  // namespace furcula::identify
