// The simulated sensors: each error is as large as it is said to be, and seeded.
#include "boards/sim_host/sensors.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "host/core/random.hpp"
#include "host/sim/simulate.hpp"
#include "tests/sil/machines.hpp"

using namespace furcula;
using namespace furcula::test;

namespace {

struct Edge {
  double time_s;
  bool closes;
};

std::vector<Edge> edges(const std::vector<double>& time_s, const std::vector<bool>& contact) {
  std::vector<Edge> found;
  for (std::size_t i = 1; i < contact.size(); ++i)
    if (contact[i] != contact[i - 1]) found.push_back({time_s[i], contact[i]});
  return found;
}

struct Contacts {
  std::vector<Edge> reported, actual;
};

Contacts hop_with(const sim_host::SensorErrors& errors, std::uint64_t seed, double duration_s) {
  auto scenario = example_scenario(duration_s);
  scenario.sensors = errors;
  sim_host::SimBoard board(sim::rig_config(example_hopper(), scenario, seed));
  firmware::App app(board, sim::controller_config(example_hopper(), scenario));
  std::vector<double> time_s;
  std::vector<bool> reported, actual;
  while (board.wait_for_tick()) {
    app.tick();
    time_s.push_back(board.time_s());
    reported.push_back(board.sample().contact != 0);
    actual.push_back(board.plant().in_stance());
  }
  return {edges(time_s, reported), edges(time_s, actual)};
}

}  // namespace

TEST_CASE("an ideal switch reports each change on the tick after it") {
  const auto c = hop_with({}, 1, 10.0);
  REQUIRE(c.actual.size() > 40);
  REQUIRE(c.reported.size() == c.actual.size());
  for (std::size_t i = 0; i < c.actual.size(); ++i) CHECK(c.reported[i].time_s == c.actual[i].time_s);
}

TEST_CASE("a jittering switch reports each touch-down and lift-off once, up to 10 ms early or late") {
  const auto c = hop_with({false, false, false, true}, 5, 60.0);
  REQUIRE(c.actual.size() > 200);
  REQUIRE(std::abs(static_cast<long>(c.reported.size()) - static_cast<long>(c.actual.size())) <= 1);
  double earliest[2] = {0.0, 0.0}, latest[2] = {0.0, 0.0}, sum = 0.0;
  const std::size_t n = std::min(c.reported.size(), c.actual.size());
  for (std::size_t i = 0; i < n; ++i) {
    REQUIRE(c.reported[i].closes == c.actual[i].closes);
    const double offset_s = c.reported[i].time_s - c.actual[i].time_s;
    const int which = c.actual[i].closes ? 1 : 0;
    earliest[which] = std::min(earliest[which], offset_s);
    latest[which] = std::max(latest[which], offset_s);
    sum += offset_s;
  }
  for (const int which : {0, 1}) {
    CHECK(earliest[which] >= -0.0115);  // and the tick's grain
    CHECK(latest[which] <= 0.0115);
    CHECK(latest[which] > 0.008);
  }
  CHECK(earliest[1] < -0.008);
  // An early lift-off report ends the torque that holds the toe down: lift-off itself follows soon.
  CHECK(earliest[0] < -0.002);
  CHECK(std::abs(sum / static_cast<double>(n)) < 0.002);
}

TEST_CASE("a bouncing switch chatters for a few milliseconds after touch-downs, and at no other time") {
  const auto c = hop_with({false, false, true, false}, 5, 30.0);
  CHECK(c.reported.size() > c.actual.size() + 40);
  for (const Edge& edge : c.reported) {
    double since_s = 1.0;
    for (const Edge& actual : c.actual)
      if (edge.time_s >= actual.time_s) since_s = edge.time_s - actual.time_s;
    REQUIRE(since_s < 0.0055);
  }
}

TEST_CASE("a quantised encoder gives whole counts of 0.09 mm and never errs by more than half of one") {
  auto scenario = example_scenario(5.0);
  const log::Log log = [&] {
    scenario.sensors.quantisation = true;
    return sim::simulate(example_hopper(), scenario, 1);
  }();
  sim_host::SimBoard board(sim::rig_config(example_hopper(), scenario, 1));
  for (const double z : log.at("height_m"))
    REQUIRE(std::abs(z / 0.00009 - std::nearbyint(z / 0.00009)) < 1e-6);
  firmware::App app(board, sim::controller_config(example_hopper(), scenario));
  while (board.wait_for_tick()) {
    app.tick();
    REQUIRE(std::abs(board.measured_height_m() - board.plant().height_m()) <= 0.000045 + 1e-9);
  }
}

TEST_CASE("the log's velocity is, with quantised counts, the difference of counts over 5 ms") {
  auto scenario = example_scenario(2.0);
  scenario.sensors.quantisation = true;
  const log::Log log = sim::simulate(example_hopper(), scenario, 1);
  const auto& z = log.at("height_m");
  const auto& v = log.at("velocity_mps");
  for (std::size_t i = 5; i < z.size(); ++i) REQUIRE(v[i] == Approx((z[i] - z[i - 5]) / 0.005).margin(1e-5));
}

TEST_CASE("an encoder's noise has no mean and the standard deviation of a count") {
  sim_host::Encoder encoder({false, true, false, false}, 0.00009, 3);
  double sum = 0.0, squares = 0.0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    const double error = (encoder.measure(0.3) - 0.3) / 0.00009;
    sum += error;
    squares += error * error;
  }
  CHECK(sum / kCount == Approx(0.0).margin(0.03));  // four standard errors
  CHECK(squares / kCount == Approx(1.0).margin(0.04));
}

TEST_CASE("the same seed gives the same log, another seed another") {
  auto scenario = example_scenario(3.0);
  scenario.sensors = {true, true, true, true};
  const auto a = sim::simulate(example_hopper(), scenario, 1);
  const auto b = sim::simulate(example_hopper(), scenario, 1);
  const auto c = sim::simulate(example_hopper(), scenario, 2);
  CHECK(a.columns == b.columns);
  CHECK(a.at("height_m") != c.at("height_m"));
  CHECK(a.at("contact") != c.at("contact"));
}

TEST_CASE("random numbers are those of SplitMix64, whatever the compiler") {
  // Uniform in the range, streams apart.
  core::Random a(1, 1), b(1, 2);
  int low = 0;
  for (int i = 0; i < 1000; ++i) {
    const double x = a.uniform(-2.0, 3.0);
    REQUIRE(x >= -2.0);
    REQUIRE(x < 3.0);
    low += x < 0.5 ? 1 : 0;
    REQUIRE(x != b.uniform(-2.0, 3.0));
  }
  CHECK(low == Approx(500).margin(64));  // four standard deviations
}
