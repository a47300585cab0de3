// The blind suite's leg against the equations of its design, closed forms and balances of energy and momentum.
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

#include "tests/hidden/trees/machine.hpp"

namespace furcula::hidden::trees {
namespace {

constexpr double kStep = 0.25e-3;
constexpr double g = kGravity_mps2;

Robot leg_of(std::uint64_t seed, bool switched = true) {
  Random random(seed);
  Robot robot = draw_monopod(random);
  robot.leg->switched = switched;
  return robot;
}

Machine machine_of(const Robot& robot, const std::vector<Cause>& causes = {}) {
  return {robot, std::vector<DriveData>(4), false, causes};
}

// Masses and lengths by the letters of the leg's design, section 4.3.
struct Letters {
  double mb, m, l1, l2, a, b, c, ik, i0;
};

Letters letters_of(const Robot& r) {
  const double m1 = r.bodies[2].mass_kg, m2 = r.bodies[3].mass_kg, l1 = -r.bodies[2].centre_m.z,
               l2 = -r.bodies[3].centre_m.z;
  const double long1 = -r.joints[3].at.z, long2 = -r.leg->toe_m.z;
  const double j1 = r.bodies[2].moments.y, j2 = r.bodies[3].moments.y;
  return {r.bodies[0].mass_kg,
          r.bodies[1].mass_kg + m1 + m2,
          long1,
          long2,
          m1 * l1 + m2 * long1,
          m2 * l2,
          m2 * long1 * l2,
          j2 + m2 * l2 * l2,
          j1 + j2 + m1 * l1 * l1 + m2 * (long1 * long1 + l2 * l2)};
}

// D of section 4.3; the boom's own mass moves in x alone.
Matrix mass_of(const Letters& k, const Values& q) {
  const double th = q[2], f = q[2] + q[3];
  const double A = k.a * std::cos(th) + k.b * std::cos(f), S = k.a * std::sin(th) + k.b * std::sin(f);
  Matrix d{};
  d[0] = {k.m + k.mb, 0, A, k.b * std::cos(f)};
  d[1] = {0, k.m, S, k.b * std::sin(f)};
  d[2] = {A, S, k.i0 + 2 * k.c * std::cos(q[3]), k.ik + k.c * std::cos(q[3])};
  d[3] = {k.b * std::cos(f), k.b * std::sin(f), k.ik + k.c * std::cos(q[3]), k.ik};
  return d;
}

// C q' + G.
Values bias_of(const Letters& k, const Values& q, const Values& v) {
  const double th = q[2], f = q[2] + q[3], w = v[2] + v[3];
  return {
      -k.a * std::sin(th) * v[2] * v[2] - k.b * std::sin(f) * w * w,
      k.a * std::cos(th) * v[2] * v[2] + k.b * std::cos(f) * w * w + g * k.m,
      -k.c * std::sin(q[3]) * (2 * v[2] * v[3] + v[3] * v[3]) + g * (k.a * std::sin(th) + k.b * std::sin(f)),
      k.c * std::sin(q[3]) * v[2] * v[2] + g * k.b * std::sin(f)};
}

struct Rows {
  Values x, z;
};

Rows jacobian_of(const Letters& k, const Values& q) {
  const double th = q[2], f = q[2] + q[3];
  return {{1, 0, k.l1 * std::cos(th) + k.l2 * std::cos(f), k.l2 * std::cos(f)},
          {0, 1, k.l1 * std::sin(th) + k.l2 * std::sin(f), k.l2 * std::sin(f)}};
}

double times(const Values& row, const Values& v) {
  double sum = 0.0;
  for (std::size_t j = 0; j < 4; ++j) sum += row[j] * v[j];
  return sum;
}

State crouched(const Machine& m, double hip = -0.5, double knee = 1.1) {
  State s;
  s.q[2] = hip;
  s.q[3] = knee;
  s.q[1] = -m.toe(s).at.z;
  return s;
}

// Stands with its toe at rest and the spring caught at `rest`; moves on its two free ways.
State standing(const Machine& m, double rest, double hip_radps = 0.0, double knee_radps = 0.0) {
  State s = crouched(m);
  s.v[2] = hip_radps;
  s.v[3] = knee_radps;
  const Point p = m.toe(s);
  s.v[0] = -p.v.x;
  s.v[1] = -p.v.z;
  s.stance = s.caught = true;
  s.touch_down_s = 0.0;
  s.rest_rad = rest;
  m.stand(s);
  return s;
}

// What acts in a joint beside gravity, motion and the ground, by the accelerations that the machine gives.
double acting(const Machine& m, const State& s, std::size_t joint) {
  const Values a = m.acceleration(s, 0.0, {}, {});
  const Pair f = m.ground_force(s, 0.0, {}, {});
  const Point p = m.toe(s);
  return m.dynamics().torque(s.q, s.v, a)[joint] - p.move[joint].x * f.x - p.move[joint].z * f.z;
}

double energy(const Machine& m, const State& s) {
  return m.dynamics().energy_j(s.q, s.v) + m.spring_energy_j(s);
}

}  // namespace

TEST_CASE("A leg in flight accelerates as its design says", "[trees]") {
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    const Robot robot = leg_of(seed);
    const Machine m = machine_of(robot);
    const Letters k = letters_of(robot);
    State s;
    s.q = {0.2, 0.7, -0.6, 1.2};
    s.v = {0.8, -0.4, 3.0, -5.0};
    const Values input{0, 0, 4.0, -7.0};
    const Values a = m.acceleration(s, 0.0, input, {});
    const Matrix d = mass_of(k, s.q);
    const Values h = bias_of(k, s.q, s.v);
    for (std::size_t j = 0; j < 4; ++j) CHECK(times(d[j], a) + h[j] == Approx(input[j]).margin(1e-9));
  }
}

