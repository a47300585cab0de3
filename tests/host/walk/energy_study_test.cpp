// Where the energy goes: joints against the whole, gears against the law of copper.
#include "host/walk/energy_study.hpp"

#include <catch2/catch.hpp>

#include "host/walk/search.hpp"
#include "tests/host/walk/walks.hpp"

using namespace furcula;
using namespace furcula::walk;

TEST_CASE("the joints' energies sum up to the walk's, those of motors that follow a passive hip too") {
  const auto robot = dynamics::biped::design();
  for (const char* mode : {"active", "semi_passive"}) {
    const Walk walk = test::found_walk(mode);
    RolloutOptions options;
    options.mode = walk.mode;
    const EnergyBalance e = energy_of(robot, options, walk.parameters);
    double work = 0.0, positive = 0.0, copper = 0.0;
    for (const JointEnergy& j : e.joints)
      work += j.work_j, positive += j.positive_work_j, copper += j.copper_j;
    CHECK(work == Approx(e.ten_s.work_j).epsilon(1e-9));
    CHECK(positive == Approx(e.ten_s.positive_work_j).epsilon(1e-9));
    CHECK(copper == Approx(e.ten_s.copper_j).epsilon(1e-9));
    CHECK(e.hundred_s.time_s <= Approx(100.0));
    if (walk.mode == WalkMode::active) {
      CHECK(e.joints[2].copper_j > 100.0);
      continue;
    }
    // A passive hip's motor is off, unless it is to follow: then it moves its own inertia and friction.
    CHECK(e.joints[2].copper_j == 0.0);
    CHECK(e.joints[8].work_j == 0.0);
    options.hips_follow = true;
    const EnergyBalance follows = energy_of(robot, options, walk.parameters);
    CHECK(follows.joints[2].copper_j > 10.0);
    CHECK(follows.ten_s.distance_m == e.ten_s.distance_m);
    CHECK(follows.ten_s.energy_j() - e.ten_s.energy_j() ==
          Approx(follows.joints[2].copper_j + follows.joints[2].work_j + follows.joints[8].copper_j +
                 follows.joints[8].work_j));
  }
}

TEST_CASE(
    "a gear takes the square of its ratio off the copper, and puts it on the rotor's inertia if that is charged for") {
  const auto robot = dynamics::biped::design();
  const Parameters walk = test::found_walk().parameters;
  const double ratio2 = 500.0 * 500.0 / (160.0 * 160.0);
  const Rollout as_is = run_walk(robot, {}, walk), free = run_walk(with_gear(robot, 500.0, false), {}, walk);
  CHECK(free.copper_j == Approx(as_is.copper_j / ratio2).epsilon(1e-9));
  CHECK(free.work_j == as_is.work_j);
  const auto charged = with_gear(robot, 500.0, true);
  CHECK(charged.drives[0][3].armature_kgm2 == Approx(500.0 * 500.0 * 5e-5));
  CHECK(charged.drives[0][3].kp_nmprad == Approx(3000.0 * ratio2));
}

TEST_CASE("an energy study begins with the robot as it is, and seeks every case from the walk that is given",
          "[slow]") {
  const Model model = read_model(test::source("models/biped/biped.toml"));
  Walk walk = test::found_walk();
  EnergyStudyOptions options;
  options.steps = 2'000'000;
  const auto cases = study_energy(model, walk, options);
  REQUIRE(cases.size() > 8);
  CHECK(cases[0].what == "as it is");
  for (const EnergyCase& c : cases) {
    INFO(c.what);
    // The walk that it begins with is one of those that it may choose.
    if (c.same.ten_s.keeps_limits()) {
      REQUIRE(c.sought);
      CHECK(c.sought->ten_s.cot <= c.same.ten_s.cot * 1.02);
    }
    if (c.sought) CHECK(c.sought->ten_s.keeps_limits());
  }
}
