// The linear hopper against closed forms, energy, document 002's example and an independent Runge-Kutta run.
#include "furcula/dynamics/hopper.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/common/dynamics/example.hpp"

using furcula::dynamics::ContactEvent;
using furcula::dynamics::Effect;
using furcula::dynamics::Effects;
using furcula::dynamics::Hopper;
using furcula::dynamics::HopperLinearParameters;
using furcula::test::example_hopper;
using Event = ContactEvent<double>;

namespace {

/// Hops under a harmonic torque restarted at each touch-down and sampled in the middle of each tick; the last
/// apex.
double steady_apex(double torque_nm) {
  Hopper<double> hopper(example_hopper());
  hopper.reset(0.35, 0.0);
  const double tick = 1e-3;
  double touchdown = 0.0, apex = 0.0, before = 0.0;
  for (int n = 0; n < 20000; ++n) {
    const double t = n * tick;
    const double torque =
        hopper.in_stance() ? torque_nm * std::sin(2.0 * std::numbers::pi * (t + tick / 2 - touchdown) / 0.3)
                           : 0.0;
    hopper.advance(torque, tick);
    for (const Event& e : hopper.events())
      if (e.kind == Event::Kind::touchdown) touchdown = t + e.offset_s;
    if (before > 0.0 && hopper.velocity_mps() <= 0.0 && !hopper.in_stance()) apex = hopper.height_m();
    before = hopper.velocity_mps();
  }
  return apex;
}

}  // namespace

TEST_CASE("Document 002's example grows to a steady apex of 0.361 m") {
  CHECK(steady_apex(2.0) == Approx(0.361).margin(1e-3));
}

TEST_CASE("With the torque's sign flipped the hops of document 002's example die") {
  CHECK(steady_apex(-2.0) < 0.33);
}

TEST_CASE("Without damping, torque and loss the energy of 1,000 hops drifts by less than 1e-9") {
  auto p = example_hopper();
  p.damping_stance_nspm = p.damping_flight_nspm = 0.0;
  Hopper<double> hopper(p);
  hopper.reset(0.35, 0.0);
  const double start = p.mass_kg * p.gravity_mps2 * 0.35;
  double drift = 0.0;
  for (int hops = 0; hops < 1000;) {
    hopper.advance(0.0, 1e-3);
    for (const Event& e : hopper.events()) hops += e.kind == Event::Kind::touchdown ? 1 : 0;
    const double z = hopper.height_m(), v = hopper.velocity_mps(), dz = z - p.rest_height_m;
    const double spring = hopper.in_stance() ? 0.5 * p.stiffness_npm * dz * dz : 0.0;
    drift = std::max(
        drift, std::abs((0.5 * p.mass_kg * v * v + p.mass_kg * p.gravity_mps2 * z + spring) / start - 1.0));
  }
  CHECK(drift < 1e-9);
}

TEST_CASE("Touch-down of a free fall is located to better than a microsecond, wherever it lies in the tick") {
  auto p = example_hopper();
  p.damping_flight_nspm = 0.0;
  const double touchdown = 2.0 * p.link_length_m * std::cos(p.touchdown_angle_rad);
  for (int k = 0; k < 50; ++k) {
    const double height = 0.30 + 0.00137 * k;
    const double expected = std::sqrt(2.0 * (height - touchdown) / p.gravity_mps2);
    Hopper<double> hopper(p);
    hopper.reset(height, 0.0);
    double found = -1.0;
    for (int n = 0; n < 400 && found < 0.0; ++n) {
      hopper.advance(0.0, 1e-3);
      if (!hopper.events().empty()) found = n * 1e-3 + hopper.events().front().offset_s;
    }
    CAPTURE(height);
    CHECK(found == Approx(expected).margin(1e-9));
  }
}

