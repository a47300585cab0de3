// Ljung and Box's test on series of known correlation.
#include "host/diagnose/whiteness.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace furcula;
using diagnose::LagSums;

namespace {

/// x(n + 1) = memory x(n) + white noise, in windows of so many rows that begin anew.
LagSums sums_of(double memory, int windows, int rows, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise;
  LagSums sums;
  for (int w = 0; w < windows; ++w) {
    std::vector<double> x{noise(random) / std::sqrt(1.0 - memory * memory)};
    while (static_cast<int>(x.size()) < rows) x.push_back(memory * x.back() + noise(random));
    sums.add(x);
  }
  return sums;
}

}  // namespace

TEST_CASE("White noise is called coloured once in a hundred times, and its p-values are even") {
  // Of 1000: 10 expected below 0.01 and 500 below 0.5, within four deviations of a binomial.
  int coloured = 0, below_half = 0;
  for (unsigned seed = 0; seed < 1000; ++seed) {
    const auto w = diagnose::ljung_box(sums_of(0.0, 10, 60, seed));
    coloured += !w.white();
    below_half += w.p_value < 0.5;
  }
  CHECK(coloured < 23);
  CHECK(std::abs(below_half - 500) < 63);
}

TEST_CASE("What hangs on the row before is told, with its correlation and the lag") {
  const auto w = diagnose::ljung_box(sums_of(0.2, 10, 500, 3));
  CHECK_FALSE(w.white());
  CHECK(w.p_value < 1e-9);  // 5000 rows of a correlation of 0.2: a chi-square above 5000 * 0.04
  CHECK(w.statistic > 150.0);
  CHECK(w.lag == 1);
  CHECK(w.correlation == Approx(0.2).margin(0.05));
  CHECK(w.rows == 5000.0);
}

TEST_CASE("Of one short series the statistic is that of Ljung and Box's formula") {
  // 1, -1, 1, ... of 40 rows: r(k) = (-1)^k (40 - k) / 40, and Q = 40 * 42 * sum of r(k)^2 / (40 - k).
  std::vector<double> x;
  for (int i = 0; i < 40; ++i) x.push_back(i % 2 == 0 ? 1.0 : -1.0);
  LagSums sums;
  sums.add(x);
  double expected = 0.0;
  for (int k = 1; k <= 20; ++k) expected += 40.0 * 42.0 * (40 - k) / 1600.0;
  const auto w = diagnose::ljung_box(sums);
  CHECK(w.statistic == Approx(expected));
  CHECK(w.correlation == Approx(-39.0 / 40.0));
}

TEST_CASE("Windows do not hang together, and nothing is white") {
  // The same value in each row of a window, of another sign in the next: within windows all alike.
  LagSums sums;
  sums.add({1.0, 1.0, 1.0});
  sums.add({-1.0, -1.0, -1.0});
  CHECK(sums.products[1] == 4.0);
  CHECK(sums.products[3] == 0.0);
  CHECK(sums.pairs[2] == 2.0);
  CHECK(diagnose::ljung_box({}).white());
}
