// The non-linear hopper against the Lagrangian of its links, energy, momentum, the linear model as its limit,
// and an independent integration of the printed equations.
#include "furcula/dynamics/nonlinear_hopper.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "furcula/dynamics/hopper.hpp"

using furcula::dynamics::ContactEvent;
using furcula::dynamics::Hopper;
using furcula::dynamics::HopperLinearParameters;
using furcula::dynamics::HopperNonlinearParameters;
using furcula::dynamics::Links;
using furcula::dynamics::NonlinearHopper;
using Parameters = HopperNonlinearParameters<double>;
using Event = ContactEvent<double>;

namespace {

constexpr double kLinkLength = 0.15, kGravity = 9.81;

/// One of the four links: mass, inertia about its own centre, way of that centre from the joint at its top.
struct Link {
  double mass, inertia, centre;
};
struct Leg {
  Link upper[2], lower[2];
  double rest_of_mass;  ///< of the body

  double mass() const { return rest_of_mass + upper[0].mass + upper[1].mass + lower[0].mass + lower[1].mass; }
};

/// Section 3.2.2 of document 002: lower links of 50 g, upper links of 500 g and 300 g.
const Leg kLeg{{{0.5, 9e-4, 0.03}, {0.3, 9e-4, 0.02}}, {{0.05, 1e-4, 0.075}, {0.05, 1e-4, 0.075}}, 0.7};

/// Kinetic less potential energy, from where each link's centre is and how it moves: no lumped parameter.
double lagrangian(const Leg& leg, double angle, double height, double rate, double velocity, double stiffness,
                  double rest_height) {
  double kinetic = 0.5 * leg.rest_of_mass * velocity * velocity;
  double potential = leg.rest_of_mass * kGravity * height;
  for (int side = 0; side < 2; ++side) {
    const double out = side == 0 ? 1.0 : -1.0;
    const auto add = [&](const Link& link, double vx, double vz, double z) {
      kinetic += 0.5 * link.mass * (vx * vx + vz * vz) + 0.5 * link.inertia * rate * rate;
      potential += link.mass * kGravity * z;
    };
    const Link& u = leg.upper[side];  // from the hip outwards and down
    add(u, out * u.centre * std::cos(angle) * rate, velocity + u.centre * std::sin(angle) * rate,
        height - u.centre * std::cos(angle));
    const Link& l = leg.lower[side];  // from the knee inwards and down
    add(l, out * (kLinkLength - l.centre) * std::cos(angle) * rate,
        velocity + (kLinkLength + l.centre) * std::sin(angle) * rate,
        height - (kLinkLength + l.centre) * std::cos(angle));
  }
  const double length = 2.0 * kLinkLength * std::cos(angle);
  potential += 0.5 * stiffness * (length - rest_height) * (length - rest_height);
  return kinetic - potential;
}

/// a, b, e of the links, by the sums of docs/physics.md.
std::array<double, 3> lumped(const Leg& leg) {
  double a = 0.0, b = 0.0, e = 0.0;
  for (const Link& u : leg.upper) {
    a += u.inertia + u.mass * u.centre * u.centre;
    e += u.mass * u.centre;
  }
  for (const Link& l : leg.lower) {
    a += l.inertia + l.mass * (l.centre * l.centre + kLinkLength * kLinkLength);
    b += l.mass * l.centre;
    e += l.mass * (l.centre + kLinkLength);
  }
  return {a, b, e};
}

Parameters machine(const Leg& leg = kLeg) {
  const auto [a, b, e] = lumped(leg);
  Parameters p;
  p.mass_kg = leg.mass();
  p.stiffness_npm = 600.0;
  p.link_length_m = kLinkLength;
  p.touchdown_angle_rad = 20.0 * std::numbers::pi / 180.0;
  p.rest_height_m = 2.0 * kLinkLength * std::cos(p.touchdown_angle_rad);
  p.damping_stance_nspm = 5.0;
  p.damping_flight_nspm = 1.0;
  p.restitution_touchdown = p.restitution_liftoff = 1.0;
  p.gravity_mps2 = kGravity;
  p.inertia_a_kgm2 = a;
  p.inertia_b_kgm = b;
  p.inertia_e_kgm = e;
  return p;
}

/// The torque of a hop: a harmonic in stance, restarted at touch-down.
class Harmonic {
 public:
  Harmonic(double amplitude_nm, double period_s) : amplitude_(amplitude_nm), period_(period_s) {}
  double at(double t, bool stance) const {
    return stance ? amplitude_ * std::sin(2.0 * std::numbers::pi * (t + 5e-4 - start_) / period_) : 0.0;
  }
  template <class Plant>
  void follow(const Plant& plant, double t) {
    for (const Event& e : plant.events())
      if (e.kind == Event::Kind::touchdown) start_ = t + e.offset_s;
  }

