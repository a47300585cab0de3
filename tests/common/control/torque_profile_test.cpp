// Torque profiles of 002 section 4.1.
#include "furcula/control/torque_profile.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace furcula::control;

namespace {

constexpr float kDt = 0.001f;
constexpr TorqueProfileConfig kHarmonic{ProfileShape::harmonic, 2.0f, 0.3f};
constexpr TorqueProfileConfig kConstant{ProfileShape::constant, 2.0f, 0.3f};

PhaseEstimate stance(float since_touchdown_s) {
  PhaseEstimate phase;
  phase.phase = Phase::stance;
  phase.since_touchdown_s = since_touchdown_s;
  return phase;
}

}  // namespace

TEST_CASE("the harmonic profile is T sin(2 pi (t - t_td) / P) at the middle of the tick") {
  for (float t = 0.0f; t < 0.6f; t += 0.001f) {
    const double truth = 2.0 * std::sin(2.0 * std::numbers::pi * (static_cast<double>(t) + 0.0005) / 0.3);
    REQUIRE(profile_torque_nm(kHarmonic, stance(t), -1.0f, kDt) == Approx(truth).margin(5e-6));
  }
}

TEST_CASE("the constant profile pulls the body down while it sinks and pushes it up while it rises") {
  CHECK(profile_torque_nm(kConstant, stance(0.1f), -0.5f, kDt) == 2.0f);
  CHECK(profile_torque_nm(kConstant, stance(0.1f), 0.5f, kDt) == -2.0f);
  CHECK(profile_torque_nm(kConstant, stance(0.1f), 0.0f, kDt) == 0.0f);
}

TEST_CASE("in flight every profile is zero, and the zero profile always") {
  PhaseEstimate flight;
  flight.since_touchdown_s = 0.075f;
  CHECK(profile_torque_nm(kHarmonic, flight, -1.0f, kDt) == 0.0f);
  CHECK(profile_torque_nm(kConstant, flight, -1.0f, kDt) == 0.0f);
  CHECK(profile_torque_nm({ProfileShape::zero, 2.0f, 0.3f}, stance(0.075f), -1.0f, kDt) == 0.0f);
}