TEST_CASE("A link lies where its angle says: forwards for a growing one", "[trees]") {
  const Robot robot = leg_of(2);
  const Machine m = machine_of(robot);
  const Letters k = letters_of(robot);
  State s;
  s.q = {0.3, 0.9, -0.4, 1.0};
  const Vec3 at = m.toe(s).at;
  CHECK(at.x == Approx(0.3 + k.l1 * std::sin(-0.4) + k.l2 * std::sin(0.6)));
  CHECK(at.z == Approx(0.9 - k.l1 * std::cos(-0.4) - k.l2 * std::cos(0.6)));
}

TEST_CASE("In stance the toe stays, and what holds it is the ground's force", "[trees]") {
  const Robot robot = leg_of(3);
  const Machine m = machine_of(robot);
  const Letters k = letters_of(robot);
  const State s = standing(m, 0.9, -1.5, 4.0);
  const Values input{0, 0, 3.0, -2.0};
  const Values a = m.acceleration(s, 0.0, input, {});
  const Pair f = m.ground_force(s, 0.0, input, {});
  const double th = s.q[2], angle = s.q[2] + s.q[3], w = s.v[2] + s.v[3];
  const Rows j = jacobian_of(k, s.q);
  CHECK(times(j.x, a) ==
        Approx(k.l1 * std::sin(th) * s.v[2] * s.v[2] + k.l2 * std::sin(angle) * w * w).margin(1e-9));
  CHECK(times(j.z, a) ==
        Approx(-k.l1 * std::cos(th) * s.v[2] * s.v[2] - k.l2 * std::cos(angle) * w * w).margin(1e-9));
  const double spring = -robot.leg->spring_nmprad * (s.q[3] - 0.9);
  const Matrix d = mass_of(k, s.q);
  const Values h = bias_of(k, s.q, s.v);
  const Values torque{0, 0, 3.0, -2.0 + spring};
  for (std::size_t i = 0; i < 4; ++i)
    CHECK(times(d[i], a) + h[i] == Approx(torque[i] + j.x[i] * f.x + j.z[i] * f.z).margin(1e-8));
}

TEST_CASE("A leg keeps its energy in flight and on its spring", "[trees]") {
  for (const bool switched : {true, false}) {
    Robot robot = leg_of(4, switched);
    robot.leg->rest_rad = 0.95;
    const Machine m = machine_of(robot);
    State flying;
    flying.q = {0, 2.0, -0.5, 1.0};
    flying.v = {0.5, 1.0, 3.0, 2.0};
    const double before = energy(m, flying);
    m.run(flying, 0.0, 0.25, kStep, {}, {});
    REQUIRE_FALSE(flying.stance);
    CHECK(energy(m, flying) == Approx(before).margin(2e-4));

    State s = standing(m, 0.95, -3.0, 6.0);
    s.phase_kept = true;
    const Vec3 toe = m.toe(s).at;
    const double stands = energy(m, s);
    m.run(s, 0.0, 0.15, kStep, {}, {});
    CHECK(energy(m, s) == Approx(stands).margin(2e-4));
    CHECK(m.toe(s).at.x == Approx(toe.x).margin(1e-9));
    CHECK(m.toe(s).at.z == Approx(toe.z).margin(1e-9));
    CHECK(std::fabs(m.toe(s).v.x) + std::fabs(m.toe(s).v.z) < 1e-8);
  }
}

