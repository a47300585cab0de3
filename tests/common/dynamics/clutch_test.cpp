// Solenoid, clutch, bench and the hopper with a clutch: energy to nine digits, closed forms, the published
// figures.
#include "furcula/dynamics/clutch.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

#include "furcula/dynamics/clutch_bench.hpp"
#include "furcula/dynamics/clutch_designs.hpp"
#include "furcula/dynamics/nonlinear_hopper.hpp"

using furcula::dynamics::bench_clutch;
using furcula::dynamics::Clutch;
using furcula::dynamics::ClutchBenchRig;
using furcula::dynamics::ClutchedHopper;
using furcula::dynamics::HopperNonlinearParameters;
using furcula::dynamics::modular_clutch;
using furcula::dynamics::NonlinearHopper;
using furcula::dynamics::release_catch_bench;
using Rig = ClutchBenchRig<double>;

namespace {

constexpr double kSupply_v = 12.0;

/// What the bench has less what it had, took and lost: zero.
double imbalance(const Rig& rig) {
  const auto e = rig.energy();
  return e.held() + rig.weight_energy() + e.lost() - e.electrical;
}

/// Of the teeth that the belt stands at.
double off_pitch(double travel, double pitch) {
  return std::abs(travel - pitch * std::round(travel / pitch));
}

}  // namespace

TEST_CASE("The bench's solenoid pulls 20 N from 2.5 mm, the modular one holds 15 kg and takes 15 W") {
  const auto bench = bench_clutch<double>();
  CHECK(bench.solenoid.pull(kSupply_v / bench.solenoid.resistance_ohm, 0.0) == Approx(20.0).epsilon(0.05));
  const auto modular = modular_clutch<double>();
  const double current = 10.0 / modular.solenoid.resistance_ohm;
  CHECK(current == Approx(1.5));
  CHECK(modular.solenoid.pull(current, modular.solenoid.stroke_m) == Approx(15 * 9.81).epsilon(0.05));
  CHECK(modular.solenoid.pull(current, 0.0) > modular.pressing_force_n);  // or it would never release
}

TEST_CASE("A solenoid's pull is what its magnetic energy changes by at the same flux") {
  const auto s = bench_clutch<double>().solenoid;
  const double h = 1e-7;
  for (const double y : {0.0, 1e-3, 2.4e-3})
    for (const double current : {0.3, 2.0}) {
      const double flux = s.inductance(y) * current;
      const auto energy = [&](double at) { return flux * flux / (2.0 * s.inductance(at)); };
      CHECK(s.pull(current, y) == Approx(-(energy(y + h) - energy(y - h)) / (2.0 * h)).epsilon(1e-6));
    }
}

TEST_CASE("With the key held, a coil's current rises like any coil's") {
  auto setup = release_catch_bench<double>();
  setup.clutch.pressing_force_n = 1e4;
  Rig rig(setup);
  const auto& s = setup.clutch.solenoid;
  for (int n = 1; n <= 60; ++n) {
    rig.advance(kSupply_v, 1e-3);
    const double closed =
        kSupply_v / s.resistance_ohm * (1.0 - std::exp(-1e-3 * n * s.resistance_ohm / s.inductance(0.0)));
    CHECK(rig.current_a() == Approx(closed).epsilon(1e-9));
  }
}

