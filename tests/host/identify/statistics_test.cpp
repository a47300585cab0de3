// The distributions against tables and closed forms; effective counts, covariances and intervals against processes whose values are known.
#include "host/identify/statistics.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "host/core/quantile.hpp"
#include "host/identify/verdicts.hpp"

using namespace furcula;
using identify::WindowShare;

namespace {

/// x(n + 1) = memory x(n) + white noise.
Eigen::VectorXd autoregression(double memory, Eigen::Index rows, unsigned seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise;
  Eigen::VectorXd x(rows);
  x(0) = noise(random) / std::sqrt(1.0 - memory * memory);
  for (Eigen::Index i = 1; i < rows; ++i) x(i) = memory * x(i - 1) + noise(random);
  return x;
}

/// The share of a window in a least-squares fit: design rows `x`, residuals `r`.
WindowShare share(const Eigen::MatrixXd& x, const Eigen::VectorXd& r) {
  WindowShare s;
  s.squares = r.squaredNorm();
  s.gradient = x.transpose() * r;
  s.information = x.transpose() * x;
  return s;
}

/// The mean of `y`, fitted on windows of `length` rows that begin a `layers`-th of that apart.
identify::Fit fitted_mean(const Eigen::VectorXd& y, Eigen::Index length, std::size_t layers) {
  identify::Fit fit;
  double sum = 0.0, rows = 0.0;
  const Eigen::Index step = length / static_cast<Eigen::Index>(layers);
  for (Eigen::Index from = 0; from + length <= y.size(); from += step) {
    sum += y.segment(from, length).sum();
    rows += static_cast<double>(length);
  }
  const double mean = sum / rows;
  for (Eigen::Index from = 0; from + length <= y.size(); from += step)
    fit.shares.push_back(
        share(Eigen::VectorXd::Ones(length), (mean - y.segment(from, length).array()).matrix()));
  fit.values = {mean};
  fit.at_bound = {false};
  fit.layers = layers;
  fit.covariance = identify::jackknife_covariance(fit.shares, fit.at_bound, layers);
  return fit;
}

}  // namespace

TEST_CASE("Points of the chi-square are those of the tables, and of the closed form for even degrees") {
  // NIST/SEMATECH e-Handbook 1.3.6.7.4 to three decimals; further digits by 20-digit arithmetic.
  CHECK(core::chi_square_above(0.05, 1) == Approx(3.841458821).epsilon(1e-9));
  CHECK(core::chi_square_above(0.005, 1) == Approx(7.879438577).epsilon(1e-9));
  CHECK(core::chi_square_above(0.005, 3) == Approx(12.83815647).epsilon(1e-9));
  CHECK(core::chi_square_above(0.005, 10) == Approx(25.18817957).epsilon(1e-9));
  CHECK(core::chi_square_above(0.005, 20) == Approx(39.99684631).epsilon(1e-9));
  CHECK(core::chi_square_above(1e-6, 3) == Approx(30.66484971).epsilon(1e-9));
  for (const double level : {0.5, 1e-2, 1e-5, 1e-9}) {
    CHECK(core::chi_square_above(level, 2) == Approx(-2.0 * std::log(level)).epsilon(1e-12));
    const double half = 0.5 * core::chi_square_above(level, 6);
    CHECK(std::exp(-half) * (1.0 + half + 0.5 * half * half) == Approx(level).epsilon(1e-9));
    CHECK(std::erfc(std::sqrt(0.5 * core::chi_square_above(level, 1))) == Approx(level).epsilon(1e-9));
  }
}

TEST_CASE("Points of Student's t are those of the tables and of the closed forms") {
  const double pi = std::acos(-1.0);
  CHECK(core::student_t_within(0.95, 1) == Approx(std::tan(0.475 * pi)).epsilon(1e-10));
  CHECK(core::student_t_within(0.95, 2) ==
        Approx(0.95 * std::sqrt(2.0 / (1.0 - 0.95 * 0.95))).epsilon(1e-10));
  CHECK(core::student_t_within(0.95, 3) == Approx(3.182446305).epsilon(1e-9));
  CHECK(core::student_t_within(0.95, 3.75) == Approx(2.850989284).epsilon(1e-9));  // a beta function
  CHECK(core::student_t_within(0.95, 4) == Approx(2.776445105).epsilon(1e-9));
  CHECK(core::student_t_within(0.95, 10) == Approx(2.228138852).epsilon(1e-9));
  CHECK(core::student_t_within(0.95, 22) == Approx(2.073873068).epsilon(1e-9));
  CHECK(core::student_t_within(0.95, 100) == Approx(1.983971519).epsilon(1e-9));
}

