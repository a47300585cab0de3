// The strategy on functions whose minimum is known.
#include "host/walk/cma_es.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <limits>

using furcula::walk::CmaEs;
using Vector = Eigen::VectorXd;

namespace {

double ellipsoid(const Vector& x) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    sum += std::pow(1e6, static_cast<double>(i) / static_cast<double>(x.size() - 1)) * x(i) * x(i);
  return sum;
}
double rosenbrock(const Vector& x) {
  double sum = 0.0;
  for (Eigen::Index i = 0; i + 1 < x.size(); ++i)
    sum += 100.0 * std::pow(x(i + 1) - x(i) * x(i), 2) + std::pow(1.0 - x(i), 2);
  return sum;
}

/// Evaluations until the function is below `goal`; at most `most`.
std::size_t evaluations(const Vector& start, double sigma, const std::function<double(const Vector&)>& f,
                        double goal, std::size_t most, std::uint64_t seed) {
  CmaEs strategy(start, sigma, 12, seed);
  std::size_t n = 0;
  while (n < most) {
    std::vector<double> values;
    for (const Vector& x : strategy.ask()) values.push_back(f(x));
    strategy.tell(values);
    for (const double v : values) {
      ++n;
      if (v < goal) return n;
    }
  }
  return most;
}

}  // namespace

TEST_CASE("an ellipsoid with axes of 1 to 1000 is descended, wherever its axes point") {
  // Hansen's tutorial has some 6,000 evaluations for 10 dimensions; without adaptation of the covariance a million would not do.
  Eigen::MatrixXd turn = Eigen::MatrixXd::Zero(10, 10);
  for (Eigen::Index i = 0; i < 10; ++i)
    for (Eigen::Index j = 0; j < 10; ++j)
      turn(i, j) = std::sqrt((i == 0 ? 1.0 : 2.0) / 10.0) *
                   std::cos(std::acos(-1.0) * (static_cast<double>(j) + 0.5) * static_cast<double>(i) / 10.0);
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    CHECK(evaluations(Vector::Ones(10), 0.5, ellipsoid, 1e-10, 20000, seed) < 9000);
    CHECK(evaluations(
              Vector::Ones(10), 0.5, [&](const Vector& x) { return ellipsoid(turn * x); }, 1e-10, 20000,
              seed) < 9000);
  }
}

TEST_CASE("Rosenbrock's valley is followed to its end") {
  std::size_t reached = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u})
    if (evaluations(Vector::Zero(8), 0.3, rosenbrock, 1e-8, 30000, seed) < 30000) ++reached;
  CHECK(reached >= 3);  // it has a second, worse minimum
}

TEST_CASE("one seed gives one sequence, and what is not a number is never chosen") {
  CmaEs a(Vector::Zero(5), 0.3, 8, 7), b(Vector::Zero(5), 0.3, 8, 7), other(Vector::Zero(5), 0.3, 8, 8);
  CHECK(other.ask()[0] != a.ask()[0]);
  for (int generation = 0; generation < 30; ++generation) {
    const auto& x = a.ask();
    const auto& y = b.ask();
    std::vector<double> values;
    for (std::size_t i = 0; i < x.size(); ++i) {
      CHECK(x[i] == y[i]);
      // Half of space is none: the minimum of the other half is at its rim.
      values.push_back(x[i](0) < 0.5 ? std::numeric_limits<double>::quiet_NaN() : x[i].squaredNorm());
    }
    a.tell(values);
    b.tell(values);
  }
  CHECK(a.mean().allFinite());
  CHECK(a.mean()(0) > 0.4);
}