TEST_CASE("Damping, drives and springs account for all energy of a leg that hops", "[trees]") {
  // Over flights and stances alike the energy falls by what impacts and damping take, and by what the spring
  // holds where it lets go.
  const Robot robot = leg_of(5);
  const double damping = 0.4;
  const Machine m(robot, {{}, {}, {.damping_nmspr = damping}, {}}, false, {});
  State s = crouched(m);
  s.q[1] += 0.1;
  const Values input{0, 0, 0.5, -1.0};
  double work = 0.0;
  const double fine = 2e-5;
  const double begins = energy(m, s);
  double lost = 0.0;
  for (double t = 0.0; t < 0.4; t += fine) {
    State next = s;
    m.run(next, t, fine, fine, input, {});
    if (next.touch_down_s > s.touch_down_s || next.lift_off_s > s.lift_off_s) {
      lost += energy(m, s) - energy(m, next);
    } else {
      const double hip = (s.v[2] + next.v[2]) / 2, knee = (s.v[3] + next.v[3]) / 2;
      work += fine * ((input[2] - damping * hip) * hip + input[3] * knee);
    }
    s = next;
  }
  CHECK(s.touch_down_s > 0.0);
  CHECK(lost > 0.1);
  CHECK(energy(m, s) == Approx(begins + work - lost).margin(1e-3));
}

TEST_CASE("A leg that is let go comes down when a stone does, at the ground's height", "[trees]") {
  for (const double ground : {0.0, 0.004}) {
    const Machine m = machine_of(leg_of(6));
    State s = crouched(m);
    s.q[1] += 0.1;
    s.ground_m = ground;
    m.run(s, 0.0, 0.16, kStep, {}, {});
    // Nothing turns in free fall: the boom's mass is not lifted.
    CHECK(s.touch_down_s == Approx(std::sqrt(2 * (0.1 - ground) / g)).epsilon(1e-9));
    CHECK(s.stance);
    CHECK(s.touch_down_rad == Approx(1.1).epsilon(1e-12));
    CHECK(s.rest_rad == s.touch_down_rad);
    CHECK(m.toe(s).at.z == Approx(ground).margin(1e-9));
  }
}

TEST_CASE("An impact stops the toe and keeps the angular momenta that it cannot change", "[trees]") {
  const Robot robot = leg_of(7);
  const Machine m = machine_of(robot);
  const Letters k = letters_of(robot);
  State s = crouched(m, -0.55, 0.95);
  s.v = {0.9, -1.4, 1.5, -2.0};
  const State before = s;
  m.stop_toe(s);
  CHECK(s.q == before.q);
  CHECK(std::fabs(m.toe(s).v.x) + std::fabs(m.toe(s).v.z) < 1e-12);
  CHECK(s.impulse_ns.z > 0.0);

  // By the bodies: all about the toe, and all above the knee about the knee.
  const auto momentum = [&](const State& at, Vec3 about, bool shank) {
    double sum = 0.0;
    const double th = at.q[2], f = at.q[2] + at.q[3];
    const auto add = [&](double mass, double mass_z, double x, double z, double vx, double vz, double inertia,
                         double w) {
      // Counted as th and tk are: from z to x.
      sum += mass_z * (x - about.x) * vz - mass * (z - about.z) * vx + inertia * w;
    };
    const auto& b = robot.bodies;
    const double vx = at.v[0], vz = at.v[1], w1 = at.v[2], w2 = at.v[2] + at.v[3];
    add(b[0].mass_kg + b[1].mass_kg, b[1].mass_kg, at.q[0], at.q[1], vx, vz, 0, 0);
    const double c1 = -b[2].centre_m.z, c2 = -b[3].centre_m.z;
    add(b[2].mass_kg, b[2].mass_kg, at.q[0] + c1 * std::sin(th), at.q[1] - c1 * std::cos(th),
        vx + c1 * std::cos(th) * w1, vz + c1 * std::sin(th) * w1, b[2].moments.y, w1);
    if (!shank) return sum;
    const double kx = k.l1 * std::sin(th), kz = -k.l1 * std::cos(th);
    add(b[3].mass_kg, b[3].mass_kg, at.q[0] + kx + c2 * std::sin(f), at.q[1] + kz - c2 * std::cos(f),
        vx + k.l1 * std::cos(th) * w1 + c2 * std::cos(f) * w2,
        vz + k.l1 * std::sin(th) * w1 + c2 * std::sin(f) * w2, b[3].moments.y, w2);
    return sum;
  };
  const Vec3 toe = m.toe(s).at;
  const Vec3 knee{s.q[0] + k.l1 * std::sin(s.q[2]), 0, s.q[1] - k.l1 * std::cos(s.q[2])};
  CHECK(momentum(s, toe, true) == Approx(momentum(before, toe, true)).epsilon(1e-10));
  CHECK(momentum(s, knee, false) == Approx(momentum(before, knee, false)).epsilon(1e-10));

  // Carnot: what is lost is the energy of the speeds that are lost.
  Values change{};
  for (std::size_t j = 0; j < 4; ++j) change[j] = before.v[j] - s.v[j];
  const auto moving = [&](const Values& v) {
    return m.dynamics().energy_j(s.q, v) - m.dynamics().energy_j(s.q, Values{});
  };
  CHECK(moving(before.v) - moving(s.v) == Approx(moving(change)).epsilon(1e-10));
}

