// The blind suite's robots against closed forms: what hides the effects must itself be right.
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <vector>

#include "tests/hidden/trees/machine.hpp"

namespace furcula::hidden::trees {
namespace {

constexpr double kStep = 0.25e-3;

// A bar that turns about y at the base: mass and length as given, centre halfway down, and a joint at its end.
void add_bar(Robot& robot, double mass_kg, double length_m, double inertia_kgm2) {
  const int index = static_cast<int>(robot.size());
  Joint j;
  j.name = "j" + std::to_string(index + 1);
  j.parent = index - 1;
  j.axis = {0, 1, 0};
  if (index > 0) j.at = 2.0 * robot.bodies.back().centre_m;
  Body b;
  b.name = "link" + std::to_string(index + 1);
  b.joint = index;
  b.mass_kg = mass_kg;
  b.centre_m = {0, 0, -length_m / 2};
  b.moments = {inertia_kgm2, inertia_kgm2, inertia_kgm2 / 10};
  robot.joints.push_back(j);
  robot.bodies.push_back(b);
}

// About a vertical axis, so that gravity has no moment: one number of inertia.
Machine rotor(double inertia_kgm2, DriveData drive, const std::vector<Cause>& causes,
              bool position_control = false) {
  Robot robot;
  Joint j;
  j.name = "j1";
  robot.joints.push_back(j);
  Body b;
  b.name = "link1";
  b.moments = {inertia_kgm2, inertia_kgm2, inertia_kgm2};
  robot.bodies.push_back(b);
  return {robot, {drive}, position_control, causes};
}

State run(const Machine& m, State s, double duration_s, const Values& input) {
  m.run(s, 0.0, duration_s, kStep, input, Values{});
  return s;
}

}  // namespace

TEST_CASE("A double pendulum accelerates as Lagrange's equations say", "[trees]") {
  Robot robot;
  const double m1 = 1.3, m2 = 0.7, l1 = 0.4, l2 = 0.3, i1 = 0.02, i2 = 0.006;
  add_bar(robot, m1, l1, i1);
  add_bar(robot, m2, l2, i2);
  const Machine machine(robot, {{}, {}}, false, {});
  State s;
  s.q = {0.4, -1.1};
  s.v = {1.7, -2.3};
  const Values input{0.3, -0.2};

  const double c1 = l1 / 2, c2 = l2 / 2, g = kGravity_mps2, cosine = std::cos(s.q[1]);
  const double h = m2 * l1 * c2 * std::sin(s.q[1]);
  const double m22 = m2 * c2 * c2 + i2, m12 = m22 + m2 * l1 * c2 * cosine;
  const double m11 = m1 * c1 * c1 + i1 + m2 * (l1 * l1 + c2 * c2 + 2 * l1 * c2 * cosine) + i2;
  const double g2 = m2 * g * c2 * std::sin(s.q[0] + s.q[1]);
  const double g1 = (m1 * c1 + m2 * l1) * g * std::sin(s.q[0]) + g2;
  const double r1 = input[0] - g1 + h * (2 * s.v[0] * s.v[1] + s.v[1] * s.v[1]);
  const double r2 = input[1] - g2 - h * s.v[0] * s.v[0];
  const double det = m11 * m22 - m12 * m12;

  const Values a = machine.acceleration(s, 0.0, input, Values{});
  CHECK(a[0] == Approx((m22 * r1 - m12 * r2) / det).epsilon(1e-12));
  CHECK(a[1] == Approx((m11 * r2 - m12 * r1) / det).epsilon(1e-12));
}

TEST_CASE("Robots of all forms keep their energy where nothing takes any", "[trees]") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    Random random(seed);
    Robot robot = draw_robot(random, 2 + seed % 6);
    const std::vector<DriveData> drives(robot.size());
    const Machine machine(robot, drives, false, {});
    State s;
    for (std::size_t j = 0; j < robot.size(); ++j) {
      s.q[j] = random.uniform(-1, 1) * (robot.joints[j].prismatic ? 0.1 : 1.0);
      s.v[j] = random.uniform(-1, 1) * (robot.joints[j].prismatic ? 0.1 : 1.0);
    }
    const double before = machine.dynamics().energy_j(s.q, s.v);
    // Kinetic energy alone, as the size of what could be lost.
    const double size = before - machine.dynamics().energy_j(s.q, Values{}) + 0.1;
    s = run(machine, s, 0.3, Values{});
    INFO("seed " << seed << ", " << robot.form << " of " << robot.size());
    CHECK(std::fabs(machine.dynamics().energy_j(s.q, s.v) - before) < 1e-5 * size);
  }
}

