// Whitening against the covariance of what disturbs a run, summed up row by row.
#include "host/identify/whitening.hpp"

#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula;

TEST_CASE(
    "What whitening makes of residuals of a run under a random force is independent, with a variance of 1") {
  // A damped oscillator of which each row has another rate; the force's correlation is 5 rows.
  constexpr Eigen::Index kRows = 40;
  constexpr double kNoise = 0.7, kForce = 2.0;
  const double kept = std::exp(-1.0 / 5.0);
  std::vector<Eigen::Matrix2d> by;
  std::vector<Eigen::Vector2d> force;
  for (Eigen::Index i = 0; i + 1 < kRows; ++i) {
    const double turn = 0.1 + 0.002 * static_cast<double>(i);
    by.push_back(0.98 * Eigen::Rotation2Dd(turn).toRotationMatrix());
    force.emplace_back(0.05, 0.3);
  }
  // Each row's position as a sum of the forces' independent parts and of the sensor's noise.
  Eigen::MatrixXd parts = Eigen::MatrixXd::Zero(kRows, kRows);
  for (Eigen::Index from = 0; from < kRows; ++from) {
    Eigen::Vector2d state = Eigen::Vector2d::Zero();
    double now = 0.0;
    for (Eigen::Index i = 0; i < kRows; ++i) {
      parts(i, from) = state(0);
      if (i == from) now = kForce * (i == 0 ? 1.0 : std::sqrt(1.0 - kept * kept));
      if (i + 1 == kRows) break;
      state = (by[static_cast<std::size_t>(i)] * state + force[static_cast<std::size_t>(i)] * now).eval();
      now *= kept;
    }
  }
  const Eigen::MatrixXd covariance =
      parts * parts.transpose() + kNoise * kNoise * Eigen::MatrixXd::Identity(kRows, kRows);

  identify::Whitening whitening;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  spread(2, 2) = kForce * kForce;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    identify::Whitening::Row row;
    const double variance = spread(0, 0) + kNoise * kNoise;
    row.gain = spread.col(0) / variance;
    row.scale = 1.0 / std::sqrt(variance);
    if (i + 1 < kRows) {
      row.step.topLeftCorner<2, 2>() = by[static_cast<std::size_t>(i)];
      row.step.topRightCorner<2, 1>() = force[static_cast<std::size_t>(i)];
      row.step(2, 2) = kept;
    }
    spread = (spread - row.gain * spread.row(0)).eval();
    spread = (row.step * spread * row.step.transpose()).eval();
    spread(2, 2) += kForce * kForce * (1.0 - kept * kept);
    whitening.rows.push_back(row);
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  RowMajor all = RowMajor::Identity(kRows, kRows);
  whitening.apply(all.data(), kRows, kRows);
  const Eigen::MatrixXd of_new = all * covariance * all.transpose();
  CHECK((of_new - Eigen::MatrixXd::Identity(kRows, kRows)).cwiseAbs().maxCoeff() < 1e-9);

  // Rows that it does not reach do not count.
  RowMajor more = RowMajor::Ones(kRows + 3, 2);
  whitening.apply(more.data(), kRows + 3, 2);
  CHECK(more.bottomRows(3).isZero(0.0));
  CHECK(more(0, 1) == whitening.rows.front().scale);
}
