// What a walking robot in MuJoCo hides is named from logs of its walks, and nothing where it hides nothing.
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "host/floating/identify.hpp"
#include "host/walk/walk_file.hpp"
#include "tests/paths.hpp"
#include "tests/robot/trial.hpp"

using namespace furcula;

namespace {

floating::Identified diagnosed(robot::Cause cause, std::uint64_t seed, std::uint64_t walks) {
  const walk::Model model = walk::read_model(test::source("models/biped/biped.toml"));
  robot::Truth truth = robot::drawn(model.robot, 0.0, seed);
  robot::plant(robot::drawn_cause(cause, seed), truth);
  std::vector<floating::Recording> recordings;
  for (std::uint64_t k = 0; k < walks; ++k) {
    robot::TrialOptions options;
    options.seed = seed + k;
    const robot::Trial trial = robot::try_walk(
        truth, model.robot, walk::read_walk(test::source("models/biped/semi_passive_walk.toml")), options);
    CHECK(trial.stands);
    log::Log log = trial.log;
    log.path = "robot.csv";
    recordings.push_back(floating::recording_of(log));
    recordings.back().passive_hips = true;
  }
  floating::IdentifyOptions of_causes;
  of_causes.iterations = 0;
  of_causes.settings.threads = 1;
  return floating::identify(model.machine, recordings, of_causes);
}

/// From an exercise on the stand, and perhaps a walk, of a robot at so many times the ranges of document 000's tables.
floating::Identified exercised(robot::Cause cause, std::uint64_t seed, double scale = 0.0,
                               bool walks = false) {
  const walk::Model model = walk::read_model(test::source("models/biped/biped.toml"));
  walk::Walk walk = walk::read_walk(test::source("models/biped/robust_walk.toml"));
  walk.exercise_s = 10.0;
  robot::Truth truth = robot::drawn(model.robot, scale, seed);
  robot::plant(robot::drawn_cause(cause, seed), truth);
  robot::TrialOptions options;
  options.seed = seed;
  const auto recorded = [&](const char* file) {
    log::Log log = robot::try_walk(truth, model.robot, walk, options).log;
    log.path = file;
    return floating::recording_of(log);
  };
  std::vector<floating::Recording> recordings{recorded("exercise.csv")};
  CHECK(recordings[0].held);
  walk.exercise_s = 0.0;
  if (walks) recordings.push_back(recorded("walk.csv"));
  floating::IdentifyOptions of_causes;
  if (scale == 0.0)
    of_causes.iterations = 0;  // a fit of all numbers is where those that deviate all together begin
  of_causes.settings.threads = 1;
  return floating::identify(model.machine, recordings, of_causes);
}

std::string name_of(const floating::Identified& found, std::size_t cause) {
  return found.unknowns[found.causes[cause].unknown].name();
}
double size_of(const floating::Identified& found, std::size_t cause) {
  return found.causes[cause].theta * found.unknowns[found.causes[cause].unknown].prior_sd;
}

void check_named(robot::Cause cause, std::uint64_t seed, const std::string& name, double share) {
  INFO(name);
  const floating::Identified found = exercised(cause, seed);
  REQUIRE(!found.causes.empty());
  CHECK(name_of(found, 0) == name);
  CHECK(found.causes[0].confidence > 0.9);
  CHECK(size_of(found, 0) == Approx(robot::drawn_cause(cause, seed).size).epsilon(share));
  for (std::size_t k = 1; k < found.causes.size(); ++k) {
    INFO(name_of(found, k));
    CHECK(found.causes[k].confidence < 0.5);
  }
}

}  // namespace

