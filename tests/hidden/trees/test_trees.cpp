// The fixed part of the blind suite for robots: fourteen cases, which `furcula diagnose` must answer rightly.
#include <catch2/catch.hpp>
#include <filesystem>

#include "tests/hidden/trees/cases.hpp"
#include "tests/hidden/trees/judge.hpp"
#include "tests/hidden/trees/program.hpp"
#include "tests/paths.hpp"

namespace furcula::hidden::trees {
namespace {

Judgement ask(const Question& draw, double least_confidence = 0.0) {
  const Case c = draw_case(draw);
  const std::string folder = (std::filesystem::temp_directory_path() /
                              ("furcula-trees-" + std::string(draw.leg ? "leg-" : "") +
                               std::string(name(draw.tier)) + "-" + std::to_string(draw.seed)))
                                 .string();
  const auto logs = write_case(c, folder);
  const std::string refused = diagnosed(test::program("furcula"), folder, logs, c.held_out, 280);
  INFO("planted " << label(c.planted) << "; kept in " << folder << "; " << refused);
  REQUIRE(refused.empty());
  const Diagnosis d = read_diagnosis(folder + "/diagnosis/diagnosis.json");
  std::vector<Cause> found;
  for (const Finding& f : d.findings) found.push_back(f.cause);
  const Judgement j = judge(c, d);
  INFO("verdict " << d.verdict << "; found " << label(found) << ": " << j.how);
  REQUIRE(j.right);
  for (const Finding& f : d.findings) CHECK(f.confidence >= least_confidence);
  std::filesystem::remove_all(folder);
  return j;
}

void ask(std::uint64_t seed, Tier tier, std::size_t joints, const std::vector<std::string>& effects) {
  ask({.seed = seed, .tier = tier, .joints = joints, .effects = effects, .brief = true});
}

void ask_of_leg(std::uint64_t seed, Tier tier, const std::vector<std::string>& effects) {
  ask({.seed = seed, .tier = tier, .joints = 4, .effects = effects, .brief = true, .leg = true});
}

}  // namespace

TEST_CASE("A robot that is as its model says is adequate", "[trees]") { ask(11, Tier::clean, 3, {}); }

TEST_CASE("Dry friction at one joint of a robot is named", "[trees]") {
  ask(12, Tier::large, 2, {"coulomb_friction"});
}

TEST_CASE("A late drive of a robot is named", "[trees]") { ask(13, Tier::large, 2, {"actuator_delay"}); }

// By the scatter from window to window alone the one does as well as the other.
TEST_CASE("A robot's small lag is told from a delay, and a small delay from a lag", "[trees]") {
  ask({.seed = 536708756, .tier = Tier::small, .joints = 3, .effects = {"actuator_lag"}}, 0.9);
  ask({.seed = 87674061, .tier = Tier::small, .joints = 3, .effects = {"actuator_delay"}}, 0.9);
}

// By squares the interval misses it by half of its width: what disturbs the robot has most of these.
TEST_CASE("Under what disturbs it, a robot's damping is in its interval", "[trees]") {
  const Judgement j =
      ask({.seed = 29689754, .tier = Tier::large, .joints = 3, .effects = {"damping_error"}}, 0.9);
  CHECK(j.covered == j.parameters);
}

TEST_CASE("A mass at a link of a robot is named", "[trees]") { ask(14, Tier::large, 3, {"payload"}); }

TEST_CASE("A spring between drive and joint of a robot is named", "[trees][slow]") {
  ask(17, Tier::large, 2, {"joint_elasticity"});
}

TEST_CASE("A spring behind dry friction of its own joint is named beside it", "[trees][slow]") {
  for (const std::uint64_t seed : {24, 25})
    ask(seed, Tier::pairs, 2, {"coulomb_friction", "joint_elasticity"});
}

TEST_CASE("A ripple of a robot's drive is named", "[trees]") { ask(18, Tier::large, 3, {"torque_ripple"}); }

// Not yet: of two recordings of 4 s only the constant torque is named; the drive's 8 % are missed.
TEST_CASE("A constant torque and a weak drive are named beside each other", "[trees][!mayfail]") {
  ask(15, Tier::pairs, 3, {"force_offset", "torque_gain_error"});
}

TEST_CASE("A periodic torque at a robot gets no sure name", "[trees]") {
  ask(16, Tier::outside, 2, {"periodic_torque"});
}

TEST_CASE("A leg that hops as its model says is adequate", "[trees]") { ask_of_leg(35, Tier::clean, {}); }

// Long logs of a parallel spring, whose knee its drive holds still before each landing.
TEST_CASE("A leg that is held still in flight has no dry friction", "[trees][slow]") {
  ask({.seed = 387056266, .tier = Tier::clean, .joints = 4, .effects = {}, .leg = true});
}

// Not yet: its switch is late by 1.9 ms, and no touch-down is hard enough to tell. The spring's rest is then off in all stances alike, and
// a rate of the spring is named, without confidence.
TEST_CASE("A leg whose switch is late is adequate", "[trees][!mayfail]") { ask_of_leg(31, Tier::clean, {}); }

TEST_CASE("A spring that catches late at a hopping leg's knee is named", "[trees]") {
  ask_of_leg(32, Tier::large, {"latch_delay"});
}

TEST_CASE("A longer shank of a hopping leg is named", "[trees]") {
  ask_of_leg(33, Tier::large, {"length_error"});
}

}  // namespace furcula::hidden::trees
