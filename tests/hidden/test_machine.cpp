// The virtual machines against closed forms: what hides the effects must itself be right.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "tests/hidden/machine.hpp"

namespace furcula::hidden {
namespace {

constexpr double kGravity = 9.81;
constexpr double kTouchdownAngle = 20.0 * std::numbers::pi / 180.0;

// 002, section 3.2.1: the example's rig; order of the parameters as in the machine's table.
Truth example_hopper() {
  const double length = 0.15;
  return {.kind = Kind::hopper_linear,
          .parameters = {1.5, 600.0, 2 * length * std::cos(kTouchdownAngle), 5.0, 1.0, 1.0, 1.0, length,
                         kTouchdownAngle, kGravity},
          .planted = {}};
}

Truth lossless_hopper() {
  Truth t = example_hopper();
  t.parameters[3] = t.parameters[4] = 0.0;
  return t;
}

Truth axis(double mass_kg, double damping_nspm, std::vector<Planted> planted = {}) {
  return {.kind = Kind::motor_axis, .parameters = {mass_kg, damping_nspm}, .planted = std::move(planted)};
}

// Highest point of each flight within `duration_s` with the torque T sin(2 pi (t - t_td)/P) from the true
// touch-down on, followed every 20 microseconds.
std::vector<double> apexes_of_continuous_torque(const Truth& truth, double amplitude_nm, double duration_s) {
  constexpr double kTick_s = 20e-6, kPeriod_s = 0.3;
  Machine m(truth, 0.35, 0.0);
  std::vector<double> apexes;
  double highest = 0;
  for (int i = 1; i * kTick_s < duration_s; ++i) {
    const double middle_s = (i - 0.5) * kTick_s;
    const double torque =
        m.stance() ? amplitude_nm * std::sin(2 * std::numbers::pi * (middle_s - m.touchdown_s()) / kPeriod_s)
                   : 0.0;
    const bool was_stance = m.stance();
    m.advance(i * kTick_s, torque, kTick_s);
    if (!m.stance()) highest = std::max(highest, m.position());
    if (m.stance() && !was_stance) {
      apexes.push_back(highest);
      highest = 0;
    }
  }
  return apexes;
}

}  // namespace

TEST_CASE("A hopper's flight is free fall with viscous drag in closed form") {
  const Truth truth = example_hopper();
  const double rate = truth.parameters[4] / truth.parameters[0], terminal = kGravity / rate;
  Machine m(truth, 0.36, 0.4);
  m.advance(0.15, 0.0);
  REQUIRE_FALSE(m.stance());
  const double t = 0.15, decayed = std::exp(-rate * t);
  CHECK(m.velocity() == Approx((0.4 + terminal) * decayed - terminal).epsilon(1e-10));
  CHECK(m.position() == Approx(0.36 + (0.4 + terminal) * (1 - decayed) / rate - terminal * t).epsilon(1e-10));
}

TEST_CASE("A dropped hopper touches down and lifts off at the instants of the closed form") {
  Machine m(lossless_hopper(), 0.35, 0.0);
  const double drop_m = 0.35 - m.touchdown_height_m(), fall_s = std::sqrt(2 * drop_m / kGravity);
  m.advance(0.2, 0.0);
  CHECK(m.touchdown_s() == Approx(fall_s).margin(2e-9));
  // Undamped stance about the loaded height, from touch-down height back to it.
  const double frequency = std::sqrt(600.0 / 1.5), speed = std::sqrt(2 * kGravity * drop_m);
  const double sag = 1.5 * kGravity / 600.0;
  const double stance_s = (std::numbers::pi + 2 * std::atan(frequency * sag / speed)) / frequency;
  Machine again(lossless_hopper(), 0.35, 0.0);
  again.advance(fall_s + stance_s + 0.01, 0.0);
  CHECK(again.liftoff_s() == Approx(fall_s + stance_s).margin(2e-8));
}

TEST_CASE("A hopper without loss keeps its energy over fifty hops") {
  Machine m(lossless_hopper(), 0.35, 0.0);
  const double energy_j = 1.5 * kGravity * 0.35;
  int hops = 0;
  double last_liftoff = m.liftoff_s();
  for (int i = 1; hops < 50; ++i) {
    m.advance(i * 1e-3, 0.0);
    if (m.liftoff_s() != last_liftoff) ++hops;
    last_liftoff = m.liftoff_s();
    REQUIRE(i < 50000);
  }
  m.advance(m.time_s() + 0.05, 0.0);
  REQUIRE_FALSE(m.stance());
  const double now_j = 1.5 * kGravity * m.position() + 0.5 * 1.5 * m.velocity() * m.velocity();
  CHECK(now_j == Approx(energy_j).epsilon(1e-7));
}

TEST_CASE("The source's example hops to a steady apex of 0.361 m, and dies with the torque's sign turned") {
  const std::vector<double> driven = apexes_of_continuous_torque(example_hopper(), 2.0, 12.0);
  REQUIRE(driven.size() > 15);
  CHECK(driven.back() == Approx(0.361).margin(1e-3));
  CHECK(driven[driven.size() - 2] == Approx(driven.back()).margin(1e-4));
  const std::vector<double> braked = apexes_of_continuous_torque(example_hopper(), -2.0, 6.0);
  REQUIRE(braked.size() > 2);
  CHECK(braked.back() < 0.33);
}

TEST_CASE("Restitution at touch-down takes its share of the speed") {
  Truth truth = lossless_hopper();
  truth.planted = {{"touchdown_loss", {0.8}}};
  Machine m(truth, 0.35, 0.0);
  const double fall_s = std::sqrt(2 * (0.35 - m.touchdown_height_m()) / kGravity);
  m.advance(fall_s + 1e-9, 0.0);
  REQUIRE(m.stance());
  CHECK(m.velocity() == Approx(-0.8 * kGravity * fall_s).epsilon(1e-6));
}

TEST_CASE("The ground pushes with the weight when the body rests on the leg") {
  Truth truth = example_hopper();
  truth.planted = {{"coulomb_friction", {0.5}}};
  Machine m(truth, 0.26, 0.0);
  m.advance(5.0, 0.0);
  REQUIRE(m.sticking());
  // It rests wherever friction holds it: within 0.5 N of the weight.
  CHECK(std::abs(m.ground_force_n() - 1.5 * kGravity) <= 0.5);
  CHECK(m.ground_force_n() != Approx(1.5 * kGravity).epsilon(1e-9));
}

TEST_CASE("Stance damping less the guide's pushes through the toe, the guide's does not") {
  Machine m(example_hopper(), 0.25, -0.5);
  CHECK(m.ground_force_n() == Approx(600.0 * (2 * 0.15 * std::cos(kTouchdownAngle) - 0.25) + 4.0 * 0.5));
}

TEST_CASE("An axis coasting under dry friction stops where the closed form says and stays there") {
  Machine m(axis(40.0, 0.0, {{"coulomb_friction", {8.0}}}), 0.0, 0.5);
  m.advance(4.0, 0.0);
  // m v^2 / (2 Fc), after m v / Fc = 2.5 s.
  CHECK(m.position() == Approx(40.0 * 0.25 / 16.0).epsilon(1e-9));
  CHECK(m.velocity() == 0.0);
  CHECK(m.sticking());
  m.advance(5.0, 7.99);
  CHECK(m.position() == Approx(0.625).epsilon(1e-9));
  m.advance(6.0, 9.0);
  CHECK(m.velocity() == Approx(1.0 / 40.0).epsilon(1e-9));
}

TEST_CASE("Dry and viscous friction together stop the axis at the closed form's distance") {
  const double mass = 40.0, damping = 60.0, friction = 8.0, speed = 0.5;
  Machine m(axis(mass, damping, {{"coulomb_friction", {friction}}}), 0.0, speed);
  m.advance(3.0, 0.0);
  const double logarithm = std::log1p(damping * speed / friction);
  CHECK(m.position() == Approx(mass / damping * (speed - friction / damping * logarithm)).epsilon(1e-8));
}

TEST_CASE("Asymmetric friction holds an axis between its two limits") {
  Machine m(axis(40.0, 0.0, {{"asymmetric_friction", {10.0, 4.0}}}), 0.0, 0.0);
  m.advance(1.0, 9.9);
  m.advance(2.0, -3.9);
  CHECK(m.position() == 0.0);
  m.advance(3.0, 11.0);
  CHECK(m.velocity() == Approx(1.0 / 40.0).epsilon(1e-9));
  Machine down(axis(40.0, 0.0, {{"asymmetric_friction", {10.0, 4.0}}}), 0.0, 0.0);
  down.advance(1.0, -5.0);
  CHECK(down.velocity() == Approx(-1.0 / 40.0).epsilon(1e-9));
}

TEST_CASE("Stribeck friction breaks away at the static force and runs under the Coulomb force") {
  const std::vector<Planted> stribeck{{"stribeck_friction", {6.0, 12.0, 0.02}}};
  Machine held(axis(40.0, 0.0, stribeck), 0.0, 0.0);
  held.advance(1.0, 11.9);
  CHECK(held.position() == 0.0);
  // Far above the Stribeck velocity only the Coulomb force is left.
  Machine fast(axis(40.0, 0.0, stribeck), 0.0, 1.0);
  fast.advance(0.5, 0.0);
  CHECK(fast.velocity() == Approx(1.0 - 6.0 / 40.0 * 0.5).epsilon(1e-9));
}

TEST_CASE("Quadratic drag slows an axis as one over time") {
  Machine m(axis(40.0, 0.0, {{"quadratic_drag", {16.0}}}), 0.0, -2.0);
  m.advance(1.5, 0.0);
  CHECK(m.velocity() == Approx(-2.0 / (1 + 16.0 * 2.0 * 1.5 / 40.0)).epsilon(1e-9));
}

TEST_CASE("A pendulum's small swing has the period of its gravity torque and inertia") {
  Machine m({.kind = Kind::rotary_joint, .parameters = {0.05, 2.0, 0.0}, .planted = {}}, 1e-3, 0.0);
  m.advance(2 * std::numbers::pi * std::sqrt(0.05 / 2.0), 0.0);
  CHECK(m.position() == Approx(1e-3).epsilon(1e-6));
  CHECK(std::abs(m.velocity()) < 1e-8);
}

TEST_CASE("A pendulum with an offset torque hangs where gravity balances it") {
  Machine m(
      {.kind = Kind::rotary_joint, .parameters = {0.05, 2.0, 0.3}, .planted = {{"force_offset", {0.5}}}}, 0.0,
      0.0);
  m.advance(20.0, 0.0);
  CHECK(m.position() == Approx(std::asin(0.25)).epsilon(1e-9));
}

TEST_CASE("A spring's preload, rate error and the torque's gain move the resting height as they must") {
  const auto rest = [](std::vector<Planted> planted, double torque_nm) {
    Truth t = example_hopper();
    t.parameters[3] = 60.0;  // so that it settles
    t.planted = std::move(planted);
    Machine m(t, 0.26, 0.0);
    m.advance(8.0, torque_nm);
    return m.position();
  };
  const double rest_height = 2 * 0.15 * std::cos(kTouchdownAngle), weight = 1.5 * kGravity;
  CHECK(rest({}, 0.0) == Approx(rest_height - weight / 600.0).epsilon(1e-9));
  CHECK(rest({{"spring_preload", {3.0}}}, 0.0) == Approx(rest_height - (weight - 3.0) / 600.0).epsilon(1e-9));
  CHECK(rest({{"stiffness_error", {660.0}}}, 0.0) == Approx(rest_height - weight / 660.0).epsilon(1e-9));
  // Positive torque flexes the leg: the body comes down until spring and lever arm carry it.
  const double z = rest({{"torque_gain_error", {1.25}}}, 0.4);
  const double sine = std::sqrt(1 - z * z / 0.09);
  CHECK(600.0 * (rest_height - z) == Approx(weight + 1.25 * 0.4 / (0.3 * sine)).epsilon(1e-9));
}

TEST_CASE("The random force on a machine has the size and the correlation that are asked") {
  const Disturbance size{.force = 0.3, .correlation_s = 0.04};
  double squares = 0, products = 0;
  int n = 0;
  for (std::uint64_t draw = 1; draw <= 40; ++draw) {
    const Disturbed d(size, draw);
    for (double t = 0; t < 50; t += 0.04, ++n) {
      squares += d.force(t) * d.force(t);
      products += d.force(t) * d.force(t + 0.04);
    }
  }
  CHECK(std::sqrt(squares / n) == Approx(0.3).epsilon(0.02));
  CHECK(products / squares == Approx(std::exp(-1.0)).epsilon(0.05));
  CHECK(Disturbed(size, 7).force(1.0) == Disturbed(size, 7).force(1.0));
  CHECK(Disturbed(size, 7).force(1.0) != Disturbed(size, 8).force(1.0));
  CHECK(Disturbed({}, 7).force(1.0) == 0.0);
}

TEST_CASE("A random force moves an axis by its double integral") {
  Truth t = axis(2.0, 0.0);
  t.disturbance = {.force = 0.5, .correlation_s = 0.05};
  t.draw = 3;
  const Disturbed d(t.disturbance, t.draw);
  Machine m(t, 0.0, 0.0);
  m.advance(2.0, 0.0);
  double speed = 0, position = 0;
  constexpr double kH = 1e-4;
  for (double now = 0; now < 2.0 - kH / 2; now += kH) {
    position += kH * speed + kH * kH / 2 * d.force(now + kH / 2) / 2.0;
    speed += kH * d.force(now + kH / 2) / 2.0;
  }
  CHECK(std::abs(position) > 1e-3);
  CHECK(m.position() == Approx(position).epsilon(1e-4));
}

TEST_CASE("Impacts and ground of a disturbed hopper scatter from hop to hop as they are drawn") {
  // On hard ground without losses: what a hop gains is what its ground and its impacts give.
  Truth t = lossless_hopper();
  t.disturbance = {.restitution = 0.01, .ground_m = 1e-3};
  t.draw = 5;
  const Disturbed d(t.disturbance, t.draw);
  Machine m(t, 0.33, 0.0);
  double before = 0.33;
  for (int hop = 0; hop < 6; ++hop) {
    double now = m.time_s();
    while (!m.stance()) m.advance(now += 1e-4, 0.0);
    while (m.stance()) m.advance(now += 1e-4, 0.0);
    double highest = 0;
    for (const int hops = hop + 1; !m.stance() && m.velocity() > -0.05 && hops; m.advance(now += 1e-4, 0.0))
      highest = std::max(highest, m.position());
    // The body leaves the ground at the height where it met it.
    const double meets = m.touchdown_height_m() + d.ground_m(hop);
    const double speed2 = 2 * kGravity * (before - meets);
    const double kept = d.factor(2 * hop) * d.factor(2 * hop + 1);
    // In between, spring and weight give back what they took.
    CHECK(2 * kGravity * (highest - meets) == Approx(speed2 * kept * kept).epsilon(2e-3));
    CHECK(std::abs(kept - 1) > 1e-4);
    before = highest;
  }
}

}  // namespace furcula::hidden