 private:
  double amplitude_, period_, start_ = 0.0;
};

}  // namespace

TEST_CASE("Document 002's links give its b and e, its a is less than its own figures add up to") {
  // The links' centres are not printed; b = 75e-4 puts the lower ones at their middle, and then
  // e = 38e-3 leaves 0.01175 kg m for the upper ones.
  const double upper = (38e-3 - 0.1 * (0.075 + 0.15)) / 0.8;
  const auto [a, b, e] =
      lumped({{{0.5, 9e-4, upper}, {0.3, 9e-4, upper}}, {{0.05, 1e-4, 0.075}, {0.05, 1e-4, 0.075}}, 0.7});
  CHECK(b == Approx(75e-4).epsilon(1e-12));
  CHECK(e == Approx(38e-3).epsilon(1e-12));
  CHECK(a > 1.15 * 42e-4);  // with both upper centres on the hip it is still 48e-4
}

TEST_CASE("Free in flight, the leg follows the Euler-Lagrange equations of its four links") {
  auto p = machine();
  p.damping_stance_nspm = p.damping_flight_nspm = 0.0;
  const auto lagrange = [&](double q1, double q2, double v1, double v2) {
    return lagrangian(kLeg, q1, q2, v1, v2, p.stiffness_npm, p.rest_height_m);
  };
  // A leg thrown up and folded by the motor, sampled while it folds and while it comes back.
  NonlinearHopper<double> plant(p);
  plant.reset(2.0, 1.0);
  for (int n = 0; n < 40; ++n) plant.advance(0.8, 1e-3);
  REQUIRE(plant.mode() == NonlinearHopper<double>::Mode::swings);
  for (int sample = 0; sample < 8; ++sample) {
    const double torque = 0.8 - 0.1 * sample;
    plant.advance(torque, 7e-3);
    REQUIRE(plant.mode() == NonlinearHopper<double>::Mode::swings);
    // Accelerations by central differences of the plant's own motion.
    const double h = 1e-4;
    NonlinearHopper<double> later = plant;
    later.advance(torque, h);
    const double q1 = later.leg_angle_rad(), q2 = later.height_m();
    const double v1 = later.leg_rate_radps(), v2 = later.velocity_mps();
    const double r0 = plant.leg_rate_radps(), w0 = plant.velocity_mps();
    later.advance(torque, h);
    const double a1 = (later.leg_rate_radps() - r0) / (2 * h), a2 = (later.velocity_mps() - w0) / (2 * h);
    // d/dt dL/dq' - dL/dq, by differences of the Lagrangian.
    const double s = 1e-4;
    const auto momentum = [&](int i, double x1, double x2, double y1, double y2) {
      return i == 0 ? (lagrange(x1, x2, y1 + s, y2) - lagrange(x1, x2, y1 - s, y2)) / (2 * s)
                    : (lagrange(x1, x2, y1, y2 + s) - lagrange(x1, x2, y1, y2 - s)) / (2 * s);
    };
    std::array<double, 2> left{};
    for (int i = 0; i < 2; ++i) {
      const double change = (momentum(i, q1 + s * v1, q2 + s * v2, v1 + s * a1, v2 + s * a2) -
                             momentum(i, q1 - s * v1, q2 - s * v2, v1 - s * a1, v2 - s * a2)) /
                            (2 * s);
      const double slope = i == 0 ? (lagrange(q1 + s, q2, v1, v2) - lagrange(q1 - s, q2, v1, v2)) / (2 * s)
                                  : (lagrange(q1, q2 + s, v1, v2) - lagrange(q1, q2 - s, v1, v2)) / (2 * s);
      left[static_cast<std::size_t>(i)] = change - slope;
    }
    CAPTURE(sample, q1, v1);
    CHECK(std::abs(left[0] - torque) < 1e-4);  // N m
    CHECK(std::abs(left[1]) < 1e-3);           // N
  }
}

