#include "host/optimise/spline.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace furcula::optimise {

std::size_t Spline::interval_at(double s) const {
  const auto n = static_cast<double>(intervals_);
  return static_cast<std::size_t>(std::clamp(s * n, 0.0, n - 1.0));
}

double Spline::knot(std::ptrdiff_t i) const {
  const auto n = static_cast<double>(intervals_);
  return std::clamp((static_cast<double>(i) - static_cast<double>(kDegree)) / n, 0.0, 1.0);
}

Spline::Basis Spline::basis(double s, std::size_t interval) const {
  // Cox and de Boor's recursion on the coefficients of one interval; derivatives from the lower degrees.
  Basis out;
  out.first = interval;
  const auto k = static_cast<std::ptrdiff_t>(out.first + kDegree);
  std::array<std::array<double, kOrder>, kOrder> n{};  // by degree, then place
  n[0][0] = 1.0;
  for (std::size_t p = 1; p <= kDegree; ++p)
    for (std::size_t j = 0; j <= p; ++j) {
      const std::ptrdiff_t i = k - static_cast<std::ptrdiff_t>(p) + static_cast<std::ptrdiff_t>(j);
      const auto q = static_cast<std::ptrdiff_t>(p);
      double sum = 0.0;
      if (j > 0) sum += n[p - 1][j - 1] * (s - knot(i)) / (knot(i + q) - knot(i));
      if (j < p) sum += n[p - 1][j] * (knot(i + q + 1) - s) / (knot(i + q + 1) - knot(i + 1));
      n[p][j] = sum;
    }
  // D N(i, p) = p (N(i, p-1) / (t(i+p) - t(i)) - N(i+1, p-1) / (t(i+p+1) - t(i+1)))
  const auto raised = [&](const std::array<double, kOrder>& lower, std::size_t p) {
    std::array<double, kOrder> o{};
    const auto q = static_cast<std::ptrdiff_t>(p);
    for (std::size_t j = 0; j <= p; ++j) {
      const std::ptrdiff_t i = k - q + static_cast<std::ptrdiff_t>(j);
      double sum = 0.0;
      if (j > 0) sum += lower[j - 1] / (knot(i + q) - knot(i));
      if (j < p) sum -= lower[j] / (knot(i + q + 1) - knot(i + 1));
      o[j] = static_cast<double>(p) * sum;
    }
    return o;
  };
  for (std::size_t d = 0; d <= kDegree; ++d) {
    out.share[d] = n[kDegree - d];
    for (std::size_t p = kDegree - d + 1; p <= kDegree; ++p) out.share[d] = raised(out.share[d], p);
  }
  return out;
}

std::vector<double> Spline::fitted(const std::vector<double>& values) const {
  Eigen::MatrixXd a = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(values.size()),
                                            static_cast<Eigen::Index>(coefficients()));
  Eigen::VectorXd b(static_cast<Eigen::Index>(values.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Basis at = basis(static_cast<double>(i) / static_cast<double>(values.size() - 1));
    for (std::size_t j = 0; j < kOrder; ++j)
      a(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(at.first + j)) = at.share[0][j];
    b(static_cast<Eigen::Index>(i)) = values[i];
  }
  const Eigen::VectorXd c = a.completeOrthogonalDecomposition().solve(b);
  return {c.data(), c.data() + c.size()};
}

}  // namespace furcula::optimise