TEST_CASE("A toe leaves where the ground would have to pull, and rises", "[trees]") {
  const Machine m = machine_of(leg_of(8));
  State s = standing(m, 0.45);
  double t = 0.0, least = 1e9;
  while (s.stance && t < 0.4) {
    least = std::min(least, m.ground_force(s, t, {}, {}).z);
    m.run(s, t, kStep, kStep, {}, {});
    t += kStep;
  }
  REQUIRE_FALSE(s.stance);
  CHECK(s.lift_off_s > 0.02);
  // Where the toe would not rise at once it stays for some milliseconds.
  CHECK(least > -20.0);
  m.run(s, t, 0.02, kStep, {}, {});
  CHECK_FALSE(s.stance);
  CHECK(m.toe(s).at.z > 1e-3);
}

TEST_CASE("A toe whose command lets it go does so at once", "[trees]") {
  const Machine m = machine_of(leg_of(8));
  State s = standing(m, 1.1);
  const Values flexes{0, 0, 0, 60.0};
  m.run(s, 0.01, 0.002, kStep, flexes, {});
  CHECK_FALSE(s.stance);
  CHECK(s.lift_off_s == Approx(0.01).margin(1e-9));
}

TEST_CASE("The spring pulls in stance alone, from the angle that it caught, and never pushes", "[trees]") {
  const Robot robot = leg_of(9);
  const double rate = robot.leg->spring_nmprad;
  const Machine m = machine_of(robot);
  State s = standing(m, 0.8);
  CHECK(acting(m, s, 3) == Approx(-rate * (1.1 - 0.8)));
  CHECK(acting(m, s, 2) == Approx(0.0).margin(1e-9));
  s.rest_rad = 1.3;
  CHECK(acting(m, s, 3) == Approx(0.0).margin(1e-9));
  s.rest_rad = 0.8;
  s.stance = false;
  CHECK(acting(m, s, 3) == Approx(0.0).margin(1e-9));

  Robot other = leg_of(9, false);
  other.leg->rest_rad = 0.9;
  const Machine parallel = machine_of(other);
  s.caught = false;
  CHECK(acting(parallel, s, 3) == Approx(-rate * 0.2));
  s.stance = true;
  CHECK(acting(parallel, s, 3) == Approx(-rate * 0.2));
  s.q[3] = 0.85;
  CHECK(acting(parallel, s, 3) == Approx(0.0).margin(1e-9));
}

