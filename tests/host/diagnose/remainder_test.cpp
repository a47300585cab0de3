// How likely models make recordings of a machine that a random force disturbs: an axis of its own equations, not the plant's.
#include "host/diagnose/remainder.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

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
