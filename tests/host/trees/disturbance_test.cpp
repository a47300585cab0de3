// Disturbances by the likelihood of windows, against covariances in closed form and values that were drawn.
#include "host/trees/disturbance.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <random>

#include "host/linear/linear.hpp"
#include "host/trees/fit.hpp"
#include "host/trees/linearised.hpp"
#include "tests/host/trees/robot.hpp"

using namespace furcula;
using trees::Disturbance;
using trees::Effect;
using Index = Eigen::Index;

namespace {

constexpr double kPart_s = 0.0125;
constexpr Index kTimes = 24;

/// Angles of two free wheels by torques, each held for a part of the time, at the parts' ends.
Eigen::MatrixXd of_wheels(double first_kgm2, double second_kgm2) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(2 * kTimes, 2 * kTimes);
  for (Index joint = 0; joint < 2; ++joint)
    for (Index torque = 0; torque < kTimes; ++torque)
      for (Index time = torque; time < kTimes; ++time)
        out(2 * time + joint, joint * kTimes + torque) = kPart_s * kPart_s *
                                                         (static_cast<double>(time - torque) + 0.5) /
                                                         (joint == 0 ? first_kgm2 : second_kgm2);
  return out;
}

/// Windows of wheels on which torques of one correlation time act, drawn step by step.
std::vector<trees::DisturbedWindow> drawn(std::size_t count, double torque_nm, double time_s,
                                          double noise_rad, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd torques = of_wheels(0.02, 0.005);
  const double keeps = time_s > 0.0 ? std::exp(-kPart_s / time_s) : 0.0;
  std::vector<trees::DisturbedWindow> out;
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::VectorXd u = Eigen::VectorXd::Zero(2 * kTimes);
    for (Index k = 0; k < kTimes; ++k)  // at the first wheel alone
      u(k) = k == 0 ? torque_nm * normal(random)
                    : keeps * u(k - 1) + std::sqrt(1.0 - keeps * keeps) * torque_nm * normal(random);
    Eigen::VectorXd left = torques * u;
    for (double& x : left) x += noise_rad * normal(random);
    out.push_back({torques, Eigen::MatrixXd::Zero(2 * kTimes, 2 * kTimes), left});
  }
  return out;
}

Disturbance start() {
  return {Eigen::MatrixXd::Constant(2, static_cast<Index>(Disturbance::kTime_s.size()), 1e-2),
          Eigen::Vector2d::Constant(1e-6)};
}

}  // namespace

TEST_CASE("A window's covariance is that of an Ornstein-Uhlenbeck torque and of noise") {
  const Eigen::MatrixXd torques = of_wheels(0.02, 0.005);
  Disturbance d{Eigen::MatrixXd::Zero(2, 3), Eigen::Vector2d(4e-8, 9e-8)};
  d.torque(1, 2) = 0.25;  // 0.5 N m, correlated over 0.5 s
  const Eigen::MatrixXd is = trees::covariance(d, torques, kPart_s);
  for (Index a = 0; a < kTimes; a += 5)
    for (Index b = 0; b < kTimes; b += 7) {
      double second = a == b ? 9e-8 : 0.0;
      for (Index s = 0; s < kTimes; ++s)
        for (Index t = 0; t < kTimes; ++t)
          second += 0.25 * std::exp(-std::abs(static_cast<double>(s - t)) * kPart_s / 0.5) *
                    torques(2 * a + 1, kTimes + s) * torques(2 * b + 1, kTimes + t);
      CHECK(is(2 * a + 1, 2 * b + 1) == Approx(second).epsilon(1e-9));
      CHECK(is(2 * a, 2 * b) == Approx(a == b ? 4e-8 : 0.0).margin(1e-15));
      CHECK(is(2 * a, 2 * b + 1) == Approx(0.0).margin(1e-15));
    }
}

TEST_CASE("Torques and noise that were drawn are estimated, at the joint where they act") {
  for (const double time_s : {0.0, 0.05, 0.5}) {
    INFO(time_s << " s");
    constexpr double kTorque_nm = 0.3, kNoise_rad = 2e-4;
    const auto windows = drawn(120, kTorque_nm, time_s, kNoise_rad, 7);
    const Disturbance d = trees::estimate(start(), windows, kPart_s, Eigen::Vector2d::Constant(1e-12), 2);
    CHECK(std::sqrt(d.torque.row(0).sum()) == Approx(kTorque_nm).epsilon(0.15));
    CHECK(std::sqrt(d.torque.row(1).sum()) < 0.1 * kTorque_nm);
    CHECK(std::sqrt(d.noise(0)) == Approx(kNoise_rad).epsilon(0.1));
    CHECK(std::sqrt(d.noise(1)) == Approx(kNoise_rad).epsilon(0.1));
    // The right correlation time has most of it.
    Index most = 0;
    d.torque.row(0).maxCoeff(&most);
    CHECK(Disturbance::kTime_s[static_cast<std::size_t>(most)] == time_s);
    // Windows of that covariance have squares as many as residuals.
    double squares = 0.0;
    for (const trees::DisturbedWindow& w : windows)
      squares += w.left.dot(Eigen::VectorXd(trees::covariance(d, w.torques, kPart_s).llt().solve(w.left)));
    CHECK(squares == Approx(120.0 * 2.0 * kTimes).epsilon(0.03));
  }
}