TEST_CASE("Another rate, another rest angle and a second spring give the torques that they say", "[trees]") {
  const Robot robot = leg_of(10);
  const Machine rate = machine_of(robot, {{"spring_rate_error", {"knee"}, {{"stiffness_nmprad", 50.0}}}});
  CHECK(acting(rate, standing(rate, 0.8), 3) == Approx(-50.0 * 0.3));

  const Machine second = machine_of(robot, {{"second_spring", {"knee"}, {{"torque_nm", 1.5}}}});
  State s = standing(second, 1.2);
  CHECK(acting(second, s, 3) == Approx(0.0).margin(1e-9));
  s.stance = false;
  CHECK(acting(second, s, 3) == Approx(-1.5));

  const Machine offset = machine_of(robot, {{"latch_offset", {"knee"}, {{"offset_rad", 0.15}}}});
  s = crouched(offset);
  s.q[1] += 0.05;
  offset.run(s, 0.0, 0.15, kStep, {}, {});
  REQUIRE(s.stance);
  CHECK(s.rest_rad == s.touch_down_rad + 0.15);
  CHECK(acting(offset, s, 3) ==
        Approx(-robot.leg->spring_nmprad * std::max(s.q[3] - s.rest_rad, 0.0)).margin(1e-9));
}

TEST_CASE("A late catch leaves the knee to itself, and rests where the knee then is", "[trees]") {
  const Robot robot = leg_of(11);
  const double late = 0.0213;
  const Machine m = machine_of(robot, {{"latch_delay", {"knee"}, {{"delay_s", late}}}});
  State s = crouched(m);
  s.q[1] += 0.05;
  double t = 0.0;
  while (!s.caught && t < 0.3) {
    if (s.stance) CHECK(acting(m, s, 3) == Approx(0.0).margin(1e-8));
    m.run(s, t, 1e-3, kStep, {}, {});
    t += 1e-3;
  }
  REQUIRE(s.caught);
  CHECK(t - s.touch_down_s >= late);
  CHECK(t - s.touch_down_s < late + 1e-3 + 1e-9);
  // The same leg without any spring, at that instant.
  Robot slack = robot;
  slack.leg->spring_nmprad = 0.0;
  const Machine without = machine_of(slack);
  State free = crouched(without);
  free.q[1] += 0.05;
  without.run(free, 0.0, s.touch_down_s + late, kStep, {}, {});
  CHECK(s.rest_rad == Approx(free.q[3]).margin(1e-7));
  CHECK(s.rest_rad > s.touch_down_rad + 0.05);
}

TEST_CASE("A longer link moves the toe by so much, and neither mass nor inertia", "[trees]") {
  const Robot robot = leg_of(12);
  const Letters k = letters_of(robot);
  const auto toe = [&](const std::vector<Cause>& causes, double knee) {
    const Machine m = machine_of(robot, causes);
    State s;
    s.q[3] = knee;
    return m.toe(s).at;
  };
  const std::vector<Cause> thigh = {{"length_error", {"thigh"}, {{"extension_m", 0.02}}}};
  const std::vector<Cause> shank = {{"length_error", {"shank"}, {{"extension_m", -0.015}}}};
  CHECK(toe(thigh, 0.0).z == Approx(-(k.l1 + k.l2 + 0.02)));
  CHECK(toe(thigh, std::acos(0.0)).z == Approx(-(k.l1 + 0.02)));
  CHECK(toe(thigh, std::acos(0.0)).x == Approx(k.l2));
  CHECK(toe(shank, std::acos(0.0)).x == Approx(k.l2 - 0.015));
  CHECK(toe(shank, std::acos(0.0)).z == Approx(-k.l1));
  const Values turning{0, 0, 0, 1.0};
  for (const auto& causes : {thigh, shank})
    CHECK(machine_of(robot, causes).dynamics().torque({}, {}, turning)[3] -
              machine_of(robot, causes).dynamics().torque({}, {}, {})[3] ==
          Approx(k.ik));
}

TEST_CASE("On the boom's joints causes carry linear names", "[trees]") {
  const Robot robot = leg_of(13);
  const double mass =
      robot.bodies[0].mass_kg + robot.bodies[1].mass_kg + robot.bodies[2].mass_kg + robot.bodies[3].mass_kg;
  // Links that do not turn: all moves together.
  const auto force = [&](const Cause& cause, double speed) {
    const Machine m = machine_of(robot, {cause});
    State s;
    s.v[0] = speed;
    const Values a = m.acceleration(s, 0.0, {}, {});
    return m.dynamics().torque(s.q, s.v, a)[0];
  };
  CHECK(force({"coulomb_friction", {"boom_travel"}, {{"force_n", 2.5}}}, 0.5) == Approx(-2.5));
  CHECK(force({"damping_error", {"boom_travel"}, {{"damping_nspm", 3.0}}}, -0.5) == Approx(1.5));
  const Machine heavier = machine_of(robot, {{"rotor_inertia_error", {"boom_travel"}, {{"mass_kg", 0.4}}}});
  State s = standing(heavier, 2.0);
  const Values a = heavier.acceleration(s, 0.0, {}, {});
  const Pair f = heavier.ground_force(s, 0.0, {}, {});
  CHECK(f.x == Approx(heavier.dynamics().torque(s.q, s.v, a)[0] + 0.4 * a[0]));
  CHECK(mass > 5.0);
  CHECK_THROWS(machine_of(robot, {{"coulomb_friction", {"boom_travel"}, {{"torque_nm", 2.5}}}}));
}

