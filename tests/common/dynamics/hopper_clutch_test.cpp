// A hopper whose spring's far end is on the cable of a clutch: rates and rest heights of the spring in closed
// form, by how the body swings on it.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "furcula/dynamics/hopper.hpp"
#include "tests/common/dynamics/jet.hpp"

using namespace furcula::dynamics;

namespace {

constexpr double kStop_rad = 20.0 * std::numbers::pi / 180.0;

/// Without friction: energy stays, and the swing is a sine.
HopperLinearParameters<double> robot() {
  return {1.5, 600.0, 0.289, 0.0, 0.0, 1.0, 1.0, 0.15, kStop_rad, 9.81};
}
const double kStraight_m = 0.3 * std::cos(kStop_rad);
constexpr HopperClutchParameters<double> kClutch{4e-3, 10e-3, 100.0, 4e-3};

Hopper<double> hopper(const Effects<double>& e = {}, const HopperClutchParameters<double>& c = kClutch) {
  Hopper<double> h(robot(), e);
  h.fit_clutch(c);
  return h;
}
void run(Hopper<double>& h, bool on, double for_s) {
  h.energise(on);
  for (int i = 0; i < static_cast<int>(std::lround(for_s * 1e3)); ++i) h.advance(0.0, 1e-3);
}
/// What accelerates the body, m/s^2, by a short step from rest at a height.
double acceleration(Hopper<double>& h) {
  const double before = h.velocity_mps();
  h.advance(0.0, 1e-5);
  return (h.velocity_mps() - before) / 1e-5;
}
double in_series(double a, double b) { return a * b / (a + b); }

}  // namespace

TEST_CASE("A hopper whose coil is never on hops as one without a clutch") {
  Hopper<double> plain(robot()), clutched = hopper();
  plain.reset(0.33, 0.0);
  clutched.reset(0.33, 0.0);
  for (int i = 0; i < 1500; ++i) {
    plain.advance(0.3, 1e-3);
    clutched.advance(0.3, 1e-3);
  }
  CHECK(clutched.height_m() == Approx(plain.height_m()).epsilon(1e-9));
  CHECK(clutched.cable_travel_m() == 0.0);
}

TEST_CASE("Released, the leg pushes with the pretension and the two springs in series") {
  const double pretension_n = 600.0 * (0.289 - kStraight_m);
  for (double auxiliary : {0.0, 100.0, 400.0})
    for (double ratio : {0.0, 0.3}) {
      Effects<double> e;
      if (ratio > 0.0) e.set(Effect::incomplete_release, 0, ratio);
      e.set(Effect::auxiliary_spring, 0, auxiliary);
      Hopper<double> h = hopper(e);
      h.reset(0.22, 0.0);
      h.energise(true);
      h.advance(0.0, kClutch.release_delay_s + 1e-9);
      const double soft = in_series(600.0, auxiliary), rate = soft + ratio * (600.0 - soft);
      const double push_n = pretension_n + rate * (kStraight_m - h.height_m());
      CAPTURE(auxiliary, ratio);
      CHECK_FALSE(h.cable_held());
      CHECK(acceleration(h) == Approx(push_n / 1.5 - 9.81).margin(0.01));
      // The cable has given what the spring has not stretched: k (z0 - x - z) is the push.
      CHECK(600.0 * (0.289 - h.cable_travel_m() - h.height_m()) == Approx(push_n).epsilon(1e-3));
    }
}

TEST_CASE("The release comes its delay after the coil, within a step") {
  Hopper<double> h = hopper();
  h.reset(0.22, 0.0);
  h.energise(true);
  h.advance(0.0, 3.999e-3);
  CHECK(h.cable_held());
  h.advance(0.0, 2e-6);
  CHECK_FALSE(h.cable_held());
}

