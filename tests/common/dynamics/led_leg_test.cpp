// A leg that is led in flight: where its toe meets the ground, what its folding does to the body, and where a
// clutch's cable is caught meanwhile.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "furcula/dynamics/hopper.hpp"
#include "furcula/dynamics/nonlinear_hopper.hpp"

using namespace furcula::dynamics;

namespace {

/// Those of table 3.1 of document 002.
HopperNonlinearParameters<double> robot() {
  HopperNonlinearParameters<double> p;
  p.mass_kg = 1.6;
  p.stiffness_npm = 600.0;
  p.rest_height_m = 0.289;
  p.damping_stance_nspm = 5.0;
  p.damping_flight_nspm = 1.0;
  p.restitution_touchdown = p.restitution_liftoff = 1.0;
  p.link_length_m = 0.15;
  p.touchdown_angle_rad = 20.0 * std::numbers::pi / 180.0;
  p.gravity_mps2 = 9.81;
  p.inertia_a_kgm2 = 42e-4;
  p.inertia_b_kgm = 75e-4;
  p.inertia_e_kgm = 38e-3;
  return p;
}

struct Landing {
  double time_s = 0.0, height_m = 0.0, before_mps = 0.0, after_mps = 0.0;
};

/// Lets a body fall whose leg is `length_m` long and changes by `rate_mps`.
template <class Plant>
Landing fall(Plant plant, double from_m, double length_m, double rate_mps) {
  plant.reset(from_m, 0.0);
  plant.start_led(length_m, rate_mps);
  for (int row = 0; row < 1000; ++row) {
    const double t = 1e-3 * row;
    plant.lead_leg(length_m + rate_mps * t, rate_mps);
    plant.advance(0.0, 1e-3);
    if (plant.events().empty()) continue;
    const auto& e = plant.events().front();
    return {t + e.offset_s, length_m + rate_mps * (t + e.offset_s), e.velocity_before_mps,
            e.velocity_after_mps};
  }
  return {};
}

}  // namespace

TEST_CASE("A folded leg touches down at 2 L cos of its angle, not at the straight leg's height") {
  HopperLinearParameters<double> p = robot();
  p.damping_flight_nspm = 0.0;
  for (const double angle : {0.36, 0.6, 0.9}) {
    const double length_m = 0.3 * std::cos(angle);
    const Landing on = fall(Hopper<double>(p), 0.35, length_m, 0.0);
    const double fall_m = 0.35 - length_m;
    CHECK(on.time_s == Approx(std::sqrt(2.0 * fall_m / 9.81)).epsilon(1e-9));
    CHECK(on.before_mps == Approx(-std::sqrt(2.0 * 9.81 * fall_m)).epsilon(1e-9));
  }
  // Of a leg that stretches on the way: l + r t = h - g t^2 / 2.
  const double l = 0.25, r = 0.15;
  const double t = (-r + std::sqrt(r * r + 2.0 * 9.81 * (0.35 - l))) / 9.81;
  CHECK(fall(Hopper<double>(p), 0.35, l, r).time_s == Approx(t).epsilon(1e-9));
}

TEST_CASE("A stance that begins on a folded leg begins with the force of its compressed spring") {
  HopperLinearParameters<double> p = robot();
  p.damping_flight_nspm = p.damping_stance_nspm = 0.0;
  Hopper<double> hopper(p);
  const double length_m = 0.3 * std::cos(0.7);
  hopper.reset(length_m + 1e-6, -0.5);
  hopper.start_led(length_m, 0.0);
  hopper.advance(0.0, 1e-5);
  REQUIRE(hopper.in_stance());
  const double before_mps = hopper.velocity_mps();
  hopper.advance(0.0, 1e-4);
  CHECK((hopper.velocity_mps() - before_mps) / 1e-4 ==
        Approx(600.0 * (0.289 - length_m) / 1.6 - 9.81).epsilon(2e-3));
}

TEST_CASE(
    "The body moves with the folding leg as momentum has it, and lands with the links' plastic impact") {
  // The same flight by the equations of the free leg, whose motor folds it and stretches it again.
  for (const double torque : {1.5, 2.5}) {
    const auto p = robot();
    NonlinearHopper<double> free(p);
    Hopper<double> led(p);
    free.reset(0.40, 0.0);
    led.reset(0.40, 0.0);
    double length_m = free.touchdown_height_m(), folded_m = length_m, rate_mps = 0.0;
    led.start_led(length_m, 0.0);
    bool landed = false;
    for (int row = 0; row < 400 && !landed; ++row) {
      // Against gravity and spring; let go after a while, it comes back fast and is folded at touch-down or not.
      free.advance(row < 100 ? torque : 1.0, 1e-3);
      const double next_m = 0.3 * std::cos(free.leg_angle_rad());
      landed = !free.events().empty();
      // In the row in which it lands the leg goes on as it did.
      if (!landed) rate_mps = (next_m - length_m) / 1e-3;
      led.lead_leg(length_m, rate_mps);
      led.advance(0.0, 1e-3);
      length_m = next_m;
      folded_m = std::min(folded_m, length_m);
      if (landed) {
        REQUIRE(led.events().size() == 1);
        CHECK(led.events().front().offset_s == Approx(free.events().front().offset_s).margin(2e-4));
        CHECK(led.events().front().velocity_after_mps ==
              Approx(free.events().front().velocity_after_mps).epsilon(0.02));
      } else {
        CHECK(led.height_m() == Approx(free.height_m()).margin(1e-4));
      }
    }
    CHECK(landed);
    CHECK(folded_m < free.touchdown_height_m() - 0.005);
  }
}

TEST_CASE("A cable that is let go follows the folded leg, and is caught at home or at the next tooth") {
  const double pitch_m = 4e-3;
  const auto caught_at = [&](double catch_s) {
    HopperLinearParameters<double> p = robot();
    Hopper<double> hopper(p);
    hopper.fit_clutch({0.0, 0.0, 20.0, pitch_m});
    hopper.reset(0.60, 0.0);
    const double straight_m = hopper.touchdown_height_m();
    hopper.start_led(straight_m, 0.0);
    // Folded by 3 cm after 50 ms, straight again after 100 ms.
    const auto length = [&](double t) {
      return straight_m - (t < 0.1 ? 0.015 * (1.0 - std::cos(2.0 * std::numbers::pi * t / 0.1)) : 0.0);
    };
    for (int row = 0; row < 120; ++row) {
      const double t = 1e-3 * row;
      hopper.energise(t < catch_s);
      hopper.lead_leg(length(t), (length(t + 1e-3) - length(t)) / 1e-3);
      hopper.advance(0.0, 1e-3);
      if (std::abs(t + 1e-3 - 0.05) < 1e-6 && catch_s > 0.05) {
        // Both springs pull alike: k (z0 - x - l) = k (z0 - l0) + ka x.
        CHECK(hopper.cable_travel_m() == Approx(600.0 * 0.03 / (600.0 + 20.0)).epsilon(1e-6));
      }
    }
    REQUIRE(hopper.cable_held());
    return hopper.cable_travel_m();
  };
  CHECK(caught_at(0.110) == 0.0);
  // On the way back, at the next whole pitch below the travel at 70 ms.
  const double at_m = 0.015 * (1.0 - std::cos(1.4 * std::numbers::pi)) * 600.0 / 620.0;
  CHECK(caught_at(0.070) == Approx(pitch_m * std::floor(at_m / pitch_m)));
}