TEST_CASE("A contact shorter than a tick is not stepped over, and every event in a tick is told") {
  auto p = example_hopper();
  p.stiffness_npm = 1e6;  // half a period of 3.8 ms
  p.damping_stance_nspm = p.damping_flight_nspm = 0.0;
  Hopper<double> hopper(p);
  const double touchdown = hopper.touchdown_height_m();
  hopper.reset(touchdown + 1e-4, -1.0);
  hopper.advance(0.0, 0.010);
  REQUIRE(hopper.events().size() == 2);
  CHECK(hopper.events()[0].kind == Event::Kind::touchdown);
  CHECK(hopper.events()[1].kind == Event::Kind::liftoff);
  CHECK_FALSE(hopper.in_stance());
  const double v = std::sqrt(1.0 + 2.0 * p.gravity_mps2 * 1e-4);
  CHECK(hopper.events()[1].velocity_before_mps == Approx(v).epsilon(1e-9));
}

TEST_CASE("The speed changes by the restitution at touch-down and at lift-off") {
  auto p = example_hopper();
  p.restitution_touchdown = 0.8;
  p.restitution_liftoff = 0.9;
  Hopper<double> hopper(p);
  hopper.reset(0.35, 0.0);
  int seen = 0;
  for (int n = 0; n < 500; ++n) {
    hopper.advance(0.0, 1e-3);
    for (const Event& e : hopper.events()) {
      const double ratio = e.kind == Event::Kind::touchdown ? 0.8 : 0.9;
      CHECK(e.velocity_after_mps == Approx(ratio * e.velocity_before_mps));
      ++seen;
    }
  }
  CHECK(seen >= 2);
}

TEST_CASE("A hopper without torque comes to rest where spring and weight balance") {
  auto p = example_hopper();
  Hopper<double> hopper(p);
  hopper.reset(0.35, 0.0);
  for (int n = 0; n < 20000; ++n) hopper.advance(0.0, 1e-3);
  CHECK(hopper.in_stance());
  CHECK(hopper.height_m() ==
        Approx(p.rest_height_m - p.mass_kg * p.gravity_mps2 / p.stiffness_npm).margin(1e-6));
  CHECK(std::abs(hopper.velocity_mps()) < 1e-4);
}

namespace {

/// An independent integrator of the equations in docs/physics.md: classic Runge-Kutta at 1 microsecond, the
/// torque held over each millisecond, the lever arm that of the instant; events by the sign at a step's end.
class RungeKutta {
 public:
  explicit RungeKutta(const HopperLinearParameters<double>& p) : p_(p) {}
  double z = 0.0, v = 0.0;
  bool stance = false;

  void advance(double torque, double seconds) {
    const int steps = static_cast<int>(std::lround(seconds / kStep));
    for (int i = 0; i < steps; ++i) {
      const auto k1 = rate(z, v, torque);
      const auto k2 = rate(z + kStep / 2 * k1[0], v + kStep / 2 * k1[1], torque);
      const auto k3 = rate(z + kStep / 2 * k2[0], v + kStep / 2 * k2[1], torque);
      const auto k4 = rate(z + kStep * k3[0], v + kStep * k3[1], torque);
      z += kStep / 6 * (k1[0] + 2 * k2[0] + 2 * k3[0] + k4[0]);
      v += kStep / 6 * (k1[1] + 2 * k2[1] + 2 * k3[1] + k4[1]);
      const double touchdown = 2 * p_.link_length_m * std::cos(p_.touchdown_angle_rad);
      if (!stance && v < 0 && z <= touchdown) {
        stance = true;
        v *= p_.restitution_touchdown;
      } else if (stance && v > 0 && (z >= touchdown || leg(z, v, torque) <= 0)) {
        stance = false;
        v *= p_.restitution_liftoff;
      }
    }
  }

