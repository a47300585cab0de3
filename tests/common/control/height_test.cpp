// Height and velocity from counts.
#include "furcula/control/height.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace furcula::control;

namespace {
constexpr float kDt = 0.001f;
}

TEST_CASE("a count is 0.09 mm of height from the homing place") {
  HeightState state;
  const auto estimate = estimate_height({}, state, 1000, 0.25f, kDt);
  CHECK(estimate.height_m == Approx(0.34f).epsilon(1e-6));
  CHECK(estimate.velocity_mps == 0.0f);
}

TEST_CASE("a constant velocity is found exactly from the second tick on") {
  HeightState state;
  for (int i = 0; i < 40; ++i) {
    const auto estimate = estimate_height({}, state, -10 * i, 0.25f, kDt);  // 0.9 mm a tick
    if (i > 0) REQUIRE(estimate.velocity_mps == Approx(-0.9f).epsilon(1e-6));
  }
}

TEST_CASE("the velocity of a falling body is that of 2.5 ms ago") {
  HeightState state;
  float velocity_mps = 0.0f;
  // Fine counts of 1 um: 9.81 m/s^2 for 100 ms.
  const HeightConfig config{1e-6f};
  for (int i = 0; i <= 100; ++i) {
    const double t = 1e-3 * i;
    velocity_mps =
        estimate_height(config, state, static_cast<int>(std::lround(-0.5e6 * 9.81 * t * t)), 1.0f, kDt)
            .velocity_mps;
  }
  CHECK(velocity_mps == Approx(-9.81 * (0.100 - 0.0025)).margin(5e-4));
}

TEST_CASE("one count of noise is 18 mm/s of velocity: a count over five ticks") {
  HeightState state;
  for (int i = 0; i < 10; ++i) estimate_height({}, state, 0, 0.25f, kDt);
  CHECK(estimate_height({}, state, 1, 0.25f, kDt).velocity_mps == Approx(0.018f));
}

TEST_CASE("a height that is not homed is not a number") {
  HeightState state;
  CHECK(std::isnan(estimate_height({}, state, 5, std::nanf(""), kDt).height_m));
}