TEST_CASE("Torques of motion are those of Lagrange's equations on the kinetic energy", "[trees]") {
  // d/dt (M v) - d/dq (v' M v / 2) at qdd = 0 by central differences. The energies are sums over bodies, not M.
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    Random random(seed);
    const Robot robot = draw_robot(random, 0);
    const std::size_t n = robot.size();
    const Dynamics d(robot, {});
    Values q{}, v{};
    for (std::size_t j = 0; j < n; ++j) {
      q[j] = random.uniform(-1, 1);
      v[j] = random.uniform(-2, 2);
    }
    constexpr double kBy = 1e-4;
    const auto momentum = [&](const Values& at, std::size_t j) {
      Values more = v, less = v;
      more[j] += 1.0;
      less[j] -= 1.0;
      return (d.energy_j(at, more) - d.energy_j(at, less)) / 2;
    };
    Values ahead = q, behind = q;
    for (std::size_t j = 0; j < n; ++j) {
      ahead[j] += kBy * v[j];
      behind[j] -= kBy * v[j];
    }
    const Values torque = d.torque(q, v, {});
    for (std::size_t j = 0; j < n; ++j) {
      Values more = q, less = q;
      more[j] += kBy;
      less[j] -= kBy;
      const double expected = (momentum(ahead, j) - momentum(behind, j)) / (2 * kBy) -
                              (d.energy_j(more, v) - d.energy_j(less, v)) / (2 * kBy);
      INFO("seed " << seed << ", " << robot.form << ", joint " << j);
      CHECK(torque[j] == Approx(expected).epsilon(1e-6).margin(1e-6));
    }
  }
}

TEST_CASE("The torque that holds a robot is the slope of its potential energy", "[trees]") {
  Random random(5);
  const Robot robot = draw_robot(random, 6);
  const Dynamics d(robot, {0.3, -0.5, -9.7});
  Values q{};
  for (std::size_t j = 0; j < robot.size(); ++j) q[j] = random.uniform(-1, 1);
  const Values hold = d.torque(q, Values{}, Values{});
  for (std::size_t j = 0; j < robot.size(); ++j) {
    Values more = q, less = q;
    more[j] += 1e-5;
    less[j] -= 1e-5;
    CHECK(hold[j] == Approx((d.energy_j(more, {}) - d.energy_j(less, {})) / 2e-5).margin(1e-7));
  }
}

TEST_CASE("A point mass at the end is a pendulum's inertia and weight", "[trees]") {
  Robot robot;
  add_bar(robot, 1.0, 0.4, 0.01);
  const Machine m(robot, {{}}, false, {{"payload", {"link1"}, {{"mass_kg", 0.5}, {"z_m", -0.4}}}});
  State s;
  s.q[0] = std::numbers::pi / 2;
  const double inertia = 0.01 + 0.04 + 0.5 * 0.16, moment = (0.2 + 0.5 * 0.4) * kGravity_mps2;
  CHECK(m.acceleration(s, 0, {}, {})[0] == Approx(-moment / inertia).epsilon(1e-12));
}

TEST_CASE("A mass keeps its centre and takes its inertia along", "[trees]") {
  Robot robot;
  add_bar(robot, 1.0, 0.4, 0.01);
  const Machine m(robot, {{}}, false, {{"mass_error", {"link1"}, {{"mass_kg", 1.5}}}});
  const Values torque = m.dynamics().torque({}, {}, {2.0});
  CHECK(torque[0] == Approx(2.0 * 1.5 * (0.01 + 0.04)).epsilon(1e-12));
}

TEST_CASE("A tilted base turns gravity", "[trees]") {
  Robot robot;
  add_bar(robot, 1.0, 0.4, 0.01);
  const Machine m(robot, {{}}, false, {{"base_tilt", {"base"}, {{"roll_rad", 0.0}, {"pitch_rad", 0.2}}}});
  State s;
  // A pendulum hangs plumb: turned back by the pitch.
  s.q[0] = -0.2;
  CHECK(m.acceleration(s, 0, {}, {})[0] == Approx(0.0).margin(1e-12));
}

