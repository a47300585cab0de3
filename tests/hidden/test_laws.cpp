// Each law of the virtual machines against a closed form or a balance of energy or momentum.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/hidden/drive.hpp"
#include "tests/hidden/machine.hpp"

namespace furcula::hidden {
namespace {

constexpr double kG = 9.81, kLength = 0.15, kMass = 1.5, kRate = 600.0, kPi = std::numbers::pi;
const double kTouchdown = 2 * kLength * std::cos(20 * kPi / 180);
const double kRest = kTouchdown + 0.007;

// Order of the parameters as in the machine's table.
Truth hopper(std::vector<Planted> planted, double damping_stance = 0.0, double damping_flight = 0.0) {
  return {.kind = Kind::hopper_linear,
          .parameters = {kMass, kRate, kRest, damping_stance, damping_flight, 1.0, 1.0, kLength,
                         20 * kPi / 180, kG},
          .planted = std::move(planted)};
}

Truth axis(std::vector<Planted> planted, double mass = 40.0, double damping = 0.0) {
  return {.kind = Kind::motor_axis, .parameters = {mass, damping}, .planted = std::move(planted)};
}

// Where the body comes to rest on its leg.
double rest_height(std::vector<Planted> planted, double torque_nm = 0.0, double* toe = nullptr) {
  Machine m(hopper(std::move(planted), 60.0), 0.26, 0.0);
  m.advance(8.0, torque_nm);
  if (toe) *toe = m.toe_m();
  return m.position();
}

double apex_after_one_hop(std::vector<Planted> planted) {
  Machine m(hopper(std::move(planted)), 0.34, 0.0);
  double highest = 0.0;
  for (int i = 1; i < 1000 && (m.liftoff_s() < 0 || m.velocity() > 0); ++i) {
    m.advance(i * 1e-3, 0.0);
    if (m.liftoff_s() >= 0)
      highest = std::max(highest, m.position() + m.velocity() * std::abs(m.velocity()) / (2 * kG));
  }
  return highest;
}

// Speed with which the body, pushed down and let go at `from`, passes `to` on its way up.
double speed_on_the_way_up(std::vector<Planted> planted, double from, double to) {
  Machine m(hopper(std::move(planted)), from, 0.0);
  double time = 0.0;
  while (m.position() < to) m.advance(time += 1e-5, 0.0, 1e-5);
  return m.velocity();
}

double compressed_energy(double from, double to) {
  return 0.5 * kRate * (std::pow(kRest - from, 2) - std::pow(kRest - to, 2));
}

}  // namespace

TEST_CASE("A binding spot takes its force times its width, whichever way it is passed") {
  const double expected = std::sqrt(0.25 - 2 * 30.0 * 0.04 / 40.0);
  Machine up(axis({{"binding_spot", {30.0, 0.2, 0.04}}}), 0.0, 0.5);
  up.advance(1.0, 0.0);
  CHECK(up.velocity() == Approx(expected).epsilon(1e-4));
  Machine down(axis({{"binding_spot", {30.0, 0.2, 0.04}}}), 0.4, -0.5);
  down.advance(1.0, 0.0);
  CHECK(down.velocity() == Approx(-expected).epsilon(1e-4));
}

TEST_CASE("A damping error is the axis' true damping, and so much more in a hopper's guide") {
  Machine m(axis({{"damping_error", {60.0}}}, 40.0, 20.0), 0.0, 0.5);
  m.advance(0.8, 0.0);
  CHECK(m.velocity() == Approx(0.5 * std::exp(-60.0 / 40.0 * 0.8)).epsilon(1e-9));
  Machine fall(hopper({{"damping_error", {2.0}}}, 5.0, 1.0), 0.40, 0.0);
  fall.advance(0.12, 0.0);
  REQUIRE_FALSE(fall.stance());
  const double rate = 3.0 / kMass;
  CHECK(fall.velocity() == Approx(-kG / rate * (1 - std::exp(-rate * 0.12))).epsilon(1e-9));
  // The leg's own damper is the same as before: 4 N s/m through the toe.
  Machine stance(hopper({{"damping_error", {2.0}}}, 5.0, 1.0), 0.25, -0.5);
  CHECK(stance.ground_force_n() == Approx(kRate * (kRest - 0.25) + 4.0 * 0.5));
}

TEST_CASE("On a tilted guide the body falls with the cosine's share of gravity") {
  Machine m(hopper({{"guide_tilt", {0.4}}}), 0.40, 0.0);
  m.advance(0.13, 0.0);
  REQUIRE_FALSE(m.stance());
  CHECK(0.40 - m.position() == Approx(0.5 * kG * std::cos(0.4) * 0.13 * 0.13).epsilon(1e-9));
  CHECK(rest_height({{"guide_tilt", {0.4}}}) ==
        Approx(kRest - kMass * kG * std::cos(0.4) / kRate).epsilon(1e-8));
}

TEST_CASE("A mass error is the true mass, in motion and at rest") {
  Machine m(axis({{"mass_error", {50.0}}}), 0.0, 0.0);
  m.advance(2.0, 10.0);
  CHECK(m.velocity() == Approx(10.0 / 50.0 * 2.0).epsilon(1e-9));
  CHECK(rest_height({{"mass_error", {1.8}}}) == Approx(kRest - 1.8 * kG / kRate).epsilon(1e-8));
}

TEST_CASE("A rest height's error moves the resting body by as much") {
  CHECK(rest_height({{"rest_height_error", {kRest + 0.005}}}) ==
        Approx(kRest + 0.005 - kMass * kG / kRate).epsilon(1e-8));
}

TEST_CASE("A hardening spring carries the body where its cubic balances the weight") {
  const double c = kRest - rest_height({{"spring_hardening", {3e5}}});
  CHECK(kRate * c + 3e5 * c * c * c == Approx(kMass * kG).epsilon(1e-7));
}

TEST_CASE("Hysteresis loses its share of the spring's energy, up and down") {
  const double h = 0.15, from = 0.22, to = 0.28;
  const double up = speed_on_the_way_up({{"spring_hysteresis", {h}}}, from, to);
  CHECK(0.5 * kMass * up * up ==
        Approx((1 - h) * compressed_energy(from, to) - kMass * kG * (to - from)).epsilon(1e-3));
  // Down, from the touch-down height with 0.8 m/s to the deepest point.
  Machine m(hopper({{"spring_hysteresis", {h}}}), kTouchdown, -0.8);
  double deepest = kTouchdown;
  for (int i = 1; i < 300; ++i) {
    m.advance(i * 1e-3, 0.0);
    deepest = std::min(deepest, m.position());
  }
  CHECK(0.5 * kMass * 0.64 + kMass * kG * (kTouchdown - deepest) ==
        Approx((1 + h) * compressed_energy(deepest, kTouchdown)).epsilon(1e-3));
}

TEST_CASE("The links' inertia takes its part of the energy that the spring gives") {
  const double a = 42e-4, b = 75e-4, e = 38e-3, from = 0.20;
  for (double to : {0.22, 0.25, 0.275}) {
    const double v = speed_on_the_way_up({{"leg_inertia", {a, b, e}}}, from, to);
    // Kinetic energy in angle and height as in docs/physics.md's M; links' weight -g e cos(theta).
    const double theta = std::acos(to / (2 * kLength)), rate = -v / (2 * kLength * std::sin(theta));
    const double kinetic = 0.5 * (a - 2 * kLength * b * std::cos(2 * theta)) * rate * rate +
                           e * std::sin(theta) * rate * v + 0.5 * kMass * v * v;
    const double lifted = kMass * kG * (to - from) - kG * e * (to - from) / (2 * kLength);
    CHECK(kinetic == Approx(compressed_energy(from, to) - lifted).epsilon(1e-3));
  }
}

TEST_CASE("A torque offset of the motor is seen through the leg's lever arm") {
  const double z = rest_height({{"torque_offset", {0.3}}}, 0.1);
  const double sine = std::sqrt(1 - z * z / (4 * kLength * kLength));
  CHECK(kRate * (kRest - z) == Approx(kMass * kG + 0.4 / (2 * kLength * sine)).epsilon(1e-8));
}

TEST_CASE("A delayed drive moves the axis so much later") {
  Machine m(axis({{"actuator_delay", {0.0123}}}), 0.0, 0.0);
  m.advance(0.5, 10.0);
  m.advance(1.0, 0.0);
  CHECK(m.velocity() == Approx(10.0 / 40.0 * 0.5).epsilon(1e-9));
  const double ended = 0.5 + 0.0123;
  CHECK(m.position() == Approx(0.5 * 0.25 * 0.25 + 0.125 * (1.0 - ended)).epsilon(1e-9));
}

TEST_CASE("A lagging drive answers a step as one less an exponential") {
  Machine m(axis({{"actuator_lag", {0.05}}}), 0.0, 0.0);
  double time = 0.0;
  for (int i = 1; i <= 200; ++i) m.advance(time = i * 1e-3, 10.0);
  // The integral of 1 - exp(-t / tau).
  CHECK(m.velocity() == Approx(10.0 / 40.0 * (time - 0.05 * (1 - std::exp(-time / 0.05)))).epsilon(1e-9));
  CHECK(m.reported_torque(10.0) == Approx(10.0 * (1 - std::exp(-time / 0.05))).epsilon(1e-9));
}

TEST_CASE("The drive limits before it lags, and delays before both") {
  Drive drive({{"torque_saturation", {2.0}}, {"actuator_delay", {0.1}}, {"actuator_lag", {0.2}}}, 0.0, 1);
  drive.command(0.0, 5.0);
  drive.settle(0.1);
  CHECK(drive.reported(0.1) == 0.0);
  CHECK(drive.reported(0.3) == Approx(2.0 * (1 - std::exp(-1.0))));
}

TEST_CASE("Ripple swings with the joint's angle and is not seen in the drive's current") {
  Drive drive({{"torque_ripple", {0.3, 12.0, 0.5}}}, 0.0, 1);
  drive.command(0.0, 1.0);
  CHECK(drive.reported(0.0) == 1.0);
  CHECK(drive.delivered(0.0, 0.7) == Approx(1.0 + 0.3 * std::sin(12.0 * 0.7 + 0.5)));
  // One cycle of the joint, undriven and undamped: what the ripple gives it takes.
  Machine m({.kind = Kind::rotary_joint,
             .parameters = {0.05, 0.0, 0.0},
             .planted = {{"torque_ripple", {0.3, 12.0, 0.5}}}},
            0.0, 8.0);
  double time = 0.0;
  while (m.position() < 2 * kPi / 12) m.advance(time += 1e-5, 0.0, 1e-5);
  CHECK(m.velocity() == Approx(8.0).epsilon(1e-3));
}

TEST_CASE("A drive derates with the seconds in which torque was commanded, and only with them") {
  Drive drive({{"thermal_derating", {0.6, 2.0}}}, 0.0, 1);
  drive.command(0.0, 1.0);
  drive.command(1.0, 0.0);
  drive.command(5.0, 1.0);
  drive.settle(6.0);
  CHECK(drive.delivered(6.0, 0.0) == Approx(0.6 + 0.4 * std::exp(-2.0 / 2.0)));
  CHECK(drive.reported(6.0) == 1.0);
}

TEST_CASE("The rotor crosses the backlash as a free mass, and no impulse is lost") {
  const double gap = 0.05, torque = -2.0, start = 0.22;
  const double crossing_s = std::sqrt(2 * gap * kRotor_kgm2 / std::abs(torque));
  Machine loose(hopper({{"backlash", {gap}}}), start, 0.0), tight(hopper({}), start, 0.0);
  const double angle = loose.motor_angle_rad() - tight.motor_angle_rad();
  CHECK(angle == Approx(gap / 2));
  double time = 0.0;
  while (time < 0.9 * crossing_s) {
    loose.advance(time += 1e-5, torque, 1e-5);
    tight.advance(time, torque, 1e-5);
  }
  // 2 N m over 2 L sin(theta) are 9.8 N: so much of the speed is missing while the rotor is on its way ...
  const double lever = 2 * kLength * std::sin(std::acos(start / (2 * kLength)));
  CHECK(tight.velocity() - loose.velocity() == Approx(2.0 / lever * time / kMass).epsilon(0.02));
  while (time < 1.2 * crossing_s) {
    loose.advance(time += 1e-5, torque, 1e-5);
    tight.advance(time, torque, 1e-5);
  }
  // ... and nothing of it after it has arrived.
  CHECK(loose.motor_angle_rad() - std::acos(loose.position() / (2 * kLength)) == Approx(-gap / 2));
  CHECK(std::abs(tight.velocity() - loose.velocity()) < 0.06 * 2.0 / lever * crossing_s / kMass);
}

TEST_CASE("A loss at lift-off takes the square of its share of the height") {
  const double alpha = 0.8;
  CHECK(apex_after_one_hop({}) == Approx(0.34).epsilon(1e-6));
  const double gained = (0.34 - kTouchdown) * alpha * alpha;
  CHECK(apex_after_one_hop({{"liftoff_loss", {alpha}}}) == Approx(kTouchdown + gained).epsilon(1e-6));
}

TEST_CASE("A soft ground sinks under the weight and takes energy with its damper") {
  double toe = 0.0;
  const double z = rest_height({{"ground_compliance", {5000.0, 20.0}}}, 0.0, &toe);
  CHECK(toe == Approx(-kMass * kG / 5000.0).epsilon(1e-7));
  CHECK(z == Approx(kRest - kMass * kG / kRate - kMass * kG / 5000.0).epsilon(1e-7));
  const double hard = apex_after_one_hop({}),
               firm = apex_after_one_hop({{"ground_compliance", {1e6, 200.0}}}),
               soft = apex_after_one_hop({{"ground_compliance", {5000.0, 20.0}}});
  CHECK(firm == Approx(hard).margin(5e-4));
  CHECK(soft < hard - 5e-4);
}

TEST_CASE("A sticking toe lets go where the stop pulls with its force, and keeps what the stop has taken") {
  const double force = 30.0;
  // At the release 6000 s - k (z0 - td - s) = force; the stop keeps its energy, the spring has given more.
  const double s = (force + kRate * (kRest - kTouchdown)) / (6000.0 + kRate);
  const double lost_j = 0.5 * 6000.0 * s * s - compressed_energy(kTouchdown, kTouchdown + s);
  CHECK(apex_after_one_hop({{"toe_sticking", {force}}}) ==
        Approx(0.34 - lost_j / (kMass * kG)).epsilon(1e-5));
  // More than the body's momentum can break: it stays down.
  Machine held(hopper({{"toe_sticking", {400.0}}}), 0.29, 0.0);
  held.advance(2.0, 0.0);
  CHECK(held.liftoff_s() < 0);
}

// ---- Causes outside of the catalogue ----------------------------------------------------------------------

TEST_CASE("A side mass follows in the long run and rings at its own frequency before") {
  const double m2 = 8.0, f = 4.0;
  Machine m(axis({{"side_mass", {m2, f, 0.3}}}), 0.0, 0.0);
  m.advance(5.0, 12.0);
  CHECK(m.velocity() == Approx(12.0 * 5.0 / 48.0).epsilon(1e-6));
  // Undamped: the axis' speed is that of the common centre and a swing at f sqrt(1 + m2 / m1).
  Machine ringing(axis({{"side_mass", {m2, f, 0.0}}}), 0.0, 0.0);
  const double period = 1 / (f * std::sqrt(1 + m2 / 40.0));
  ringing.advance(3 * period, 12.0);
  CHECK(ringing.velocity() == Approx(12.0 * 3 * period / 48.0).epsilon(1e-6));
  ringing.advance(3.25 * period, 12.0);
  const double swing = m2 / 40.0 * 12.0 / (48.0 * 2 * kPi / period);
  CHECK(ringing.velocity() == Approx(12.0 * 3.25 * period / 48.0 + swing).epsilon(1e-6));
}

TEST_CASE("A bump stop gives back what it takes, and carries its share of a resting body") {
  const double compression = 0.03, rate = 2500.0, from = kTouchdown - 0.06, to = kTouchdown - 0.01;
  const double up = speed_on_the_way_up({{"bump_stop", {compression, rate}}}, from, to);
  CHECK(0.5 * kMass * up * up ==
        Approx(compressed_energy(from, to) + 0.5 * rate * 0.03 * 0.03 - kMass * kG * (to - from))
            .epsilon(1e-3));
  const double z = rest_height({{"bump_stop", {0.005, rate}}});
  CHECK(kRate * (kRest - z) + rate * (kTouchdown - z - 0.005) == Approx(kMass * kG).epsilon(1e-7));
}

TEST_CASE("An end stop throws back with the speed that it took, and a snag holds one way alone") {
  Machine m(axis({{"end_stop", {0.1, 4000.0}}}), 0.0, 0.5);
  m.advance(1.0, 0.0);
  CHECK(m.velocity() == Approx(-0.5).epsilon(1e-4));
  const std::vector<Planted> snag{{"cable_snag", {30.0, 0.2, 0.04}}};
  Machine up(axis(snag), 0.0, 0.5), down(axis(snag), 0.4, -0.5);
  up.advance(1.0, 0.0);
  down.advance(1.0, 0.0);
  CHECK(up.velocity() == Approx(std::sqrt(0.25 - 2 * 30.0 * 0.04 / 40.0)).epsilon(1e-4));
  CHECK(down.velocity() == Approx(-0.5).epsilon(1e-12));
}

TEST_CASE("A periodic force swings the axis as its integral does, and detents give back what they take") {
  const double w = 2 * kPi * 5.0;
  Machine m(axis({{"periodic_force", {6.0, 5.0, 0.4}}}), 0.0, 0.0);
  m.advance(0.77, 0.0);
  CHECK(m.velocity() == Approx(6.0 / (40.0 * w) * (std::cos(0.4) - std::cos(w * 0.77 + 0.4))).epsilon(1e-6));
  Machine detents(axis({{"detents", {20.0, 0.05, 0.3}}}), 0.0, 0.5);
  double time = 0.0;
  while (detents.position() < 0.05) detents.advance(time += 1e-5, 0.0, 1e-5);
  CHECK(detents.velocity() == Approx(0.5).epsilon(1e-4));
}

TEST_CASE("Friction that warms up slows the axis by its integral") {
  Machine m(axis({{"warming_friction", {8.0, 0.5}}}), 0.0, 1.0);
  m.advance(1.0, 0.0);
  CHECK(m.velocity() == Approx(1.0 - 8.0 / 40.0 * (1.0 - 0.5 * (1 - std::exp(-2.0)))).epsilon(1e-9));
}

TEST_CASE("A fading spring lets the body sink") {
  CHECK(rest_height({{"fading_spring", {0.2, 0.5}}}) ==
        Approx(kRest - kMass * kG / (0.8 * kRate)).epsilon(1e-5));
}

TEST_CASE("A creeping spring lets the body sink by what it gives up of its compression from the stop") {
  // At rest: rate (rest - z) - share rate (stop - z) = weight.
  const double share = 0.3;
  CHECK(rest_height({{"creeping_spring", {share, 0.4}}}) ==
        Approx((kRest - share * kTouchdown - kMass * kG / kRate) / (1.0 - share)).epsilon(1e-5));
}

TEST_CASE(
    "A drive that drops out is off for its share of the time, and a dead band swallows small commands") {
  Drive drive({{"drive_dropout", {0.02, 5.0}}}, 0.0, 3);
  int off = 0;
  for (int i = 0; i < 50000; ++i) {
    drive.command(i * 1e-3, 1.0);
    off += drive.reported(i * 1e-3) == 0.0;
  }
  // 20 ms off after 200 ms on, in the mean over some 230 times.
  CHECK(off / 50000.0 == Approx(0.02 / 0.22).epsilon(0.2));
  Drive deaf({{"drive_deadband", {0.5}}}, 0.0, 1);
  deaf.command(0.0, 0.49);
  CHECK(deaf.reported(0.0) == 0.0);
  deaf.command(1.0, -0.51);
  CHECK(deaf.reported(1.0) == -0.51);
}

TEST_CASE("Gusts are the same for one draw, and others for another") {
  const auto speed = [](std::uint64_t draw) {
    Truth t = axis({{"gusts", {50.0, 0.1, 3.0}}});
    t.draw = draw;
    Machine m(t, 0.0, 0.0);
    m.advance(2.0, 0.0);
    return m.velocity();
  };
  CHECK(speed(1) == speed(1));
  CHECK(speed(1) != speed(2));
  CHECK(std::abs(speed(1)) > 1e-3);
}

}  // namespace furcula::hidden
