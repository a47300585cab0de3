// Limits that no posture keeps.
#include "host/walk/postures.hpp"

#include <catch2/catch.hpp>

#include "furcula/dynamics/biped/design.hpp"
#include "host/walk/rollout.hpp"

using namespace furcula;
using namespace furcula::walk;
using Catch::Contains;

TEST_CASE("a limit that every posture breaks is named, with what could be kept") {
  const auto robot = dynamics::biped::design();
  const auto said = [&](double WalkLimits::*of, double value, WalkMode mode = WalkMode::active) {
    RolloutOptions o;
    o.mode = mode;
    o.limits.*of = value;
    return limit_of_no_posture(robot, o);
  };
  for (const WalkMode mode : {WalkMode::active, WalkMode::semi_passive})
    CHECK(said(&WalkLimits::height_m, 0.8, mode).empty());
  // The straightest posture: 0.10 m, two links of 0.40 m at 0.125 rad to the vertical, 0.09 m of foot: 0.9838 m.
  CHECK(said(&WalkLimits::height_m, 0.983).empty());
  CHECK(
      said(&WalkLimits::height_m, 0.985) ==
      "[limits] height_m = 0.985: no posture in the ranges that are sought keeps it; expected at most 0.983 m");
  // A knee is bent by 0.25 rad at least.
  CHECK(said(&WalkLimits::range_rad, 0.26).empty());
  CHECK_THAT(said(&WalkLimits::range_rad, 0.2), Contains("range_rad = 0.2") && Contains("at least 0.25"));
  // Hips are 0.18 m apart.
  CHECK(said(&WalkLimits::apart_m, 0.17).empty());
  CHECK_THAT(said(&WalkLimits::apart_m, 0.3), Contains("apart_m = 0.3") && Contains("at most 0.1"));
  // What only motion breaks is not judged.
  CHECK(said(&WalkLimits::torque_nm, 1.0).empty());
}