TEST_CASE("White noise is worth its rows, and noise with a memory its rows over the correlation time") {
  constexpr Eigen::Index kRows = 200000;
  const auto share_of = [&](const Eigen::VectorXd& x) {
    return identify::effective_count(x) / static_cast<double>(x.size());
  };
  CHECK(share_of(autoregression(0.0, kRows, 1)) == Approx(1.0).epsilon(1e-12));
  // 1 + 2 sum of memory^k, up to the last term above 0.05: within 5 % of (1 + memory)/(1 - memory).
  for (const double memory : {0.5, 0.8, 0.95}) {
    const double last = std::floor(std::log(0.05) / std::log(memory));
    const double time = 1.0 + 2.0 * memory * (1.0 - std::pow(memory, last)) / (1.0 - memory);
    CAPTURE(memory);
    CHECK(share_of(autoregression(memory, kRows, 2)) == Approx(1.0 / time).epsilon(0.05));
    CHECK(time == Approx((1.0 + memory) / (1.0 - memory)).epsilon(0.06));
  }
  // A memory of some thousand rows, at a part of the lags alone.
  const double time = 1.0 + 2.0 * 0.998 * 0.95 / (1.0 - 0.998);
  CHECK(share_of(autoregression(0.998, 20 * kRows, 4)) == Approx(1.0 / time).epsilon(0.1));
  // Sums of two neighbours: correlated by a half at the first lag, by nothing at the others.
  const Eigen::VectorXd x = autoregression(0.0, kRows, 3);
  CHECK(share_of(x.head(kRows - 1) + x.tail(kRows - 1)) == Approx(0.5).epsilon(0.02));
  CHECK(identify::effective_count(Eigen::VectorXd::Zero(7)) == 7.0);
}

TEST_CASE("The covariance of a mean is its textbook standard error, that of a line the jackknife's") {
  const std::vector<double> y{2, 4, 4, 4, 5, 5, 7, 9};  // mean 5, sum of squares about it 32
  std::vector<WindowShare> shares;
  for (const double v : y)
    shares.push_back(share(Eigen::MatrixXd::Ones(1, 1), Eigen::VectorXd::Constant(1, 5.0 - v)));
  CHECK(identify::jackknife_covariance(shares, {false})(0, 0) == Approx(32.0 / (8 * 7)).epsilon(1e-12));
  // A line through six points: the closed form of a line through the other five, point by point.
  const std::vector<double> measured{1.1, 1.9, 3.2, 3.8, 5.5, 5.4};
  constexpr double kOffset = 0.19333333333333333, kSlope = 0.94;
  shares.clear();
  for (int i = 0; i < 6; ++i) {
    const double x = i + 1, line = kOffset + kSlope * x;
    shares.push_back(share(Eigen::RowVector2d(1.0, x),
                           Eigen::VectorXd::Constant(1, line - measured[static_cast<std::size_t>(i)])));
  }
  Eigen::Matrix2d expected = Eigen::Matrix2d::Zero();
  double of_slope_alone = 0.0;
  for (int without = 0; without < 6; ++without) {
    double n = 0.0, x1 = 0.0, x2 = 0.0, y1 = 0.0, xy = 0.0, of_residual = 0.0;
    for (int i = 0; i < 6; ++i) {
      if (i == without) continue;
      const double x = i + 1, value = measured[static_cast<std::size_t>(i)];
      n += 1.0, x1 += x, x2 += x * x, y1 += value, xy += x * value;
      of_residual += x * (value - kOffset - kSlope * x);
    }
    const double slope = (n * xy - x1 * y1) / (n * x2 - x1 * x1);
    const Eigen::Vector2d moved((y1 - slope * x1) / n - kOffset, slope - kSlope);
    expected += 5.0 / 6.0 * moved * moved.transpose();
    of_slope_alone += 5.0 / 6.0 * std::pow(of_residual / x2, 2);
  }
  const Eigen::MatrixXd c = identify::jackknife_covariance(shares, {false, false});
  CHECK((c - expected).cwiseAbs().maxCoeff() < 1e-9 * expected.cwiseAbs().maxCoeff());
  // On its bound the offset is no unknown, and stays what it is.
  const Eigen::MatrixXd held = identify::jackknife_covariance(shares, {true, false});
  CHECK(held(0, 0) == 0.0);
  CHECK(held(0, 1) == 0.0);
  // The pull of the six at the slope alone is zero: that of the other five is what the one takes away.
  CHECK(held(1, 1) == Approx(of_slope_alone).epsilon(1e-9));
}

TEST_CASE("What one window alone tells is as uncertain as twenty times its own pull") {
  // Three windows tell the first unknown; the last alone the second.
  std::vector<WindowShare> shares;
  for (const double pull : {1.0, -2.0, 1.0})
    shares.push_back(share(Eigen::RowVector2d(1.0, 0.0), Eigen::VectorXd::Constant(1, pull)));
  shares.push_back(share(Eigen::RowVector2d(0.0, 1.0), Eigen::VectorXd::Constant(1, 0.5)));
  const Eigen::MatrixXd c = identify::jackknife_covariance(shares, {false, false});
  CHECK(c(0, 0) == Approx(0.75 * (1.0 + 4.0 + 1.0) / 4.0).epsilon(1e-9));
  CHECK(c(1, 1) == Approx(0.75 * std::pow(20.0 * 0.5, 2)).epsilon(1e-9));
}