TEST_CASE(
    "A released weight falls like a weight on a pulley, and is caught at a whole tooth after 20 to 50 ms") {
  // Document 002, section 5.1: 1 kg, 40 ms between release and catch.
  const auto setup = release_catch_bench<double>();
  Rig rig(setup);
  int released = -1, caught = -1;
  double speed_then = 0.0;
  for (int n = 0; n < 200; ++n) {
    rig.advance(n < 40 ? kSupply_v : 0.0, 1e-3);
    if (released < 0 && rig.speed_mps() > 0.05) {
      released = n;
      speed_then = rig.speed_mps();
    }
    if (released >= 0 && n == released + 10) {  // the key is clear: m g - friction on weight, belt and pulley
      const double r = setup.pulley_radius_m;
      const double mass =
          setup.load_mass_kg + setup.clutch.cable_mass_kg + setup.pulley_inertia_kgm2 / (r * r);
      const double force = setup.load_mass_kg * setup.gravity_mps2 - setup.clutch.cable_friction_n;
      const double rate = setup.clutch.cable_damping_nspm / mass,
                   steady = force / setup.clutch.cable_damping_nspm;
      CHECK(rig.speed_mps() ==
            Approx(steady + (speed_then - steady) * std::exp(-rate * 10e-3)).epsilon(1e-9));
    }
    if (n > 40 && caught < 0 && rig.caught() && rig.speed_mps() == 0.0) caught = n;
    CHECK(std::abs(imbalance(rig)) < 1e-9);
  }
  REQUIRE(caught > 0);
  CHECK(caught - 40 >= 20);
  CHECK(caught - 40 <= 50);
  CHECK(rig.travel_m() > 0.003);
  CHECK(off_pitch(rig.travel_m(), setup.clutch.tooth_pitch_m) < 1e-12);
  CHECK(rig.pulley_angle_rad() == Approx(rig.travel_m() / setup.pulley_radius_m));
}

TEST_CASE("Whenever it is released and caught again, a weight ends on a whole tooth and the energy adds up") {
  auto setup = release_catch_bench<double>();
  const double pitch = setup.clutch.tooth_pitch_m;
  int rode = 0, lost = 0;
  for (const double load : {0.3, 1.0, 2.0})
    for (int window = 10; window <= 80; window += 7) {
      setup.load_mass_kg = load;
      Rig rig(setup);
      double on_tips = 0.0;
      for (int n = 0; n < 600; ++n) {
        rig.advance(n < window ? kSupply_v : 0.0, 1e-3);
        if (rig.clutch().key() == Clutch<double>::Key::on_tips) on_tips += 1e-3;
      }
      rode += on_tips > 0.0;
      CAPTURE(load, window, rig.travel_m());
      CHECK(std::abs(imbalance(rig)) < 1e-9 * std::max(1.0, rig.energy().lost()));
      CHECK(rig.speed_mps() == 0.0);
      if (rig.travel_m() == setup.clutch.travel_m) {  // so fast that every tooth threw the key out
        ++lost;
        CHECK(load * window > 60.0);
        continue;
      }
      CHECK(rig.caught());
      CHECK(off_pitch(rig.travel_m(), pitch) < 1e-12);
    }
  CHECK(lost < 15);
  CHECK(rode > 5);  // the key does not always find a gap
}

TEST_CASE("A key on the tips of a belt that stands waits until the belt moves") {
  auto setup = release_catch_bench<double>();
  // Friction that stops a light weight between two teeth while it is released.
  setup.clutch.cable_friction_n = 0.9;
  setup.load_mass_kg = 0.1;
  setup.clutch.travel_m = 0.0045;  // the cable's stop, half a pitch from a tooth
  Rig rig(setup);
  for (int n = 0; n < 400; ++n) rig.advance(n < 200 ? kSupply_v : 0.0, 1e-3);
  CHECK(rig.travel_m() == Approx(0.0045));
  CHECK(rig.clutch().key() == Clutch<double>::Key::on_tips);
  CHECK_FALSE(rig.caught());
  CHECK(std::abs(imbalance(rig)) < 1e-9);
}

TEST_CASE("Seated teeth hold up to their share of the pressing force, and beyond it skip whole teeth") {
  for (const double pressing : {4.0, 8.0, 12.0}) {
    auto setup = release_catch_bench<double>();
    setup.clutch.pressing_force_n = pressing;
    const double capacity = setup.clutch.holding_ratio * pressing + setup.clutch.cable_friction_n;
    setup.load_mass_kg = 0.999 * capacity / setup.gravity_mps2;
    Rig holds(setup);
    for (int n = 0; n < 100; ++n) holds.advance(0.0, 1e-3);
    CHECK(holds.travel_m() == 0.0);
    CHECK(holds.clutch().skipped_teeth() == 0);
    setup.load_mass_kg = 1.05 * capacity / setup.gravity_mps2;
    Rig slips(setup);
    for (int n = 0; n < 300 && slips.clutch().skipped_teeth() < 5; ++n) slips.advance(0.0, 1e-3);
    REQUIRE(slips.clutch().skipped_teeth() >= 5);
    const auto e = slips.energy();
    CHECK(std::abs(imbalance(slips)) < 1e-9);
    CHECK_FALSE(slips.caught());
    // Each tooth turns the holding force times the pitch into heat, and the pulleys their friction.
    CHECK(e.friction == Approx(capacity * slips.travel_m()).epsilon(1e-6));
  }
}