TEST_CASE("A cable caught while the leg is short keeps its travel, to the next tooth") {
  Hopper<double> h = hopper();
  h.reset(0.25, -0.6);
  run(h, true, 0.02);
  const double before_m = h.cable_travel_m();
  CHECK(before_m > 0.0);
  run(h, false, 0.03);
  REQUIRE(h.cable_held());
  const double travel_m = h.cable_travel_m();
  CHECK(travel_m > before_m);
  CHECK(travel_m / 4e-3 == Approx(std::round(travel_m / 4e-3)).margin(1e-12));
  // From there on the stiff spring, whose rest height has moved by the travel.
  const double at_m = h.height_m();
  CHECK(acceleration(h) == Approx(600.0 * (0.289 - travel_m - at_m) / 1.5 - 9.81).margin(0.02));
  const double natural = std::sqrt(600.0 / 1.5), rest_m = 0.289 - travel_m - 1.5 * 9.81 / 600.0;
  const double from_m = h.height_m() - rest_m, speed = h.velocity_mps();
  run(h, false, 0.05);
  CHECK(h.height_m() ==
        Approx(rest_m + from_m * std::cos(natural * 0.05) + speed / natural * std::sin(natural * 0.05))
            .epsilon(1e-6));
}

TEST_CASE("A leg that straightens takes the cable home: released and caught in flight, nothing has changed") {
  Hopper<double> h = hopper(), plain(robot());
  h.reset(0.33, 0.0);
  plain.reset(0.33, 0.0);
  run(h, true, 0.05);
  run(h, false, 0.6);
  for (int i = 0; i < 650; ++i) plain.advance(0.0, 1e-3);
  CHECK(h.cable_travel_m() == 0.0);
  CHECK(h.height_m() == Approx(plain.height_m()).epsilon(1e-9));
}

TEST_CASE("No energy comes from nowhere: what the release takes is the spring's, and swings keep the rest") {
  Hopper<double> h = hopper();
  h.reset(0.22, 0.0);
  run(h, true, 0.004);
  // The released leg is a linear spring: kinetic and potential energy of it are kept.
  const double rate = in_series(600.0, 100.0), pretension_n = 600.0 * (0.289 - kStraight_m);
  const auto energy = [&] {
    const double short_by = kStraight_m - h.height_m();
    return 0.5 * 1.5 * h.velocity_mps() * h.velocity_mps() + 1.5 * 9.81 * h.height_m() +
           0.5 * rate * short_by * short_by + pretension_n * short_by;
  };
  const double before_j = energy();
  run(h, true, 0.02);
  REQUIRE(h.in_stance());
  CHECK(energy() == Approx(before_j).epsilon(1e-9));
}

TEST_CASE("Where the body is depends on delays, springs and pitch as differences say") {
  using Jet = ceres::Jet<double, 4>;
  const auto height = [](auto clutch, double released_s) {
    using T = decltype(clutch.tooth_pitch_m);
    HopperLinearParameters<T> p;
    const auto numbers = robot();
    for (std::size_t k = 0; k < 10; ++k)
      p.*HopperLinearParameters<T>::kMembers[k] = T(numbers.*HopperLinearParameters<double>::kMembers[k]);
    Hopper<T> h(p);
    h.fit_clutch(clutch);
    h.reset(T(0.29), T(-0.8));
    for (int i = 0; i < 150; ++i) {
      h.energise(i * 1e-3 >= 0.03 && i * 1e-3 < 0.03 + released_s);
      h.advance(T(0.0), 1e-3);
    }
    return h.height_m();
  };
  for (double released_s : {0.02, 0.035, 0.2}) {
    HopperClutchParameters<Jet> jets{Jet(4.1e-3, 0), Jet(10.3e-3, 1), Jet(100.0, 2), Jet(4e-3, 3)};
    const Jet at = height(jets, released_s);
    const double values[4] = {4.1e-3, 10.3e-3, 100.0, 4e-3};
    for (int k = 0; k < 4; ++k) {
      const double step = 1e-5 * values[k];
      const auto shifted = [&](double by) {
        double v[4] = {values[0], values[1], values[2], values[3]};
        v[k] += by;
        return height(HopperClutchParameters<double>{v[0], v[1], v[2], v[3]}, released_s);
      };
      CAPTURE(released_s, k);
      CHECK(at.v[k] == Approx((shifted(step) - shifted(-step)) / (2.0 * step)).epsilon(2e-3).margin(1e-7));
    }
  }
}