TEST_CASE("In stance the motion is that of the Lagrangian held to the ground") {
  auto p = machine();
  p.damping_stance_nspm = p.damping_flight_nspm = 0.0;
  // With z = 2 L cos theta one coordinate is left; its own Lagrangian, differentiated numerically.
  const auto lagrange = [&](double angle, double rate) {
    return lagrangian(kLeg, angle, 2 * kLinkLength * std::cos(angle), rate,
                      -2 * kLinkLength * std::sin(angle) * rate, p.stiffness_npm, p.rest_height_m);
  };
  NonlinearHopper<double> plant(p);
  plant.reset(0.25, -1.2);
  for (int sample = 0; sample < 10; ++sample) {
    const double torque = -0.5 + 0.2 * sample, h = 1e-4, s = 1e-4;
    plant.advance(torque, 6e-3);
    REQUIRE(plant.in_stance());
    NonlinearHopper<double> later = plant;
    later.advance(torque, h);
    const double q = later.leg_angle_rad(), v = later.leg_rate_radps(), force = later.ground_force_n();
    const double before = plant.leg_rate_radps(), sank = plant.velocity_mps();
    later.advance(torque, h);
    const double a = (later.leg_rate_radps() - before) / (2 * h);
    const double up = (later.velocity_mps() - sank) / (2 * h);
    const auto momentum = [&](double x, double y) {
      return (lagrange(x, y + s) - lagrange(x, y - s)) / (2 * s);
    };
    const double change = (momentum(q + s * v, v + s * a) - momentum(q - s * v, v - s * a)) / (2 * s);
    const double slope = (lagrange(q + s, v) - lagrange(q - s, v)) / (2 * s);
    CAPTURE(sample, q, v);
    CHECK(std::abs(change - slope - torque) < 1e-4);
    // Newton for all of the machine: the ground carries its weight and what its centre of mass accelerates.
    const double e = p.inertia_e_kgm;
    CHECK(force ==
          Approx(p.mass_kg * (up + kGravity) + e * (std::sin(q) * a + std::cos(q) * v * v)).epsilon(1e-5));
  }
}

TEST_CASE("The motor cannot lift the machine in flight: its centre of mass falls freely") {
  auto p = machine();
  p.damping_stance_nspm = 8.0;
  p.damping_flight_nspm = 0.0;
  NonlinearHopper<double> plant(p);
  plant.reset(3.0, 0.7);
  const auto centre = [&] {
    return plant.height_m() - p.inertia_e_kgm / p.mass_kg * std::cos(plant.leg_angle_rad());
  };
  const double start = centre();
  int met_stop = 0;
  for (int n = 1; n <= 600; ++n) {
    const auto before = plant.mode();
    plant.advance(1.5 * std::sin(0.05 * n), 1e-3);
    met_stop += before == NonlinearHopper<double>::Mode::swings &&
                plant.mode() == NonlinearHopper<double>::Mode::on_stop;
    const double t = 1e-3 * n;
    CHECK(centre() == Approx(start + 0.7 * t - 0.5 * kGravity * t * t).margin(2e-9));
  }
  CHECK(met_stop >= 3);  // the stop and the leg exchange momentum inside the machine alone
}

TEST_CASE("What the motor gives less what is lost is what the machine holds, over 1,000 hops") {
  auto p = machine();
  p.restitution_liftoff = 0.98;
  p.restitution_touchdown = 0.99;
  NonlinearHopper<double> plant(p);
  plant.reset(0.35, 0.0);
  const double start = plant.energy().held();
  Harmonic torque(3.0, 0.3);
  int touchdowns = 0;
  for (int n = 0; touchdowns < 1000; ++n) {
    REQUIRE(n < 1000000);
    const double t = 1e-3 * n;
    // In flight the leg is folded and let go, so that every mode has its share.
    const double swing = plant.in_stance() ? 0.0 : 0.6 * std::sin(2.0 * std::numbers::pi * t / 0.17);
    plant.advance(torque.at(t, plant.in_stance()) + swing, 1e-3);
    torque.follow(plant, t);
    for (const Event& e : plant.events()) touchdowns += e.kind == Event::Kind::touchdown;
  }
  const auto energy = plant.energy();
  CHECK(std::abs(energy.held() - start - energy.motor + energy.lost()) < 1e-9 * energy.motor);
  for (const double lost :
       {energy.guide_damping, energy.leg_damping, energy.touchdown, energy.stop, energy.liftoff})
    CHECK(lost > 0.0);
}