TEST_CASE("A belt that the auxiliary spring pulls back slips upwards as it does downwards, tooth by tooth") {
  // The weight is above what the teeth hold, and falls far beyond where the spring carries it: caught down there, the spring's pull less
  // the weight is above what they hold too.
  auto setup = release_catch_bench<double>();
  setup.clutch.auxiliary_stiffness_npm = 1500.0;
  setup.clutch.cable_damping_nspm = 0.0;
  setup.clutch.travel_m = 0.2;
  const double holding = setup.clutch.holding_ratio * setup.clutch.pressing_force_n;
  const double resisting = holding + setup.clutch.cable_friction_n;
  setup.load_mass_kg = 2.5 * resisting / setup.gravity_mps2;
  Rig rig(setup);
  // Released until it turns, the key comes while it goes up.
  int n = 0;
  for (; n < 6000 && (rig.travel_m() < 0.01 || rig.speed_mps() >= 0.0); ++n) rig.advance(kSupply_v, 1e-4);
  REQUIRE(n < 6000);
  const double lowest_m = rig.travel_m();
  double friction_j = 0.0, from_m = 0.0;
  std::uint32_t skipped = rig.clutch().skipped_teeth();
  int upwards = 0;
  for (int i = 0; i < 20000; ++i) {
    rig.advance(0.0, 1e-5);
    if (rig.clutch().skipped_teeth() == skipped) continue;
    skipped = rig.clutch().skipped_teeth();
    if (rig.speed_mps() >= 0.0) break;
    // From one skipped tooth to the next: what the teeth and the pulleys turn into heat over the way.
    if (upwards++ > 0)
      CHECK((rig.energy().friction - friction_j) / (from_m - rig.travel_m()) ==
            Approx(resisting).epsilon(1e-6));
    friction_j = rig.energy().friction;
    from_m = rig.travel_m();
  }
  CHECK(upwards >= 3);
  CHECK(rig.travel_m() < lowest_m - 2.0 * setup.clutch.tooth_pitch_m);
  CHECK(std::abs(imbalance(rig)) < 1e-9 * std::max(1.0, rig.energy().lost()));
}

namespace {

HopperNonlinearParameters<double> robot() {
  HopperNonlinearParameters<double> p;
  p.mass_kg = 2.6;  // with its clutch
  p.stiffness_npm = 600.0;
  p.link_length_m = 0.15;
  p.touchdown_angle_rad = 20.0 * std::numbers::pi / 180.0;
  p.rest_height_m = 0.289;
  p.damping_stance_nspm = 5.0;
  p.damping_flight_nspm = 1.0;
  p.restitution_touchdown = p.restitution_liftoff = 1.0;
  p.gravity_mps2 = 9.81;
  p.inertia_a_kgm2 = 42e-4;
  p.inertia_b_kgm = 75e-4;
  p.inertia_e_kgm = 38e-3;
  return p;
}

double imbalance(const ClutchedHopper<double>& robot, double start) {
  const auto e = robot.energy();
  const auto c = robot.clutch_energy();
  return e.held() + c.held() + e.lost() + c.lost() - e.motor - c.electrical - start;
}

}  // namespace

TEST_CASE("Caught, the robot with a clutch hops like the one without") {
  NonlinearHopper<double> without(robot());
  ClutchedHopper<double> with(robot(), Clutch<double>(modular_clutch<double>()));
  without.reset(0.36, 0.0);
  with.reset(0.36, 0.0);
  for (int n = 0; n < 1000; ++n) {
    const double torque = without.in_stance() ? std::sin(20.0 * 1e-3 * n) : 0.0;
    without.advance(torque, 1e-3);
    with.advance(torque, 1e-3);
    REQUIRE(with.height_m() == Approx(without.height_m()).margin(1e-12));
  }
  CHECK(with.caught());
  CHECK(with.cable_travel_m() == 0.0);
}