 private:
  static constexpr double kStep = 1e-6;
  double leg(double height, double velocity, double torque) const {
    const double reach = 2 * p_.link_length_m;
    return p_.stiffness_npm * (p_.rest_height_m - height) -
           (p_.damping_stance_nspm - p_.damping_flight_nspm) * velocity -
           torque / std::sqrt(reach * reach - height * height);
  }
  std::array<double, 2> rate(double height, double velocity, double torque) const {
    double force = -p_.damping_flight_nspm * velocity - p_.mass_kg * p_.gravity_mps2;
    if (stance) force += std::max(0.0, leg(height, velocity, torque));
    return {velocity, force / p_.mass_kg};
  }
  HopperLinearParameters<double> p_;
};

}  // namespace

TEST_CASE("The exact step at 1 ms follows a Runge-Kutta run at 1 microsecond through five driven hops") {
  auto p = example_hopper();
  p.rest_height_m = 0.289;
  p.restitution_touchdown = 0.9;
  p.restitution_liftoff = 0.95;
  Hopper<double> exact(p);
  RungeKutta fine(p);
  exact.reset(0.34, 0.0);
  fine.z = 0.34;
  double apart = 0.0;
  for (int n = 0; n < 2000; ++n) {
    const double torque = 1.5 * std::sin(2.0 * std::numbers::pi * n * 1e-3 / 0.3);
    exact.advance(torque, 1e-3);
    fine.advance(torque, 1e-3);
    apart = std::max(apart, std::abs(exact.height_m() - fine.z));
  }
  // The fine run takes its events up to 1 microsecond late, at about 1 m/s, a few tens of times.
  INFO("largest difference " << apart << " m");
  CHECK(apart < 2e-5);
}

TEST_CASE("Without torque the exact step follows the closed form of a damped oscillator to rounding") {
  auto p = example_hopper();
  Hopper<double> hopper(p);
  const double equilibrium = p.rest_height_m - p.mass_kg * p.gravity_mps2 / p.stiffness_npm;
  hopper.reset(0.25, 0.0);
  const double sigma = p.damping_stance_nspm / (2 * p.mass_kg);
  const double omega = std::sqrt(p.stiffness_npm / p.mass_kg - sigma * sigma);
  for (int n = 1; n <= 60; ++n) {
    hopper.advance(0.0, 1e-3);
    const double t = n * 1e-3, y = 0.25 - equilibrium;
    const double expected =
        equilibrium + std::exp(-sigma * t) * y * (std::cos(omega * t) + sigma / omega * std::sin(omega * t));
    CHECK(hopper.height_m() == Approx(expected).epsilon(1e-13));
  }
}