TEST_CASE("Dry friction of a hip that a walking robot in MuJoCo hides is named, and nothing beside it",
          "[slow]") {
  const robot::Planted planted = robot::drawn_cause(robot::Cause::coulomb, 10);
  REQUIRE(planted.joint == dynamics::biped::kHipRoll);  // of the left leg
  const floating::Identified found = diagnosed(robot::Cause::coulomb, 10, 2);
  REQUIRE(found.causes.size() >= 1);
  const floating::Cause& first = found.causes.front();
  const floating::Unknown& what = found.unknowns[first.unknown];
  CHECK(what.kind == "coulomb_friction");
  CHECK(what.location == "left_hip_roll");
  CHECK(first.confidence > 0.5);
  CHECK(first.theta * what.prior_sd == Approx(planted.size).epsilon(0.3));
  for (std::size_t k = 1; k < found.causes.size(); ++k) CHECK(found.causes[k].confidence < 0.5);
}

TEST_CASE(
    "Dry friction of an ankle that moves little and sticks often is named from an exercise on the stand") {
  check_named(robot::Cause::coulomb, 25, "coulomb_friction@right_ankle_roll", 0.05);
}

TEST_CASE(
    "What a robot in MuJoCo hides is named from its exercise on the stand, with its size, and nothing beside it",
    "[slow]") {
  check_named(robot::Cause::coulomb, 13, "coulomb_friction@left_hip_pitch", 0.05);
  check_named(robot::Cause::payload, 30, "mass@right_hip_pitch", 0.05);
  // So late that what is left of it in one linear step from the model looks like a backlash.
  check_named(robot::Cause::delay, 17, "command_delay@drives", 0.05);
}

TEST_CASE("Of a robot whose numbers all deviate only the law beyond the tables has a name", "[slow]") {
  // It falls soon.
  constexpr std::uint64_t kLate = 204, kNothing = 205;
  const floating::Identified found = exercised(robot::Cause::delay, kLate, 1.0, true);
  CHECK(found.all_numbers_deviate);
  REQUIRE(!found.causes.empty());
  CHECK(name_of(found, 0) == "command_delay@drives");
  CHECK(found.causes[0].confidence > 0.5);
  CHECK(size_of(found, 0) == Approx(robot::drawn_cause(robot::Cause::delay, kLate).size).epsilon(0.1));
  for (std::size_t k = 1; k < found.causes.size(); ++k) {
    INFO(name_of(found, k) << " " << size_of(found, k));
    CHECK(found.causes[k].confidence < 0.5);
  }
  const floating::Identified clean = exercised(robot::Cause::none, kNothing, 1.0);
  CHECK(clean.all_numbers_deviate);
  for (std::size_t k = 0; k < clean.causes.size(); ++k) {
    INFO(name_of(clean, k) << " " << size_of(clean, k));
    CHECK(clean.causes[k].confidence < 0.5);
  }
}

TEST_CASE("Viscous friction is told from a weak gain by windows about each; a drive's damping fits as well",
          "[slow]") {
  const floating::Identified found = exercised(robot::Cause::viscous, 26);
  REQUIRE(!found.causes.empty());
  std::vector<std::string> names{name_of(found, 0)};
  for (const std::size_t i : found.causes[0].correlated_with) names.push_back(found.unknowns[i].name());
  std::sort(names.begin(), names.end());
  CHECK(names == std::vector<std::string>{"gain_kd@right_hip_pitch", "viscous_friction@right_hip_pitch"});
}

TEST_CASE("Nothing is named from the exercise of a robot in MuJoCo that hides nothing") {
  const floating::Identified found = exercised(robot::Cause::none, 12);
  for (std::size_t k = 0; k < found.causes.size(); ++k) {
    INFO(name_of(found, k));
    CHECK(found.causes[k].confidence < 0.5);
  }
}

TEST_CASE("Nothing is named in a walking robot in MuJoCo that hides nothing", "[slow]") {
  const floating::Identified found = diagnosed(robot::Cause::none, 1, 1);
  for (const floating::Cause& c : found.causes) {
    INFO(found.unknowns[c.unknown].kind << "@" << found.unknowns[c.unknown].location);
    CHECK(c.confidence < 0.5);
  }
}
