// Limits of the torque.
#include "furcula/control/limits.hpp"

#include <catch2/catch.hpp>

using namespace furcula::control;

TEST_CASE("a torque within magnitude and rate passes unchanged") {
  LimitsState state;
  CHECK(limit_torque({5.0f, 1000.0f}, state, 0.9f, 0.001f) == 0.9f);
  CHECK(limit_torque({5.0f, 1000.0f}, state, -0.05f, 0.001f) == -0.05f);
}

TEST_CASE("the torque changes by no more than the rate allows, up to the magnitude") {
  LimitsState state;
  const LimitsConfig config{5.0f, 2000.0f};
  const float expected[] = {2.0f, 4.0f, 5.0f, 5.0f};
  for (const float e : expected) CHECK(limit_torque(config, state, 100.0f, 0.001f) == Approx(e));
  const float back[] = {3.0f, 1.0f, -1.0f, -3.0f, -5.0f, -5.0f};
  for (const float e : back) CHECK(limit_torque(config, state, -100.0f, 0.001f) == Approx(e));
}
