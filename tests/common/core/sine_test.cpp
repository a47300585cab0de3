// The sine of the target and of the host.
#include "furcula/core/sine.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <numbers>

using furcula::is_finite;
using furcula::sine_of_turns;

TEST_CASE("the sine is within 2e-7 of the C library's in double over 64 turns") {
  double worst = 0.0;
  for (long i = -64'000'000; i <= 64'000'000; i += 61) {
    const float turns = static_cast<float>(i) * 1e-6f;
    const double truth = std::sin(2.0 * std::numbers::pi * static_cast<double>(turns));
    worst = std::max(worst, std::abs(static_cast<double>(sine_of_turns(turns)) - truth));
  }
  CHECK(worst < 2e-7);
  CHECK(worst > 1e-9);  // a float's: the comparison did happen
}

TEST_CASE("the sine is exact at its zeros and symmetric") {
  for (int i = -100; i <= 100; ++i) CHECK(sine_of_turns(0.5f * static_cast<float>(i)) == 0.0f);
  for (float x = 0.0f; x < 3.0f; x += 0.001f) REQUIRE(sine_of_turns(-x) == -sine_of_turns(x));
  CHECK(sine_of_turns(0.25f) == Approx(1.0f).margin(1e-7));
  CHECK(sine_of_turns(-0.25f) == Approx(-1.0f).margin(1e-7));
}

TEST_CASE("the sine of a huge number of turns is 0, and of no number none") {
  CHECK(sine_of_turns(8388608.0f) == 0.0f);
  CHECK(sine_of_turns(-3e38f) == 0.0f);
  CHECK(sine_of_turns(8388607.5f) == 0.0f);
  CHECK(std::isnan(sine_of_turns(std::numeric_limits<float>::infinity())));
  CHECK(std::isnan(sine_of_turns(std::numeric_limits<float>::quiet_NaN())));
}

TEST_CASE("infinities and NaN are not finite, the largest float is") {
  CHECK(is_finite(std::numeric_limits<float>::max()));
  CHECK(is_finite(0.0f));
  CHECK_FALSE(is_finite(std::numeric_limits<float>::infinity()));
  CHECK_FALSE(is_finite(-std::numeric_limits<float>::infinity()));
  CHECK_FALSE(is_finite(std::numeric_limits<float>::quiet_NaN()));
}