TEST_CASE("A window whose run flies apart changes nothing, and has finite weights") {
  auto windows = drawn(40, 0.3, 0.05, 2e-4, 11);
  const Eigen::Vector2d least = Eigen::Vector2d::Constant(1e-12);
  const Disturbance before = trees::estimate(start(), windows, kPart_s, least, 2);
  windows.push_back(windows.front());
  // Changes of a linearised run end at 1e6. All torques do the same: what they make has one direction, and the rest is lost in rounding.
  for (Index row = 0; row < 2 * kTimes; ++row)
    windows.back().torques.row(row).setConstant(1e6 * std::sin(1.0 + static_cast<double>(row)));
  const Disturbance d = trees::estimate(start(), windows, kPart_s, least, 2);
  CHECK(d.torque.row(0).sum() == Approx(before.torque.row(0).sum()).epsilon(0.02));
  const Eigen::MatrixXd covariance = trees::covariance(d, windows.back().torques, kPart_s);
  REQUIRE(covariance.llt().info() != Eigen::Success);
  const Eigen::MatrixXd root = linear::root_of_positive(covariance);
  CHECK(root.allFinite());
  CHECK(root.diagonal().minCoeff() > 0.0);
}

TEST_CASE("Noise is estimated no lower than it is known to be") {
  const auto windows = drawn(40, 0.3, 0.05, 1e-5, 9);
  const Disturbance d = trees::estimate(start(), windows, kPart_s, Eigen::Vector2d::Constant(1e-8), 2);
  CHECK(d.noise(0) == 1e-8);
  CHECK(d.noise(1) == 1e-8);
}

TEST_CASE("A constant torque is the sum of torques in all parts of a window's time") {
  const trees::TreeModel model = test::arm3();
  trees::Recording r = test::inputs(model, 1.5, 0.001, [](std::size_t j, double t) {
    return 0.8 * std::sin((5.0 + 2.0 * static_cast<double>(j)) * t);
  });
  const std::vector<trees::Recording> all{r};
  const trees::Window w = trees::windows_of(model, all, 0.3)[1];
  const trees::SetupMaker maker(model);
  const trees::Setup base = maker.make({model.drives, {}});
  const std::vector<double> torque_nm(model.joints(), 1e-3);
  const trees::Linearised run(base, r, w, torque_nm);
  constexpr std::size_t kParts = 24;
  const Eigen::MatrixXd parts = run.of_torques(kParts);
  REQUIRE(parts.cols() == static_cast<Index>(kParts * model.joints()));
  for (std::size_t j = 0; j < model.joints(); ++j) {
    const std::vector<trees::Cause> push{{Effect::force_offset, {j}, {0.01, 0, 0, 0}}};
    const trees::Setup pushed = maker.make({model.drives, push});
    const trees::Setup* const one[] = {&pushed};
    const Eigen::VectorXd whole = run.changes(one).col(0),
                          sum =
                              0.01 * parts.middleCols(static_cast<Index>(j * kParts), kParts).rowwise().sum();
    CHECK((whole - sum).norm() < 1e-9 * whole.norm());
    // What comes in the last part shows in no bin before.
    CHECK(parts.col(static_cast<Index>((j + 1) * kParts - 1)).head(whole.size() / 2).norm() == 0.0);
  }
}

TEST_CASE("Whitened by what disturbs it, a right model's loss is the number of its residuals") {
  const trees::TreeModel model = test::arm3();
  std::vector<trees::Recording> recordings;
  for (const log::Log& log : test::logs(model, 3, 5.0, 41))
    recordings.push_back(trees::recording_of(model, log));
  trees::Problem problem(model, recordings, trees::windows_of(model, recordings, 0.3), 2);
  const trees::Hypothesis right{model.drives, {}};
  problem.weigh(right);
  problem.whiten(right);
  const trees::Fit fit = problem.fit(right, 0);
  const auto residuals = static_cast<double>(problem.windows().size()) *
                         static_cast<double>(problem.windows().front().measured.size());
  CHECK(fit.loss < 1.1 * residuals);
  CHECK(fit.loss > 0.5 * residuals);
  // It stays so however often.
  problem.whiten(right);
  CHECK(problem.fit(right, 0).loss == Approx(fit.loss).epsilon(0.02));
}