TEST_CASE("Impacts are plastic: the toe stops, and what changes the momentum acts at the toe alone") {
  const auto p = machine();
  const Links<double> links{p.inertia_a_kgm2, p.inertia_b_kgm, p.inertia_e_kgm, kLinkLength, p.mass_kg};
  for (const double angle : {0.36, 0.7, 1.0})
    for (const double rate : {-3.0, 0.0, 4.0}) {
      const double velocity = -1.1;
      const auto pose = links.pose(angle);
      const double after = links.rate_after_touchdown(pose, rate, velocity);
      const double velocity_after = -pose.lever * after;  // the toe rests
      // M (q'+ - q'-) must be a multiple of J^T = [lever, 1].
      const double on_angle =
          pose.inertia.angle * (after - rate) + pose.inertia.coupling * (velocity_after - velocity);
      const double on_height =
          pose.inertia.coupling * (after - rate) + pose.inertia.height * (velocity_after - velocity);
      CHECK(on_angle == Approx(pose.lever * on_height).margin(1e-12));
      CHECK(links.kinetic_energy(pose, after, velocity_after) <=
            links.kinetic_energy(pose, rate, velocity) + 1e-12);
      // The stop changes the angle's momentum alone.
      const double stopped = links.velocity_after_stop(pose, rate, velocity);
      CHECK(pose.inertia.height * stopped ==
            Approx(pose.inertia.coupling * rate + pose.inertia.height * velocity).margin(1e-12));
    }
}

TEST_CASE("A pose turned on is the pose of the angle that it comes to") {
  const auto p = machine();
  const Links<double> links{p.inertia_a_kgm2, p.inertia_b_kgm, p.inertia_e_kgm, kLinkLength, p.mass_kg};
  for (const double angle : {0.01, 0.35, 1.2})
    for (const double by : {0.0, 1e-9, -0.003, 0.0499, -0.0499, 0.0501, -0.3, 2.0}) {
      CAPTURE(angle, by);
      const auto turned = links.turned(links.pose(angle), by), pose = links.pose(angle + by);
      CHECK(turned.sine == Approx(pose.sine).margin(4e-16).epsilon(0));
      CHECK(turned.cosine == Approx(pose.cosine).margin(4e-16).epsilon(0));
      CHECK(turned.length == Approx(pose.length).margin(4e-16).epsilon(0));
      CHECK(turned.inertia.angle == Approx(pose.inertia.angle).margin(4e-16).epsilon(0));
    }
}

TEST_CASE("With links that weigh nothing the hops are the linear model's") {
  auto p = machine();
  HopperLinearParameters<double> linear = p;
  linear.rest_height_m = p.rest_height_m = 0.298;  // so that the leg pushes all the way down
  Hopper<double> expected(linear);
  const auto apart = [&](double share) {
    Parameters light = p;
    // A thousandth of a gram of links: their own swing in flight is faster than a step, so the spring holds
    // the leg on its stop.
    light.inertia_a_kgm2 = share * p.inertia_a_kgm2;
    light.inertia_b_kgm = share * p.inertia_b_kgm;
    light.inertia_e_kgm = share * p.inertia_e_kgm;
    NonlinearHopper<double> plant(light);
    Hopper<double> reference = expected;
    plant.reset(0.34, 0.0);
    reference.reset(0.34, 0.0);
    double most = 0.0;
    for (int n = 0; n < 4000; ++n) {
      const double torque =
          std::sin(2.0 * std::numbers::pi * n * 1e-3 / 0.3) * (reference.in_stance() ? 2.0 : 0.0);
      plant.advance(torque, 1e-3 / 4);
      reference.advance(torque, 1e-3 / 4);
      most = std::max(most, std::abs(plant.height_m() - reference.height_m()));
    }
    return most;
  };
  const double tenth = apart(0.01), hundredth = apart(0.001);
  CAPTURE(tenth, hundredth);
  CHECK(hundredth < 1e-4);
  CHECK(tenth / hundredth == Approx(10.0).epsilon(0.35));  // goes to zero with the links, in proportion
}

TEST_CASE("Contacts do not chatter, whatever the links weigh: at most a bounce of the toe a hop") {
  for (const double lower : {1e-4, 0.003, 0.05, 0.3})
    for (const double upper : {1e-3, 0.05, 0.4})
      for (const double drop : {0.005, 0.05, 0.2}) {
        Leg leg = kLeg;
        for (Link& l : leg.lower) l = {lower, lower * 2e-3, 0.075};
        for (Link& u : leg.upper) u = {upper, upper * 2e-3, 0.05};
        leg.rest_of_mass = 1.0;
        auto p = machine(leg);
        NonlinearHopper<double> plant(p);
        plant.reset(p.rest_height_m + drop, 0.0);
        int touchdowns = 0, liftoffs = 0;
        for (int n = 0; n < 600; ++n) {
          plant.advance(0.0, 1e-3);
          for (const Event& e : plant.events())
            (e.kind == Event::Kind::touchdown ? touchdowns : liftoffs) += 1;
          REQUIRE(std::isfinite(plant.height_m()));
          REQUIRE(plant.toe_height_m() > -1e-9);
          REQUIRE(plant.leg_angle_rad() >= p.touchdown_angle_rad - 1e-9);
        }
        CAPTURE(lower, upper, drop, touchdowns, liftoffs);
        CHECK(touchdowns >= 1);
        CHECK(std::abs(touchdowns - liftoffs) <= 1);
        CHECK(touchdowns <= 8);  // 0.6 s: a hop takes no less than the spring's half period of 0.15 s
      }
}

