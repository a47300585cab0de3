// See linear.hpp.
#include "host/trees/linear.hpp"

#include <algorithm>
#include <cmath>

#include "host/linear/linear.hpp"

namespace furcula::trees {

ScaledNormal::ScaledNormal(const Eigen::MatrixXd& normal, double ridge, double least)
    : unit_(normal.diagonal()
                .cwiseMax(normal.size() == 0 ? 0.0 : least * normal.diagonal().maxCoeff())
                .cwiseMax(1e-300)
                .cwiseSqrt()
                .cwiseInverse()),
      scaled_(unit_.asDiagonal() * normal * unit_.asDiagonal() +
              ridge * Eigen::MatrixXd::Identity(normal.rows(), normal.cols())) {}

Eigen::MatrixXd ScaledNormal::solve(const Eigen::MatrixXd& right) const {
  return unit_.asDiagonal() * linear::solve_symmetric(scaled_, Eigen::MatrixXd(unit_.asDiagonal() * right));
}

Mean weighted_mean(std::span<const double> value, std::span<const double> information) {
  double total = 0.0;
  for (const double i : information) total += i;
  if (!(total > 0.0)) return {};
  Mean out;
  double squares = 0.0;
  for (std::size_t k = 0; k < value.size(); ++k) {
    const double w = information[k] / total;
    out.value += w * value[k];
    squares += w * w;
  }
  for (std::size_t k = 0; k < value.size(); ++k) {
    const double off = information[k] / total * (value[k] - out.value);
    out.variance += off * off;
  }
  out.variance /= std::max(0.1, 1.0 - squares);
  out.freedom = 1.0 / squares - 1.0;
  return out;
}

double steadiness(std::span<const double> value, std::span<const double> information) {
  const Mean mean = weighted_mean(value, information);
  if (mean.value == 0.0) return 0.0;
  // Where one recording has nearly all of the information, the others cannot contradict it.
  if (mean.freedom < 0.3) return 2.0;
  // Of chance alone: 6 % of two recordings pass, 1 % of six, 0.2 % of many.
  const double limit = 3.2 * (1.0 + 2.2 / std::pow(mean.freedom, 1.3));
  return std::abs(mean.value) / std::sqrt(std::max(mean.variance, 1e-300)) / limit;
}

}  // namespace furcula::trees
