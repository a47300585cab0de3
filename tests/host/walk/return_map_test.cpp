// The return map of a walk: against the filter's own equations, and against itself over two strides.
#include "host/walk/return_map.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

#include "host/walk/search.hpp"
#include "host/walk/walk_file.hpp"
#include "tests/host/walk/walks.hpp"
#include "tests/paths.hpp"

using namespace furcula;
using namespace furcula::walk;

namespace {

/// How many multipliers are within 0.001 of the attitude filter's slowest: roll and pitch with their biases,
/// s^2 + kP s + kI = 0, kP 0.5 1/s, kI 0.02 1/s^2.
std::size_t of_the_filter(const ReturnMap& map) {
  const double slow = std::exp(map.stride_s * (-0.5 + std::sqrt(0.25 - 0.08)) / 2.0);
  return static_cast<std::size_t>(std::count_if(map.multipliers.begin(), map.multipliers.end(),
                                                [&](double m) { return std::abs(m - slow) < 1e-3; }));
}

}  // namespace

TEST_CASE("a walk comes to a periodic stride, and two of its deviations die away as the attitude filter's") {
  const auto robot = dynamics::biped::design();
  const Parameters walk = test::found_walk().parameters;
  const ReturnMap map = return_map_of(robot, {}, walk);
  INFO(map.none);
  REQUIRE(map.found);
  CHECK(map.closure < 1e-7);
  CHECK(map.stride_m > 0.0);
  CHECK(std::is_sorted(map.multipliers.rbegin(), map.multipliers.rend()));
  CHECK(of_the_filter(map) == 2);

  SECTION("two strides are one after the other") {
    const ReturnMap two = return_map_of(robot, {}, walk, 2);
    INFO(two.none);
    REQUIRE(two.found);
    CHECK(two.stride_s == Approx(2.0 * map.stride_s).epsilon(1e-5));
    CHECK(two.stride_m == Approx(2.0 * map.stride_m).epsilon(1e-4));
    for (std::size_t i = 0; i < 8; ++i)
      CHECK(two.multipliers[i] == Approx(map.multipliers[i] * map.multipliers[i]).margin(2e-3));
  }
  SECTION("what a stride costs is what a long walk comes to") {
    RolloutOptions longer;
    longer.time_s = 100.0;
    longer.walk_until_s = 95.0;
    const Rollout r = run_walk(robot, longer, walk);
    CHECK(map.cot == Approx(r.cot).epsilon(0.1));
  }
}

TEST_CASE("a landing is where the foot meets the ground, between two ticks, whatever their length") {
  const auto robot = dynamics::biped::design();
  const Walk walk = read_walk(test::source("models/biped/semi_passive_walk.toml"));
  RolloutOptions options;
  options.mode = walk.mode;
  const ReturnMap map = return_map_of(robot, options, walk.parameters);
  INFO(map.none);
  REQUIRE(map.found);
  const double ticks = map.stride_s / options.step_s;
  CHECK(std::abs(ticks - std::round(ticks)) > 1e-3);
  options.step_s /= 2.0;
  const ReturnMap finer = return_map_of(robot, options, walk.parameters);
  INFO(finer.none);
  REQUIRE(finer.found);
  CHECK(finer.stride_s == Approx(map.stride_s).epsilon(2e-3));
  CHECK(finer.stride_m == Approx(map.stride_m).epsilon(1e-2));
  for (std::size_t i = 0; i < 2; ++i) CHECK(finer.multipliers[i] == Approx(map.multipliers[i]).margin(1e-3));
}

TEST_CASE("a walk that falls has no stride, and it is said when it falls") {
  const ReturnMap map = return_map_of(dynamics::biped::design(), {}, test::start_walk());
  CHECK_FALSE(map.found);
  CHECK_THAT(map.none, Catch::Contains("falls after"));
}