TEST_CASE(
    "While the spring holds the leg on its stop in flight, the quick hopper hops like the constrained one") {
  auto p = machine();
  p.rest_height_m = 0.298;
  p.restitution_touchdown = 0.97;
  p.restitution_liftoff = 0.99;
  for (const int parts : {1, 4}) {
    Hopper<double> quick(p);
    NonlinearHopper<double> plant(p);
    quick.reset(0.34, 0.0);
    plant.reset(0.34, 0.0);
    Harmonic torque(3.0, 0.3);
    double most = 0.0;
    int events = 0;
    for (int n = 0; n < 1500 * parts; ++n) {
      const double t = 1e-3 * n / parts, command = torque.at(t, plant.in_stance());
      quick.advance(command, 1e-3 / parts);
      plant.advance(command, 1e-3 / parts);
      torque.follow(plant, t);
      events += static_cast<int>(plant.events().size());
      most = std::max(most, std::abs(quick.height_m() - plant.height_m()));
    }
    CAPTURE(parts, most);
    CHECK(events >= 7);
    CHECK(most < (parts == 1 ? 3e-5 : 1e-5));
  }
}

TEST_CASE(
    "The loss at lift-off is taken once a stance, also where the ground lets go before the leg is straight") {
  for (const double kept : {0.99, 0.95, 0.9}) {
    auto p = machine();
    p.mass_kg += 1.0;
    p.restitution_liftoff = kept;
    NonlinearHopper<double> plant(p);
    Hopper<double> quick(p);
    plant.reset(0.42, 0.0);
    quick.reset(0.42, 0.0);
    int liftoffs = 0;  // of the body: under one that sinks the toe may bounce
    double apex = 0.0, quick_apex = 0.0;
    for (int n = 0; n < 600; ++n) {  // one hop
      plant.advance(0.0, 1e-3);
      quick.advance(0.0, 1e-3);
      for (const Event& e : plant.events())
        liftoffs += e.kind == Event::Kind::liftoff && e.velocity_before_mps > 0.0;
      if (n > 350 && !plant.in_stance()) apex = std::max(apex, plant.height_m());
      if (n > 350 && !quick.in_stance()) quick_apex = std::max(quick_apex, quick.height_m());
    }
    CAPTURE(kept, apex, quick_apex);
    CHECK(liftoffs == 1);
    CHECK(apex > 0.3);
    CHECK(apex == Approx(quick_apex).margin(2e-3));  // the quick one's leg is straight at once
  }
}

TEST_CASE("A motor that presses the leg straight lets the robot come to stand on its stop") {
  const auto p = machine();
  NonlinearHopper<double> plant(p);
  plant.reset(0.35, 0.0);
  const double start = plant.energy().held();
  int late_events = 0;
  for (int n = 0; n < 5000; ++n) {
    plant.advance(-3.0, 1e-3);
    if (n > 3000) late_events += static_cast<int>(plant.events().size());
  }
  CHECK(plant.mode() == NonlinearHopper<double>::Mode::stands);
  CHECK(plant.in_stance());
  CHECK(late_events == 0);
  CHECK(plant.velocity_mps() == 0.0);
  CHECK(plant.ground_force_n() == Approx(p.mass_kg * kGravity));
  const auto energy = plant.energy();
  CHECK(std::abs(energy.held() - start - energy.motor + energy.lost()) < 1e-9);
  for (int n = 0; n < 100; ++n) plant.advance(3.0, 1e-3);
  CHECK(plant.leg_angle_rad() > p.touchdown_angle_rad + 0.05);  // and folds when it is let go
}

TEST_CASE("What a new torque does at once is an event at the start of the step") {
  NonlinearHopper<double> plant(machine());
  plant.reset(0.26, 0.3);
  plant.advance(0.0, 1e-3);
  REQUIRE(plant.in_stance());
  plant.advance(8.0, 1e-4);  // pulls the toe off the ground
  REQUIRE(plant.events().size() >= 1);
  CHECK(plant.events()[0].offset_s == 0.0);
}