TEST_CASE("Dry friction holds a leg that stands, and lets it go beyond", "[trees]") {
  const Robot robot = leg_of(14);
  const Letters k = letters_of(robot);
  State s = crouched(machine_of(robot));
  // The knee bears what lies above it.
  const double above = robot.bodies[1].mass_kg * -k.l1 * std::sin(s.q[2]) +
                       robot.bodies[2].mass_kg * -(k.l1 + robot.bodies[2].centre_m.z) * std::sin(s.q[2]);
  REQUIRE(above > 0.0);
  // With the hip held too, all stands; with a free boom and a free hip a leg would fall over.
  const auto runs = [&](double knee, double boom) {
    std::vector<Cause> causes = {{"coulomb_friction", {"knee"}, {{"torque_nm", knee}}},
                                 {"coulomb_friction", {"hip"}, {{"torque_nm", 50.0}}}};
    if (boom > 0) causes.push_back({"coulomb_friction", {"boom_height"}, {{"force_n", boom}}});
    const Machine m = machine_of(robot, causes);
    State at = standing(m, 2.0);
    m.run(at, 0.0, 0.05, kStep, {}, {});
    return at;
  };
  const State still = runs(50.0, 0.0), boom = runs(50.0, 20.0), falls = runs(1.0, 0.0);
  CHECK(still.q == s.q);
  CHECK(boom.q == s.q);
  CHECK(falls.q[3] > s.q[3] + 1e-3);
  CHECK(std::fabs(machine_of(robot).toe(falls).v.z) < 1e-8);
}

TEST_CASE("Dry friction takes its torque times the way of a knee that swings in stance", "[trees]") {
  const Robot robot = leg_of(15);
  const double friction = 0.6;
  const Machine m = machine_of(robot, {{"coulomb_friction", {"knee"}, {{"torque_nm", friction}}}});
  State s = standing(m, 0.9, -2.0, 4.5);
  s.phase_kept = true;
  const double before = energy(m, s);
  double way = 0.0;
  bool turned = false;
  for (double t = 0.0; t < 0.2; t += kStep) {
    const double from = s.q[3];
    m.run(s, t, kStep, kStep, {}, {});
    way += std::fabs(s.q[3] - from);
    turned = turned || s.v[3] < -0.5;
  }
  CHECK(turned);
  CHECK(energy(m, s) == Approx(before - friction * way).margin(1e-3));
  CHECK(std::fabs(m.toe(s).v.x) + std::fabs(m.toe(s).v.z) < 1e-8);
}

TEST_CASE("What no leg has is refused", "[trees]") {
  const Robot robot = leg_of(16), parallel = leg_of(16, false);
  CHECK_THROWS(machine_of(robot, {{"latch_delay", {"hip"}, {{"delay_s", 0.01}}}}));
  CHECK_THROWS(machine_of(robot, {{"length_error", {"torso"}, {{"extension_m", 0.01}}}}));
  CHECK_THROWS(machine_of(robot, {{"spring_rate_error", {"knee"}, {}}}));
  CHECK_THROWS(machine_of(parallel, {{"latch_delay", {"knee"}, {{"delay_s", 0.01}}}}));
  CHECK_THROWS(machine_of(parallel, {{"second_spring", {"knee"}, {{"torque_nm", 1.0}}}}));
  Random random(1);
  const Robot arm = draw_robot(random, 3);
  CHECK_THROWS(Machine(arm, std::vector<DriveData>(3), false,
                       {{"spring_rate_error", {arm.joints[0].name}, {{"stiffness_nmprad", 1.0}}}}));
}

}  // namespace furcula::hidden::trees