TEST_CASE("Each effect changes the hopper by its law") {
  auto p = example_hopper();
  p.damping_flight_nspm = 0.0;
  Effects<double> effects;
  const double t = 0.05, fall = 0.5 * p.gravity_mps2 * t * t;
  const auto dropped = [&] {
    Hopper<double> hopper(p, effects);
    hopper.reset(0.36, -0.5);
    for (int n = 0; n < 50; ++n) hopper.advance(0.0, 1e-3);
    return hopper;
  };
  SECTION("Coulomb friction brakes a fall by Fc/m") {
    effects.set(Effect::coulomb_friction, 0, 3.0);
    CHECK(dropped().velocity_mps() == Approx(-0.5 - (p.gravity_mps2 - 3.0 / p.mass_kg) * t).epsilon(1e-12));
  }
  SECTION("Asymmetric friction takes the downward size on the way down") {
    effects.set(Effect::asymmetric_friction, {5.0, 2.0, 0.0});
    CHECK(dropped().velocity_mps() == Approx(-0.5 - (p.gravity_mps2 - 2.0 / p.mass_kg) * t).epsilon(1e-12));
  }
  SECTION("A force offset shifts gravity") {
    effects.set(Effect::force_offset, 0, -1.5);
    CHECK(dropped().height_m() == Approx(0.36 - 0.5 * t - fall - 0.5 * 1.0 * t * t).epsilon(1e-12));
  }
  SECTION("Quadratic drag follows the closed form of a fall with drag") {
    const double c = 0.8, terminal = std::sqrt(p.mass_kg * p.gravity_mps2 / c);
    effects.set(Effect::quadratic_drag, 0, c);
    const double expected = -terminal * std::tanh(p.gravity_mps2 * t / terminal + std::atanh(0.5 / terminal));
    CHECK(dropped().velocity_mps() == Approx(expected).epsilon(1e-6));
  }
  SECTION("The Stribeck curve is its static force at rest and its sliding force at speed") {
    effects.set(Effect::stribeck_friction, {1.0, 4.0, 0.02});
    CHECK(dropped().velocity_mps() == Approx(-0.5 - (p.gravity_mps2 - 1.0 / p.mass_kg) * t).epsilon(1e-9));
    Hopper<double> held(p, effects);
    const double equilibrium = p.rest_height_m - p.mass_kg * p.gravity_mps2 / p.stiffness_npm;
    held.reset(equilibrium - 3.9 / p.stiffness_npm, 0.0);
    held.advance(0.0, 1e-3);
    CHECK(held.velocity_mps() == 0.0);
    held.reset(equilibrium - 4.1 / p.stiffness_npm, 0.0);
    held.advance(0.0, 1e-3);
    CHECK(held.velocity_mps() > 0.0);
  }
  const auto at_rest = [&](double torque) {  // where a still stance balances
    p.damping_stance_nspm = 60.0;
    Hopper<double> hopper(p, effects);
    hopper.reset(0.25, 0.0);
    for (int n = 0; n < 5000; ++n) hopper.advance(torque, 1e-3);
    return hopper.height_m();
  };
  const double weight = p.mass_kg * p.gravity_mps2;
  SECTION("A preload lifts the stance by its force over the spring's rate") {
    effects.set(Effect::spring_preload, 0, 3.0);
    CHECK(at_rest(0.0) == Approx(p.rest_height_m - (weight - 3.0) / p.stiffness_npm).epsilon(1e-9));
  }
  SECTION("A wrong rate sinks the stance in proportion") {
    effects.set(Effect::stiffness_error, 0, 500.0);
    CHECK(at_rest(0.0) == Approx(p.rest_height_m - weight / 500.0).epsilon(1e-9));
  }
  SECTION("A loss at touch-down takes the place of the model's restitution") {
    effects.set(Effect::touchdown_loss, 0, 0.7);
    Hopper<double> hopper(p, effects);
    hopper.reset(0.30, -0.5);
    while (hopper.events().empty()) hopper.advance(0.0, 1e-3);
    CHECK(hopper.events()[0].velocity_after_mps == Approx(0.7 * hopper.events()[0].velocity_before_mps));
  }
}

TEST_CASE("Contacts without end bring the body to rest, not the program") {
  auto p = example_hopper();
  p.rest_height_m = 0.35;  // the preloaded spring holds the body on the leg's stop
  p.restitution_touchdown = 0.0;
  p.damping_stance_nspm = p.damping_flight_nspm = 0.0;
  Hopper<double> hopper(p);
  hopper.reset(hopper.touchdown_height_m() + 1e-3, 0.0);
  for (int n = 0; n < 1000; ++n) hopper.advance(0.0, 1e-3);
  CHECK(hopper.height_m() == Approx(hopper.touchdown_height_m()).margin(2e-3));
  CHECK(std::isfinite(hopper.velocity_mps()));
}

TEST_CASE("The ground does not pull a body down") {
  auto p = example_hopper();
  p.damping_flight_nspm = 0.0;
  p.damping_stance_nspm = 0.0;
  Hopper<double> hopper(p);
  hopper.reset(hopper.touchdown_height_m() - 1e-4, -0.3);
  hopper.advance(5.0, 1e-3);  // flexes the leg with some 50 N, the spring pushes with less than 1 N
  CHECK(hopper.velocity_mps() == Approx(-0.3 - p.gravity_mps2 * 1e-3).epsilon(1e-9));
}