TEST_CASE(
    "What one window alone tells, exactly, is as uncertain as what the others tell, for its information") {
  // Two means: twenty windows of one, a single one of the other, which it meets exactly.
  std::mt19937_64 random(21);
  std::normal_distribution<double> noise;
  std::vector<WindowShare> shares;
  Eigen::VectorXd of_window(20);
  for (double& y : of_window) y = noise(random);
  for (const double y : of_window)
    shares.push_back(share(Eigen::RowVector2d(1.0, 0.0), Eigen::VectorXd::Constant(1, of_window.mean() - y)));
  shares.push_back(share(Eigen::RowVector2d(0.0, 1.0), Eigen::VectorXd::Zero(1)));
  const Eigen::MatrixXd covariance = identify::jackknife_covariance(shares, {false, false});
  CHECK(covariance(1, 1) == Approx(20.0 * covariance(0, 0)).epsilon(1e-9));
  CHECK(covariance(0, 1) == Approx(0.0).margin(1e-12));
}

TEST_CASE("Without the one window that tells a value nobody knows it better, and it stays") {
  std::vector<WindowShare> shares;
  for (const double y : {-1.0, 1.0})
    shares.push_back(share(Eigen::RowVector2d(1.0, 1e-4), Eigen::VectorXd::Constant(1, y)));
  shares.push_back(share(Eigen::RowVector2d(0.0, 1.0), Eigen::VectorXd::Zero(1)));
  const auto moved = [&](std::size_t without) {
    Eigen::Matrix2d others = Eigen::Matrix2d::Zero();
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
    for (std::size_t i = 0; i < shares.size(); ++i)
      if (i != without) others += shares[i].information, gradient += shares[i].gradient;
    return Eigen::VectorXd(identify::LeavingOut(shares, {false, false}).step(others, gradient));
  };
  CHECK(moved(0)(0) == Approx(-1.0).epsilon(1e-3));  // half of the windows tell it as well
  CHECK(moved(2).norm() < 1e-2);
}

TEST_CASE(
    "Windows that overlap are worth those side by side: as many degrees of freedom, no smaller scatter") {
  CHECK(identify::independent_windows(24, 4) == 6.0);
  CHECK(identify::independent_windows(24, 1) == 24.0);
  // 24 windows in 4 layers, two unknowns of unit information: 6 - 2 degrees of freedom.
  identify::Fit fit;
  fit.values = {0.0, 0.0};
  fit.at_bound = {false, false};
  fit.covariance = Eigen::Matrix2d::Identity();
  fit.layers = 4;
  for (int i = 0; i < 24; ++i)
    fit.shares.push_back(share(Eigen::Matrix2d::Identity(), Eigen::Vector2d::Zero()));
  const std::vector<identify::Unknown> unknowns{{false, {}, 0, "a", "", -100.0, 100.0},
                                                {false, {}, 1, "b", "", -100.0, 100.0}};
  CHECK(identify::parameter_verdicts(fit, unknowns)[0].upper == Approx(2.776445105).epsilon(1e-9));
  fit.layers = 1;
  CHECK(identify::parameter_verdicts(fit, unknowns)[0].upper == Approx(2.073873068).epsilon(1e-9));
}

TEST_CASE("The mean of noise lies in its 95 % interval 95 times of a hundred, however its windows overlap") {
  // White, and with a memory of a tenth of a window. The mean's variance is that of the noise's lowest frequency.
  constexpr int kRuns = 2000;
  for (const double memory : {0.0, 0.7})
    for (const std::size_t layers : {1, 2, 4}) {
      int held = 0;
      double variance = 0.0, squares = 0.0;
      for (unsigned run = 0; run < kRuns; ++run) {
        const auto fit = fitted_mean(autoregression(memory, 480, 1000 + run), 40, layers);
        const double t =
            core::student_t_within(0.95, identify::independent_windows(fit.shares.size(), layers) - 1.0);
        held += std::abs(fit.values[0]) <= t * std::sqrt(fit.covariance(0, 0)) ? 1 : 0;
        variance += fit.covariance(0, 0) / kRuns;
        squares += fit.values[0] * fit.values[0] / kRuns;
      }
      CAPTURE(memory, layers, held, variance / squares);
      CHECK(held >= 0.90 * kRuns);
      CHECK(held <= 0.98 * kRuns);
      CHECK(variance / squares > 0.65);
      CHECK(variance / squares < 1.3);
    }
}
