// The exact flow of y'' + delta y' + kappa y = a against its closed forms.
#include <catch2/catch.hpp>
#include <cmath>

#include "furcula/dynamics/event_time.hpp"
#include "furcula/dynamics/second_order_flow.hpp"

using furcula::dynamics::event_time;
using furcula::dynamics::Flow;
using furcula::dynamics::flow;

TEST_CASE("Without stiffness and damping the flow is uniform acceleration") {
  for (const double t : {1e-6, 1e-3, 0.7, 20.0}) {
    const Flow<double> f = flow(0.0, 0.0, t);
    CHECK(f.impulse == Approx(t).epsilon(1e-15));
    CHECK(f.impulse_integral == Approx(t * t / 2).epsilon(1e-15));
    CHECK(f.impulse_rate == 1.0);
  }
}

TEST_CASE("With damping alone the flow is an exponential approach") {
  const double delta = 2.0;
  for (const double t : {1e-4, 1e-2, 0.5, 5.0}) {
    const Flow<double> f = flow(0.0, delta, t);
    CHECK(f.impulse == Approx(-std::expm1(-delta * t) / delta).epsilon(1e-13));
    CHECK(f.impulse_rate == Approx(std::exp(-delta * t)).epsilon(1e-12).margin(1e-14));
    CHECK(f.impulse_integral == Approx((t - f.impulse) / delta).epsilon(1e-9));
  }
}

TEST_CASE("Underdamped, critical and overdamped motion follow their closed forms") {
  const double kappa = 400.0;
  for (const double delta : {4.0, 40.0, 90.0})
    for (const double t : {1e-3, 2e-2, 0.3}) {
      const double sigma = delta / 2.0, squared = kappa - sigma * sigma;
      const double omega = std::sqrt(std::abs(squared));
      const double g = squared > 0.0   ? std::exp(-sigma * t) * std::sin(omega * t) / omega
                       : squared < 0.0 ? std::exp(-sigma * t) * std::sinh(omega * t) / omega
                                       : std::exp(-sigma * t) * t;
      CAPTURE(delta, t);
      CHECK(flow(kappa, delta, t).impulse == Approx(g).epsilon(1e-11).margin(1e-16));
    }
}

TEST_CASE("Two steps in a row are one step of their sum, however stiff the spring") {
  for (const double kappa : {0.0, 400.0, 1e7}) {
    const double delta = 3.0, v = -1.2, a = 7.0, s = 0.004, t = 0.007;
    const Flow<double> one = flow(kappa, delta, s), two = flow(kappa, delta, t),
                       both = flow(kappa, delta, s + t);
    const double y1 = v * one.impulse + a * one.impulse_integral;
    const double v1 = v * one.impulse_rate + a * one.impulse;
    const double y2 = y1 + v1 * two.impulse + (a - kappa * y1) * two.impulse_integral;
    CHECK(y2 == Approx(v * both.impulse + a * both.impulse_integral).epsilon(1e-10));
  }
}

TEST_CASE("In single precision the flow agrees with double precision to its rounding") {
  const Flow<float> f = flow(387.0f, 3.3f, 1e-3f);
  const Flow<double> d = flow(double(387.0f), double(3.3f), double(1e-3f));
  CHECK(double(f.impulse) == Approx(d.impulse).epsilon(3e-7));
  CHECK(double(f.impulse_integral) == Approx(d.impulse_integral).epsilon(3e-7));
}

TEST_CASE("An event is located to rounding, by its sign change alone") {
  const auto f = [](double t) { return std::cos(t) - t; };
  const auto rate = [](double t) { return -std::sin(t) - 1.0; };
  CHECK(event_time<double>(0.0, 1.0, f, rate) == Approx(0.7390851332151607).epsilon(1e-14));
  // A derivative that misleads must not lead out of the bracket.
  const auto wrong = [](double) { return 1e-9; };
  CHECK(event_time<double>(0.0, 1.0, f, wrong) == Approx(0.7390851332151607).epsilon(1e-9));
  int calls = 0;
  const auto counted = [&](double t) {
    ++calls;
    return f(t);
  };
  CHECK(event_time<double>(0.0, 1.0, counted) == Approx(0.7390851332151607).epsilon(1e-14));
  CHECK(calls < 12);
}
