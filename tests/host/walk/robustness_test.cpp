// What a walk is worth: trials that differ in what they should, and the same on any number of threads.
#include "host/walk/robustness.hpp"

#include <catch2/catch.hpp>
#include <cmath>

#include "host/walk/simulation.hpp"
#include "tests/host/walk/walks.hpp"

using namespace furcula;
using namespace furcula::walk;

TEST_CASE("a walk is tried with finer steps, on slopes, with another mass and with sensors that err") {
  const auto robot = dynamics::biped::design();
  const Walk walk = test::found_walk();
  const Robustness one = robustness_of(robot, {}, walk.parameters, {}, 2);
  REQUIRE(one.steps.size() == 4);
  REQUIRE(one.changed.size() == 5);
  CHECK(one.changed[4].rollout.time_s == Approx(20.0));
  CHECK(one.changed[4].rollout.ending == Ending::stands);
  for (const Trial& t : one.steps) {
    CHECK(t.rollout.ending == Ending::stands);
    CHECK(t.rollout.cot == Approx(one.steps[1].rollout.cot).epsilon(0.05));
  }
  CHECK(one.steps[0].rollout.steps == 10000);
  CHECK(one.steps[3].rollout.steps == 80000);
  // A robot that stands sags downhill.
  const Robustness still = robustness_of(robot, {}, test::standing_walk(), {}, 2);
  CHECK(still.changed[0].rollout.distance_m > still.steps[1].rollout.distance_m + 1e-3);
  CHECK(still.changed[1].rollout.distance_m < still.steps[1].rollout.distance_m - 1e-3);
  CHECK(one.noisy == 64);
  CHECK(one.noisy_stand <= one.noisy);
  CHECK(one.noisy_keep_limits <= one.noisy_stand);
  // This walk has room to stand; what errs shows in the limits, which it nearly touches.
  CHECK(one.noisy_stand > 48);
  CHECK(one.noisy_keep_limits < 60);
}

TEST_CASE("a heavier robot has all masses and inertias so much larger, its centres where they were") {
  const auto d = dynamics::biped::design(), h = heavier(d, 1.05);
  CHECK(h.legs[1][2].mass_kg == Approx(1.05 * d.legs[1][2].mass_kg));
  CHECK(h.pelvis.about_centre_kgm2.yy == Approx(1.05 * d.pelvis.about_centre_kgm2.yy));
  CHECK(h.legs[0][3].centre_m.z == d.legs[0][3].centre_m.z);
}

TEST_CASE("a simulated walk's log has what its sensors and its controller have") {
  const auto robot = dynamics::biped::design();
  const Walk walk = test::found_walk();
  const Simulation quiet = simulate_walk(robot, {}, walk.parameters, 0.01, std::nullopt);
  const auto& log = quiet.log;
  CHECK(log.rows() == 1000);
  CHECK(log.time_s().front() == Approx(0.0).margin(1e-12));
  CHECK(log.time_s()[1] == Approx(0.01));
  // The joints follow their targets by the drives' law; the robot stands and gets ahead.
  for (const std::size_t row : {200u, 400u, 990u}) {
    const double q = log.at("angle_left_knee_rad")[row], target = log.at("angle_cmd_left_knee_rad")[row];
    CHECK(std::abs(q - target) < 80.0 / 3000.0 + 1.5 * 80.0 / 3000.0);
    CHECK(log.at("base_z_m")[row] > 0.8);
  }
  CHECK(log.at("base_x_m").back() > 0.5);
  CHECK(log.at("acc_z_mps2").front() == Approx(9.81).margin(0.2));
  CHECK(log.at("contact_left_foot").front() == 1.0);
  double off = 0.0;
  for (const double contact : log.at("contact_right_foot")) off += 1.0 - contact;
  CHECK(off > 50.0);  // the right foot is in the air for more than half a second

  const Simulation noisy = simulate_walk(robot, {}, walk.parameters, 0.01, 3),
                   again = simulate_walk(robot, {}, walk.parameters, 0.01, 3);
  CHECK(noisy.log.at("gyro_x_radps") == again.log.at("gyro_x_radps"));
  CHECK(noisy.log.at("gyro_x_radps") != log.at("gyro_x_radps"));
}