TEST_CASE("Dry friction stops a rotor where its energy is used up, and holds it there", "[trees]") {
  const Machine m = rotor(0.02, {}, {{"coulomb_friction", {"j1"}, {{"torque_nm", 0.5}}}});
  State s;
  s.v[0] = 3.0;
  s = run(m, s, 0.5, {});
  CHECK(s.q[0] == Approx(0.02 * 9.0 / (2 * 0.5)).epsilon(1e-6));
  CHECK(s.v[0] == 0.0);
  const double rest = s.q[0];
  s = run(m, s, 0.2, {0.499});
  CHECK(s.q[0] == rest);
  s = run(m, s, 0.1, {0.6});
  CHECK(s.v[0] == Approx(0.1 / 0.02 * 0.1).epsilon(1e-6));
}

TEST_CASE("Each half swing in dry friction is shorter by twice friction over stiffness", "[trees]") {
  const double inertia = 0.05, spring = 20.0, friction = 0.2;
  const Machine m = rotor(inertia, {.kp_nmprad = spring, .friction_nm = friction}, {}, true);
  State s;
  s.q[0] = 0.3;
  s = run(m, s, 5 * std::numbers::pi * std::sqrt(inertia / spring), {});
  CHECK(s.q[0] == Approx(-(0.3 - 5 * 2 * friction / spring)).epsilon(1e-7));
}

TEST_CASE("Dry friction holds a double pendulum as long as each joint's torque is below it", "[trees]") {
  Robot robot;
  add_bar(robot, 1.0, 0.4, 0.01);
  add_bar(robot, 0.5, 0.3, 0.004);
  const double g = kGravity_mps2;
  State s;
  s.q = {std::numbers::pi / 2, 0.0};
  // Both bars level: the moments about the joints.
  const double at2 = 0.5 * g * 0.15, at1 = 1.0 * g * 0.2 + 0.5 * g * 0.55;
  const auto with = [&](double f1, double f2) {
    return Machine(robot, {{}, {}}, false,
                   {{"coulomb_friction", {"j1"}, {{"torque_nm", f1}}},
                    {"coulomb_friction", {"j2"}, {{"torque_nm", f2}}}});
  };
  const State held = run(with(1.001 * at1, 1.001 * at2), s, 0.1, {});
  CHECK(held.q[0] == s.q[0]);
  CHECK(held.q[1] == s.q[1]);
  const State second = run(with(2 * at1, 0.5 * at2), s, 0.05, {});
  CHECK(second.q[0] == s.q[0]);
  CHECK(second.v[1] < -0.1);
  const State first = run(with(0.9 * at1, 3 * at2), s, 0.05, {});
  CHECK(first.q[1] == s.q[1]);
  CHECK(first.v[0] < -0.01);
}

TEST_CASE("Beside its binding spot a joint at rest is free both ways, and a passage takes torque times width",
          "[trees]") {
  const double inertia = 0.05, torque = 0.4, width = 0.2;
  const Machine m =
      rotor(inertia, {},
            {{"binding_spot", {"j1"}, {{"torque_nm", torque}, {"centre_rad", 1}, {"width_rad", width}}}});
  for (const double input : {-0.2, 0.2}) {
    const State s = run(m, {}, 0.1, {input});
    CHECK(s.v[0] == Approx(input / inertia * 0.1).epsilon(1e-9));
    CHECK(s.q[0] == Approx(input / inertia * 0.005).epsilon(1e-9));
  }
  State s;
  s.v[0] = 4.0;
  s = run(m, s, 0.5, {});
  REQUIRE(s.q[0] > 1 + width / 2);
  // The spot's edges are met to a step: 1 mrad of travel each.
  CHECK(inertia / 2 * (16.0 - s.v[0] * s.v[0]) == Approx(torque * width).margin(torque * 0.001));
  s = {};
  s.q[0] = 1.0;
  CHECK(run(m, s, 0.1, {-0.39}).q[0] == 1.0);
}

