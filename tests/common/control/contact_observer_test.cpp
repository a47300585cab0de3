// The contact observer, on a leg that is integrated here in double, and what makes it a witness.
#include "furcula/control/contact_observer.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

using namespace furcula::control;

namespace {

constexpr double kTick_s = 0.001;
constexpr double kLink_m = 0.15, kStop_rad = 0.3490658503988659;
constexpr double kInertia = 0.0024, kSpring = 600.0, kRest_m = 0.289, kDamping = 4.0;

double length_m(double angle) { return 2.0 * kLink_m * std::cos(angle); }
double lever_m(double angle) { return 2.0 * kLink_m * std::sin(angle); }
double spring_n(double angle) { return kSpring * (kRest_m - length_m(angle)); }

/// A leg about a hip that stands still: I angle'' = motor - lever (spring + damping lever rate) + lever push.
struct Leg {
  double angle = kStop_rad, rate = 0.0;
  ContactObserverConfig config{.leg_damping_nspm = static_cast<float>(kDamping)};
  ContactObserverState state;
  float last_nm = 0.0f;
  double links = 1.0;  ///< as the observer knows them, over what they are
  bool late = false;   ///< the angle comes a tick later
  double angle_before = kStop_rad;

  ContactEstimate tick(double motor_nm, double push_n) {
    constexpr int kSteps = 100;
    for (int i = 0; i < kSteps; ++i) {
      const double b = lever_m(angle);
      const double torque = motor_nm - b * (spring_n(angle) + kDamping * b * rate) + b * push_n;
      rate += torque / kInertia * kTick_s / kSteps;
      angle += rate * kTick_s / kSteps;
      if (angle <= kStop_rad) {
        angle = kStop_rad;
        rate = std::max(rate, 0.0);
      }
    }
    const double seen = late ? angle_before : angle;
    angle_before = angle;
    const double l = links * length_m(seen);
    const LegView view{static_cast<float>(seen),
                       static_cast<float>(l),
                       static_cast<float>(links * lever_m(seen)),
                       static_cast<float>(links * length_m(kStop_rad)),
                       static_cast<float>(kInertia),
                       static_cast<float>(motor_nm),
                       static_cast<float>(kSpring * (kRest_m - l)),
                       late ? 700u : 0u};
    return observe_contact(config, state, view, static_cast<float>(kTick_s));
  }
};

}  // namespace

TEST_CASE("the force on the toe comes out with the observer's own lag, 4 ms, and right in the end") {
  Leg leg;
  leg.angle = 0.7;  // at rest there: the motor holds the spring
  const double hold_nm = lever_m(0.7) * spring_n(0.7);
  for (int i = 0; i < 50; ++i) CHECK(std::abs(leg.tick(hold_nm, 0.0).force_n) < 0.5f);
  // The ground pushes with 25 N, and the motor gives way by as much: the leg stays where it is.
  const double push_nm = 25.0 * lever_m(0.7);
  ContactEstimate seen;
  for (int i = 0; i < 4; ++i) seen = leg.tick(hold_nm - push_nm, 25.0);
  // Of a first-order lag, in steps of a quarter: 1 - 0.75^4.
  CHECK(seen.force_n == Approx(25.0 * (1.0 - std::pow(0.75, 4))).margin(0.4));
  for (int i = 0; i < 40; ++i) seen = leg.tick(hold_nm - push_nm, 25.0);
  CHECK(seen.force_n == Approx(25.0).margin(0.2));
  CHECK(seen.contact);
  for (int i = 0; i < 14; ++i) seen = leg.tick(hold_nm, 0.0);  // 25 * 0.75^14 is 0.45
  CHECK_FALSE(seen.contact);
}

TEST_CASE("a leg that swings in the air, driven or let go to its stop, is not on the ground") {
  const bool late = GENERATE(false, true);
  Leg leg;
  leg.late = late;
  bool contact = false;
  double most_n = 0.0;
  for (int i = 0; i < 100; ++i) contact = leg.tick(0.0, 0.0).contact || contact;  // pressed on its stop
  for (int i = 0; i < 400; ++i) {
    // Folded and let go again, with steps of the torque, as of a position loop on a bus.
    const double wave = std::sin(0.0314159 * i), step_nm = i / 4 % 2 == 0 ? 10.0 : 4.0;
    const ContactEstimate seen = leg.tick((i % 200) < 150 ? step_nm * wave * wave : 0.0, 0.0);
    contact = contact || seen.contact;
    most_n = std::max(most_n, static_cast<double>(std::abs(seen.force_n)));
  }
  CHECK(leg.rate == 0.0);
  // A step of 6 N m that is taken a tick too early would be 15 N.
  CHECK(most_n < 8.0);
  CHECK_FALSE(contact);
}

TEST_CASE(
    "a toe that meets the ground is seen on the next sample, however slow, and however long the links") {
  for (const double speed_mps : {0.3, 1.0, 2.0})
    for (const double links : {0.98, 1.0, 1.02}) {
      Leg leg;
      leg.links = links;
      for (int i = 0; i < 200; ++i) REQUIRE_FALSE(leg.tick(0.0, 0.0).contact);
      // The plastic impact: the leg folds with the body's speed, which the ground keeps up.
      leg.rate = speed_mps / lever_m(kStop_rad);
      int ticks = 0;
      for (bool contact = false; !contact && ticks < 50; ++ticks)
        contact = leg.tick(0.0, spring_n(leg.angle) + kDamping * speed_mps).contact;
      INFO(speed_mps << " m/s, links " << links);
      CHECK(ticks <= 2);
    }
}

TEST_CASE("what is not a number leaves nothing behind") {
  Leg leg;
  for (int i = 0; i < 10; ++i) leg.tick(0.0, 0.0);
  LegView lost;
  lost.angle_rad = lost.length_m = lost.lever_m = std::numeric_limits<float>::quiet_NaN();
  CHECK_FALSE(observe_contact(leg.config, leg.state, lost, 0.001f).contact);
  for (int i = 0; i < 10; ++i) CHECK(leg.tick(0.0, 0.0).force_n == 0.0f);
  leg.state.residual_nm = std::numeric_limits<float>::infinity();
  for (int i = 0; i < 10; ++i) CHECK(leg.tick(0.0, 0.0).force_n == 0.0f);
}

TEST_CASE(
    "the observer is trusted after two strides on which the switch agreed, and not after a long quarrel") {
  RedundantSensorState state;
  const auto ticks = [&](int count, bool observed, bool closed) {
    for (int i = 0; i < count; ++i) {
      note_observer(state, observed);
      compare_redundant_sensors(state, closed, 0.001f);
    }
  };
  ticks(10, false, false);
  for (int stride = 0; stride < 2; ++stride) {
    CHECK(state.agreements < kAgreementsLeast);
    ticks(10, true, false);  // the switch is 10 ms late
    ticks(140, true, true);
    ticks(10, false, true);
    ticks(200, false, false);
  }
  CHECK(state.agreements == kAgreementsLeast);
  ticks(124, true, false);  // a switch that is found to be lost is found in this time
  CHECK(state.agreements == kAgreementsLeast);
  ticks(10, true, false);
  CHECK(state.agreements == 0);
}
