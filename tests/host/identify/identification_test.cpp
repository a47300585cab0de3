// Identification as a whole: folds, both methods, threads, refusals.
#include "host/identify/identification.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "host/core/error.hpp"
#include "host/identify/split.hpp"
#include "host/sim/simulate.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;

namespace {

std::vector<log::Log> axis_logs(unsigned count, double noise = 1e-4) {
  std::vector<log::Log> logs;
  for (unsigned i = 0; i < count; ++i) logs.push_back(test::axis_log(95.0, 203.5, noise, i, 2.0));
  return logs;
}

}  // namespace

TEST_CASE("Each fold's estimate is near the whole one and its errors are the noise's") {
  identify::IdentifyOptions options;
  options.by_equation = true;
  const auto id = identify::identify(test::axis_model(60.0, 90.0), axis_logs(12), axis_logs(1), options);
  REQUIRE(id.estimations.size() == 2);
  CHECK(id.folds == 10);
  const auto& e = id.estimations.front();
  REQUIRE(e.parameters.size() == 2);
  REQUIRE(e.folds.size() == 10);
  CHECK(e.parameters[0].folds.size() == 10);
  for (double mass : e.parameters[0].folds) CHECK(mass == Approx(95.0).epsilon(0.02));
  REQUIRE(e.held_out);
  // A start velocity from 25 rows of 0.1 mm noise is good to 6 mm/s (its closed form): 3 mm after half a
  // second.
  CHECK(e.held_out->at("position").rmse < 2e-3);
  CHECK(e.held_out->at("position").rmse > 0.9e-4);  // the noise itself
}

TEST_CASE("One thread and two give the same numbers") {
  identify::IdentifyOptions one, two;
  one.threads = 1;
  two.threads = 2;
  const auto a = identify::identify(test::axis_model(60.0, 90.0), axis_logs(5), {}, one);
  const auto b = identify::identify(test::axis_model(60.0, 90.0), axis_logs(5), {}, two);
  CHECK(a.estimations[0].parameters[0].value == b.estimations[0].parameters[0].value);
  CHECK(a.estimations[0].parameters[1].folds == b.estimations[0].parameters[1].folds);
}

TEST_CASE("Too few recordings or windows for the folds are refused with both numbers") {
  identify::IdentifyOptions options;
  options.folds = 10;
  CHECK_THROWS_WITH(identify::identify(test::axis_model(60.0, 90.0), axis_logs(4), {}, options),
                    Catch::Contains("4 recordings") && Catch::Contains("10 folds"));
  options.folds = 0;
  const std::vector<log::Log> shortest{test::axis_log(95.0, 203.5, 1e-4, 1, 0.3)};
  CHECK_THROWS_AS(identify::identify(test::axis_model(60.0, 90.0), shortest, {}, options), core::DataError);
}

TEST_CASE("A recording too short for a window is no fold, and a pause ends a window, not the recording") {
  auto logs = axis_logs(3);
  logs.push_back(test::axis_log(95.0, 203.5, 1e-4, 9, 0.1));
  identify::IdentifyOptions options;
  options.by_equation = true;
  CHECK(identify::identify(test::axis_model(60.0, 90.0), logs, {}, options).folds == 3);
  auto paused = test::axis_log(95.0, 203.5, 1e-4, 4, 4.0);
  for (std::size_t i = 800; i < paused.rows(); ++i) paused.columns["time_s"][i] += 0.6;
  const auto r = identify::make_recording(paused, dynamics::Kind::motor_axis);
  CHECK(identify::intervals(r, 0, 0.5).size() >= 6);
}

TEST_CASE("A model without free parameters is refused") {
  auto model = test::axis_model(60.0, 90.0);
  model.free.clear();
  CHECK_THROWS_WITH(identify::identify(model, axis_logs(4), {}), Catch::Contains("[free]"));
}

TEST_CASE("The damped frequency of the stance is that of the closed form") {
  // sqrt(k/m - (d/2m)^2) with document 002's figures
  auto model = test::hopper_model();
  std::vector<log::Log> logs;
  auto truth = model;
  truth.parameters[*dynamics::parameter_index(model.kind, "mass_kg")] = 1.554;
  truth.parameters[*dynamics::parameter_index(model.kind, "damping_stance_nspm")] = 6.42;
  auto scenario = sim::default_scenario(truth);
  for (std::uint64_t seed = 0; seed < 3; ++seed) logs.push_back(sim::simulate(truth, scenario, seed));
  const auto id = identify::identify(model, logs, {});
  const double expected = std::sqrt(605.0 / 1.554 - std::pow(6.42 / (2 * 1.554), 2));
  CHECK(id.estimations[0].derived.at(0).value == Approx(expected).epsilon(0.01));
  CHECK(id.estimations[0].parameters[0].value == Approx(1.554).epsilon(0.02));
}

TEST_CASE(
    "A fifth of the logs is held out, of one log its last quarter, and the choice depends on the seed alone") {
  const auto [training, held_out] = identify::split(axis_logs(10), 3);
  CHECK(training.size() == 8);
  CHECK(held_out.size() == 2);
  const auto again = identify::split(axis_logs(10), 3);
  CHECK(again.second[0].path == held_out[0].path);
  const auto [first, last] = identify::split({test::axis_log(95.0, 203.5, 0.0, 1, 4.0)}, 3);
  CHECK(first[0].rows() == 3 * last[0].rows() + 1);
  CHECK(last[0].time_s().front() > first[0].time_s().back());
  // Where each log is of another kind all are to be seen.
  const auto [four, quarters] = identify::split(axis_logs(4), 3, 5);
  REQUIRE(four.size() == 4);
  REQUIRE(quarters.size() == 4);
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(four[i].path == quarters[i].path);
    CHECK(four[i].rows() >= 3 * quarters[i].rows());
  }
  CHECK(identify::split(axis_logs(5), 3, 5).second.size() == 1);
  // A log that is too short for it is not lost.
  std::vector<log::Log> one_short = axis_logs(3);
  for (auto& [name, values] : one_short[1].columns) values.resize(60);
  one_short[1].lines.clear();
  const auto [kept, of_long] = identify::split(one_short, 3, 5);
  REQUIRE(kept.size() == 3);
  CHECK(kept[1].rows() == 60);
  CHECK(of_long.size() == 2);
}
