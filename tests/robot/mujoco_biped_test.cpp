// The biped in MuJoCo: it is as heavy as it is told, its feet carry it, what is planted is there, and a walk that was found elsewhere stands.
#include "tests/robot/mujoco_biped.hpp"

#include <catch2/catch.hpp>

#include "furcula/dynamics/biped/design.hpp"
#include "host/walk/search.hpp"
#include "host/walk/walk_file.hpp"
#include "tests/paths.hpp"
#include "tests/robot/trial.hpp"

using namespace furcula;
using dynamics::biped::kJoints;
using robot::Cause;

namespace {

const std::string kModel = test::source("models/biped/biped.toml"),
                  kWalk = test::source("models/biped/semi_passive_walk.toml");

robot::Trial tried(const robot::Truth& truth, double time_s) {
  const walk::Model model = walk::read_model(kModel);
  robot::TrialOptions options;
  options.time_s = time_s;
  options.disturbances = {.sensors = false, .push_n = 0.0};
  return robot::try_walk(truth, model.robot, walk::read_walk(kWalk), options);
}

double mass_kg(const robot::Truth& truth) {
  const robot::MujocoBiped biped(truth, false, false, std::array<double, kJoints>{}, {}, 1);
  double sum = 0.0;
  for (int b = 0; b < biped.model().nbody; ++b) sum += biped.model().body_mass[b];
  return sum;
}

}  // namespace

TEST_CASE("The robot in MuJoCo is as heavy as its description, and a payload makes it so much heavier") {
  robot::Truth truth = robot::as_described(dynamics::biped::design());
  CHECK(mass_kg(truth) == Approx(49.8));  // document 000
  robot::plant({Cause::payload, kJoints, 3.0}, truth);
  CHECK(mass_kg(truth) == Approx(52.8));
}

TEST_CASE("Of a hundred drawn robots each is one that MuJoCo takes, within the tables' ranges") {
  const auto nominal = dynamics::biped::design();
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    const robot::Truth truth = robot::drawn(nominal, 1.0, seed);
    CAPTURE(seed);
    CHECK_NOTHROW(mass_kg(truth));
    CHECK(std::abs(truth.robot.mass_kg() - 49.8) <= 12.0);  // twelve links, 1 kg each
    for (const double offset : truth.encoder_offset_rad) CHECK(std::abs(offset) <= 0.5 * 3.1416 / 180.0);
  }
}

TEST_CASE(
    "A semi-passive walk stands on the robot in MuJoCo, which has other contacts and another integrator") {
  const robot::Trial trial = tried(robot::as_described(dynamics::biped::design()), 10.0);
  CHECK(trial.ending == "stands");
  // At least half as far as in the project's own simulation.
  const walk::Model model = walk::read_model(kModel);
  const walk::Walk walk = walk::read_walk(kWalk);
  const double own_m =
      walk::run_walk(model.robot, walk::rollout_of(model, walk.mode, walk.walk_until_s), walk.parameters)
          .distance_m;
  CHECK(trial.distance_m > 0.5 * own_m);
  REQUIRE(trial.log.columns.at("time_s").size() == 1001);  // 0 to 10 s, 100 Hz
  // At the end it stands still: the drives' torques about both ankles, and the attitude.
  const auto& pitch = trial.log.columns.at("pitch_rad");
  CHECK(std::abs(pitch.back() - pitch[pitch.size() - 20]) < 5e-3);
  CHECK(trial.log.columns.at("contact_left_foot").back() == 1.0);
  CHECK(trial.log.columns.at("contact_right_foot").back() == 1.0);
}

TEST_CASE(
    "Robust walks stand on robots in MuJoCo that their searches have not seen, where the cheapest walk falls",
    "[slow]") {
  const walk::Model model = walk::read_model(kModel);
  const auto stand = [&](const char* file, double tables) {
    std::size_t count = 0;
    for (std::uint64_t seed = 301; seed <= 305; ++seed) {
      robot::TrialOptions options;
      options.seed = seed;
      const robot::Trial trial =
          robot::try_walk(robot::drawn(model.robot, tables, seed), model.robot,
                          walk::read_walk(test::source(std::string("models/biped/") + file)), options);
      count += trial.stands && trial.distance_m > 0.5 ? 1 : 0;
    }
    return count;
  };
  CHECK(stand("robust_walk.toml", 0.5) >= 4);
  CHECK(stand("robust_semi_passive_walk.toml", 0.5) >= 4);
  CHECK(stand("active_walk.toml", 0.0) <= 1);
}

TEST_CASE("A board stops a robot whose drives are late, unless its walk says by how much") {
  const walk::Model model = walk::read_model(kModel);
  walk::Walk walk = walk::read_walk(test::source("models/biped/robust_walk.toml"));
  robot::Truth truth = robot::as_described(model.robot);
  truth.delay_s = 12e-3;
  robot::TrialOptions options;
  options.time_s = 3.0;
  const robot::Trial stopped = robot::try_walk(truth, model.robot, walk, options);
  CHECK_THAT(stopped.ending,
             Catch::StartsWith("fault " + std::to_string(static_cast<int>(control::Fault::drive_disobeys))));
  walk.command_delay_s = truth.delay_s;
  const robot::Trial walks = robot::try_walk(truth, model.robot, walk, options);
  CHECK(walks.ending == "stands");
  CHECK(walks.distance_m > 0.1);
}

TEST_CASE("An encoder's offset is in the log of the robot in MuJoCo, and nothing else of it on the stand") {
  constexpr std::size_t kKnee = 3;
  robot::Truth truth = robot::as_described(dynamics::biped::design());
  const robot::Trial clean = tried(truth, 0.05);
  robot::plant({Cause::encoder, kKnee, 0.02}, truth);
  const robot::Trial off = tried(truth, 0.05);
  // The drive holds the reading where it is told: the joint itself is off by as much the other way.
  CHECK(off.log.columns.at("angle_left_knee_rad").front() ==
        Approx(clean.log.columns.at("angle_left_knee_rad").front()).margin(1e-3));
  robot::MujocoBiped as_told(robot::as_described(dynamics::biped::design()), false, false,
                             std::array<double, kJoints>{}, {}, 1),
      with_offset(truth, false, false, std::array<double, kJoints>{}, {}, 1);
  CHECK(with_offset.data().qpos[7 + kKnee] - as_told.data().qpos[7 + kKnee] == Approx(-0.02));
}