TEST_CASE("Stribeck friction breaks free at its static torque and falls to that of motion", "[trees]") {
  const Machine m = rotor(0.01, {},
                          {{"stribeck_friction",
                            {"j1"},
                            {{"torque_nm", 0.2}, {"static_torque_nm", 0.5}, {"velocity_radps", 0.3}}}});
  CHECK(run(m, {}, 0.1, {0.49}).q[0] == 0.0);
  CHECK(run(m, {}, 0.1, {0.51}).q[0] > 0.0);
  State s;
  s.v[0] = 0.3;
  CHECK(m.acceleration(s, 0, {}, {})[0] == Approx(-(0.2 + 0.3 * std::exp(-1.0)) / 0.01));
  s.v[0] = -5.0;
  CHECK(m.acceleration(s, 0, {}, {})[0] == Approx(0.2 / 0.01));
}

TEST_CASE("Laws of a joint give the accelerations that their formulas say", "[trees]") {
  const double inertia = 0.05;
  const auto accelerates = [&](const Cause& cause, double q, double v, double input) {
    State s;
    s.q[0] = q;
    s.v[0] = v;
    return rotor(inertia, {.damping_nmspr = 0.1}, {cause}).acceleration(s, 0, {input}, {})[0] * inertia;
  };
  const double v = 2.0, damped = -0.1 * v;
  CHECK(accelerates({"asymmetric_friction", {"j1"}, {{"torque_up_nm", 0.3}, {"torque_down_nm", 0.1}}}, 0, v,
                    0) == Approx(damped - 0.3));
  CHECK(accelerates({"asymmetric_friction", {"j1"}, {{"torque_up_nm", 0.3}, {"torque_down_nm", 0.1}}}, 0, -v,
                    0) == Approx(-damped + 0.1));
  CHECK(accelerates({"damping_error", {"j1"}, {{"damping_nmspr", 0.4}}}, 0, v, 0) == Approx(-0.8));
  CHECK(accelerates({"quadratic_drag", {"j1"}, {{"drag_nms2prad2", 0.2}}}, 0, -v, 0) ==
        Approx(-damped + 0.2 * v * v));
  const Cause spot{"binding_spot", {"j1"}, {{"torque_nm", 0.6}, {"centre_rad", 0.5}, {"width_rad", 0.2}}};
  CHECK(accelerates(spot, 0.59, v, 0) == Approx(damped - 0.6));
  CHECK(accelerates(spot, 0.61, v, 0) == Approx(damped));
  CHECK(accelerates({"load_friction", {"j1"}, {{"ratio", 0.1}}}, 0, v, -3) == Approx(damped - 3 - 0.3));
  CHECK(accelerates({"force_offset", {"j1"}, {{"torque_nm", -0.7}}}, 0, v, 1) == Approx(damped + 1 - 0.7));
  CHECK(accelerates({"rotor_inertia_error", {"j1"}, {{"inertia_kgm2", 0.05}}}, 0, v, 1) ==
        Approx((damped + 1) / 2));
  CHECK(accelerates({"torque_gain_error", {"j1"}, {{"gain", 0.8}}}, 0, v, 2) == Approx(damped + 1.6));
  CHECK(accelerates({"torque_saturation", {"j1"}, {{"limit_nm", 1.5}}}, 0, v, -2) == Approx(damped - 1.5));
  CHECK(accelerates(
            {"torque_ripple", {"j1"}, {{"amplitude_nm", 0.3}, {"cycles_per_rev", 6}, {"phase_rad", 0.4}}},
            0.7, v, 0) == Approx(damped + 0.3 * std::sin(6 * 0.7 + 0.4)));
}

TEST_CASE("Causes outside of the catalogue give the accelerations that their formulas say", "[trees]") {
  Robot robot;
  add_bar(robot, 1.0, 0.4, 0.01);
  add_bar(robot, 0.5, 0.3, 0.004);
  // Torque on the first joint, from the accelerations with the cause and without.
  const auto adds = [&](const Cause& cause, double t, const Values& input) {
    State s;
    s.q = {0.3, 0.5};
    s.v = {1.0, -1.0};
    const std::vector<DriveData> drives(2);
    const Machine with(robot, drives, false, {cause}), without(robot, drives, false, {});
    const Values a = with.acceleration(s, t, input, {}), b = without.acceleration(s, t, input, {});
    const Values ta = with.dynamics().torque(s.q, s.v, a), tb = with.dynamics().torque(s.q, s.v, b);
    CHECK(ta[1] == Approx(tb[1]).margin(1e-12));
    return ta[0] - tb[0];
  };
  CHECK(adds({"cable_spring", {"j1"}, {{"stiffness_nmprad3", 4}, {"centre_rad", 0.1}}}, 0, {}) ==
        Approx(-4 * 0.008));
  CHECK(adds({"growing_friction", {"j1"}, {{"growth_nmps", 0.1}}}, 3.0, {}) == Approx(-0.3));
  CHECK(adds({"coupled_friction", {"j1"}, {{"torque_nm", 0.2}, {"other", 1}}}, 0, {}) ==
        Approx(-0.2 * (1 + std::sin(1.5))));
  CHECK(adds({"torque_crosstalk", {"j1"}, {{"share", 0.3}, {"talker", 1}}}, 0, {0, 2}) == Approx(0.6));
  CHECK(adds({"periodic_torque", {"j1"}, {{"torque_nm", 0.5}, {"frequency_hz", 2}}}, 1.0 / 8, {}) ==
        Approx(0.5));
}

