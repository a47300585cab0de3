// What is read out of a log before any fit: noise, slopes, local polynomials.
#include "host/identify/recording.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "host/core/error.hpp"
#include "host/identify/split.hpp"
#include "tests/host/identify/synthetic.hpp"

using namespace furcula;
using identify::local_polynomial;
using identify::make_recording;

TEST_CASE("A local polynomial gives value, slope and curvature of a cubic, at irregular times") {
  std::vector<double> t, x;
  for (int i = 0; i < 12; ++i) {
    t.push_back(3.0 + 0.01 * i + 0.003 * std::sin(7.0 * i));
    const double s = t.back() - 3.05;
    x.push_back(0.28 + 1.2 * s - 4.9 * s * s + 20.0 * s * s * s);
  }
  const auto p = local_polynomial(t, x, 0, 11, 3.05, 3);
  CHECK(p.value == Approx(0.28));
  CHECK(p.slope == Approx(1.2).epsilon(1e-9));
  CHECK(p.curvature == Approx(-9.8).epsilon(1e-8));
  CHECK(p.residual_variance < 1e-20);
}

TEST_CASE("The noise of a channel is found under motion, to a tenth") {
  for (const double noise : {2e-5, 3e-4}) {
    const auto r = make_recording(test::axis_log(95.0, 200.0, noise, 7), dynamics::Kind::motor_axis);
    CHECK(r.position_noise == Approx(noise).epsilon(0.1));
  }
}

TEST_CASE("The smoothed slope of the position has no delay") {
  const auto r = make_recording(test::axis_log(95.0, 200.0, 0.0, 3), dynamics::Kind::motor_axis);
  // In the middle of a stretch of constant force the closed form's speed is the central difference's.
  for (std::size_t i = 60; i < 100; ++i)
    CHECK(r.velocity_smoothed[i] == Approx((r.position[i + 1] - r.position[i - 1]) / 0.004).epsilon(1e-3));
}

TEST_CASE("A log of a few rows is refused with its name and the number expected") {
  log::Log log = test::axis_log(95.0, 200.0, 0.0, 1, 0.02);
  CHECK_THROWS_WITH(make_recording(log, dynamics::Kind::motor_axis), Catch::Contains("axis-1.csv") &&
                                                                         Catch::Contains("11 rows") &&
                                                                         Catch::Contains("at least 20"));
}

TEST_CASE("The end of a log that is held out goes on: its motor has worked as long as the first part's") {
  log::Log whole;
  whole.path = "one.csv";
  for (int i = 0; i < 400; ++i) {
    whole.columns["time_s"].push_back(0.01 * i);
    whole.columns["position_m"].push_back(0.05 * std::sin(0.1 * i));
    whole.columns["force_n"].push_back(i < 200 ? 10.0 : 0.0);
  }
  auto [first, end] = identify::split({whole}, 1);
  const auto training = identify::make_recordings(first, dynamics::Kind::motor_axis);
  auto held_out = identify::make_recordings(end, dynamics::Kind::motor_axis);
  identify::keep_warm(held_out, training);
  CHECK(identify::goes_on_from(held_out[0], training) == &training[0]);
  CHECK(held_out[0].driven_s.front() == Approx(2.0));
  CHECK(held_out[0].driven_s.back() == Approx(2.0));
  // Another log is another day.
  held_out[0].name = "two.csv";
  CHECK(identify::goes_on_from(held_out[0], training) == nullptr);
}