TEST_CASE("Released in flight the leg folds against the soft spring alone") {
  ClutchedHopper<double> robot_(robot(), Clutch<double>(modular_clutch<double>()));
  robot_.reset(3.0, 0.0);
  for (int n = 0; n < 400; ++n) {  // a fold of the leg by 1 N m; 60 N would need 10 N m
    robot_.set_voltage(10.0);
    robot_.advance(n < 60 ? 0.0 : 1.0, 1e-3);
  }
  CHECK_FALSE(robot_.caught());
  CHECK(robot_.cable_travel_m() > 0.04);
  NonlinearHopper<double> stiff(robot());
  stiff.reset(3.0, 0.0);
  for (int n = 0; n < 400; ++n) stiff.advance(n < 60 ? 0.0 : 1.0, 1e-3);
  CHECK(stiff.leg_angle_rad() < 0.45);
  CHECK(robot_.leg_angle_rad() > 0.8);
}

TEST_CASE("Release, fold, return, catch, land and slip: the energy adds up to a billionth") {
  auto clutch = modular_clutch<double>();
  clutch.holding_ratio = 6.5;  // 65 N: less than the deepest stances ask for
  ClutchedHopper<double> robot_(robot(), Clutch<double>(clutch));
  robot_.reset(0.42, 0.0);
  const double start = robot_.energy().held() + robot_.clutch_energy().held();
  double worst = 0.0, flight = 0.0, stance = 0.0, impacts = 0.0;
  int catches = 0, landings = 0;
  bool caught = true;
  for (int n = 0; n < 20000; ++n) {
    flight = robot_.in_stance() ? 0.0 : flight + 1e-3;
    stance = robot_.in_stance() ? stance + 1e-3 : 0.0;
    // Blind: released 5 ms after take-off, the leg pulled up for 30 ms and pushed back, the coil off at 90
    // ms.
    const bool released = flight > 0.005 && flight < 0.09;
    robot_.set_voltage(released ? 10.0 : 0.0);
    const double torque = robot_.in_stance() ? 5.0 * std::sin(2 * std::numbers::pi * stance / 0.42)
                          : flight < 0.035   ? 1.2
                                             : -0.6;
    robot_.advance(torque, 1e-3);
    const double lost = robot_.clutch_energy().impacts;
    CHECK(lost >= impacts - 1e-12);  // nothing is won in an impact
    impacts = lost;
    for (const auto& e : robot_.events())
      landings += e.kind == furcula::dynamics::ContactEvent<double>::Kind::touchdown;
    catches += robot_.caught() && !caught;
    caught = robot_.caught();
    worst = std::max(worst, std::abs(imbalance(robot_, start)));
  }
  CAPTURE(worst, catches, landings, robot_.energy().motor, robot_.clutch_energy().electrical);
  CHECK(landings > 20);
  CHECK(catches > 20);
  CHECK(robot_.clutch().skipped_teeth() > 5);
  CHECK(worst < 1e-9 * (robot_.energy().motor + robot_.clutch_energy().electrical));
}

TEST_CASE("No impact of the clutch wins energy, whatever coil and motor do") {
  auto clutch = modular_clutch<double>();
  clutch.holding_ratio = 4.0;
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int run = 0; run < 40; ++run) {
    ClutchedHopper<double> robot_(robot(), Clutch<double>(clutch));
    robot_.reset(0.36 + 0.03 * uniform(random), 0.0);
    const double start = robot_.energy().held() + robot_.clutch_energy().held();
    double before = 0.0;
    for (int n = 0; n < 1500;) {
      const double volts = uniform(random) > 0.0 ? 10.0 : 0.0, torque = 4.0 * uniform(random);
      for (int k = 0; k < 30; ++k, ++n) {
        robot_.set_voltage(volts);
        robot_.advance(torque, 1e-3);
        const double impacts = robot_.clutch_energy().impacts;
        CHECK(impacts >= before - 1e-12);
        before = impacts;
        REQUIRE(std::isfinite(robot_.height_m()));
        REQUIRE(robot_.cable_travel_m() >= -1e-12);
        REQUIRE(robot_.cable_travel_m() <= clutch.travel_m + 1e-12);
      }
    }
    CHECK(std::abs(imbalance(robot_, start)) < 1e-7);
  }
}