TEST_CASE("A lag follows a step exponentially", "[trees]") {
  const Machine m = rotor(0.1, {}, {{"actuator_lag", {"j1"}, {{"time_constant_s", 0.02}}}});
  State s;
  s = run(m, s, 0.05, {2.0});
  const double x = 0.05 / 0.02;
  CHECK(s.lag[0] == Approx(2.0 * (1 - std::exp(-x))).epsilon(1e-8));
  CHECK(s.v[0] == Approx(2.0 / 0.1 * (0.05 - 0.02 * (1 - std::exp(-x)))).epsilon(1e-8));
}

TEST_CASE("An elastic joint swings at the frequency of two inertias on a spring", "[trees]") {
  const double link = 0.05, motor = 0.02, spring = 40.0;
  const Machine m =
      rotor(link, {.rotor_kgm2 = motor}, {{"joint_elasticity", {"j1"}, {{"stiffness_nmprad", spring}}}});
  State s;
  s.rotor[0] = 0.1;
  // Half a period on, the deflection has changed sign.
  const double w = std::sqrt(spring * (1 / link + 1 / motor));
  s = run(m, s, std::numbers::pi / w, {});
  CHECK(s.rotor[0] - s.q[0] == Approx(-0.1).epsilon(1e-6));
  CHECK(link * s.q[0] + motor * s.rotor[0] == Approx(motor * 0.1).epsilon(1e-9));
}

TEST_CASE("A drive in its position law comes to where its encoder reads the set point", "[trees]") {
  const Machine m = rotor(0.05, {.kp_nmprad = 20, .kd_nmsprad = 2},
                          {{"encoder_offset", {"j1"}, {{"offset_rad", 0.05}}}}, true);
  State s;
  m.settle(s, {0.3});
  s = run(m, s, 2.0, {0.3});
  CHECK(s.q[0] == Approx(0.25).margin(1e-6));
}

TEST_CASE("A resonator takes its mass from the link and swings on its spring", "[trees]") {
  Robot robot;
  add_bar(robot, 1.0, 0.4, 0.01);
  const Machine m(robot, {{}}, false,
                  {{"resonator",
                    {"link1"},
                    {{"mass_kg", 0.2},
                     {"x_m", 0},
                     {"y_m", 0},
                     {"z_m", -0.2},
                     {"axis_x", 0},
                     {"axis_y", 1},
                     {"axis_z", 0},
                     {"stiffness_npm", 50},
                     {"damping_nspm", 0}}}});
  REQUIRE(m.size() == 2);
  State s;
  s.q[1] = 0.01;  // along the axis that the link turns about: no coupling
  s = run(m, s, std::numbers::pi / std::sqrt(50 / 0.2), {});
  CHECK(s.q[1] == Approx(-0.01).epsilon(1e-6));
  CHECK(m.dynamics().torque({}, {}, {1.0})[0] == Approx(0.01 + 0.04).margin(1e-6));
}

TEST_CASE("What no machine has is refused", "[trees]") {
  CHECK_THROWS(rotor(0.1, {}, {{"coulomb_friction", {"j2"}, {{"torque_nm", 1}}}}));
  CHECK_THROWS(rotor(0.1, {}, {{"coulomb_friction", {"j1"}, {}}}));
  CHECK_THROWS(rotor(0.1, {}, {{"gremlin", {"j1"}, {}}}));
}

}  // namespace furcula::hidden::trees
