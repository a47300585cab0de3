// How likely models make recordings of a machine that a random force disturbs: an axis of its own equations, not the plant's.
#include "host/diagnose/remainder.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

#include "host/identify/simulation_fit.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using dynamics::Effect;

namespace {

/// 12 kg and 30 N s/m under steps of force that act through a first-order lag of 8 ms, and under an Ornstein-Uhlenbeck force of 0.3 N and 20 ms;
/// 500 rows a second, noise of 20 um.
log::Log lagging_axis(unsigned seed) {
  constexpr double kStep_s = 1e-4, kLag_s = 0.008, kRandom_n = 0.3, kCorrelation_s = 0.02;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(-40.0, 40.0);
  log::Log log;
  log.path = "axis-" + std::to_string(seed) + ".csv";
  log.rig = "motor_axis";
  double x = 0.0, v = 0.0, force = 0.0, disturbance = 0.0, command = 0.0;
  for (int n = 0; n <= 60000; ++n) {
    if (n % 1500 == 0) command = uniform(random);
    if (n % 20 == 0) {
      log.columns["time_s"].push_back(kStep_s * n);
      log.columns["position_m"].push_back(x + 2e-5 * normal(random));
      log.columns["force_n"].push_back(command);
    }
    const double kept = std::exp(-kStep_s / kCorrelation_s);
    disturbance = kept * disturbance + kRandom_n * std::sqrt(1.0 - kept * kept) * normal(random);
    force += (command - force) * (1.0 - std::exp(-kStep_s / kLag_s));
    v += kStep_s * (force + disturbance - 30.0 * v) / 12.0;
    x += kStep_s * v;
  }
  return log;
}

}  // namespace

TEST_CASE("A lag and a delay of the same time, which leave as much, are told apart under random forces") {
  const auto recordings =
      identify::make_recordings({lagging_axis(1), lagging_axis(2)}, dynamics::Kind::motor_axis);
  const model::Model given = test::axis_model(12.0, 30.0);
  const auto windows = identify::prediction_windows(recordings, given, 0.5);
  model::Model lag = given, delay = given, heavier = given;
  lag.effects[Effect::actuator_lag] = {0.008};
  delay.effects[Effect::actuator_delay] = {0.008};
  heavier.effects = lag.effects;
  heavier.parameters[0] *= 1.0002;
  const auto over_delay = diagnose::evidence_under_disturbances(delay, recordings, windows);
  const auto over_lag = diagnose::evidence_under_disturbances(lag, recordings, windows);
  REQUIRE(over_delay);
  REQUIRE(over_lag);
  CHECK(*over_lag(lag) == 0.0);
  // Odds of ten thousand to one, at least.
  CHECK(*over_delay(lag) > 20.0);
  CHECK(*over_lag(delay) < -20.0);
  CHECK(*over_lag(given) < *over_lag(delay));
  // A mass that is wrong by a fiftieth of a per cent makes less force than the random one.
  CHECK(std::abs(*over_lag(heavier)) < 4.0);
  // Friction that holds the axis where the other model moves on: what a run from a held start does not weigh decides nothing.
  model::Model stuck = lag;
  stuck.effects[Effect::coulomb_friction] = {200.0};
  CHECK_FALSE(over_lag(stuck));
}

TEST_CASE("Whitened runs of the true model leave white noise, and their fit is nearer and knows how near") {
  const model::Model given = test::axis_model(12.0, 30.0);
  model::Model lag = given;
  lag.effects[Effect::actuator_lag] = {0.008};
  constexpr unsigned kLogs = 12;
  double off = 0.0, off_of_runs = 0.0;
  int held = 0;
  for (unsigned seed = 1; seed <= kLogs; ++seed) {
    const auto recordings = identify::make_recordings({lagging_axis(seed)}, dynamics::Kind::motor_axis);
    const auto windows = identify::prediction_windows(recordings, given, 0.5);
    const auto whitening = diagnose::whitening_about(lag, recordings, windows);
    REQUIRE(whitening);
    const auto unknowns = identify::free_unknowns(given);
    const auto fitted = [&](const std::vector<identify::Whitening>* by) {
      identify::Effort effort;
      effort.whitening = by;
      return identify::fit_by_simulation(lag, unknowns, {11.0, 40.0}, recordings, windows,
                                         identify::Weighting::noise, 1, effort);
    };
    const identify::Fit runs = fitted(nullptr), white = fitted(&*whitening);
    double squares = 0.0, rows = 0.0, independent = 0.0;
    for (const identify::WindowShare& s : white.shares) {
      squares += s[identify::Channel::motion].squares, rows += s[identify::Channel::motion].rows;
      independent += s[identify::Channel::motion].effective_rows;
    }
    CHECK(squares / rows == Approx(1.0).margin(0.1));  // 3000 rows: 4 standard errors
    CHECK(independent > 0.9 * rows);
    off += std::pow(white.values[0] - 12.0, 2), off_of_runs += std::pow(runs.values[0] - 12.0, 2);
    held += std::abs(white.values[0] - 12.0) < 1.96 * std::sqrt(white.covariance(0, 0));
  }
  UNSCOPED_INFO("mass off by " << std::sqrt(off / kLogs) << " kg, by squares of free runs "
                               << std::sqrt(off_of_runs / kLogs) << " kg; in " << held << " intervals");
  CHECK(off < 0.5 * off_of_runs);
  CHECK(held >= 9);  // of 12 at 95 %, by chance fewer once in 500 times
}
